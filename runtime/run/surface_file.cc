#include "runtime/run/surface_file.h"

#include <filesystem>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/forms/open_stored.h"
#include "formats/recording/recording.h"
#include "runtime/slow/contact_elements.h"

namespace palpate {

SurfaceState begin_surface(const SurfaceFiles& files, const std::string& database) {
  if (files.in.empty() && files.out.empty()) {
    return {};
  }
  if (!files.out.empty()) {
    const AtomicFile place(files.out);  // said before the run, not after it
  }
  SurfaceState surface;
  const std::string sha256 = database_sha256(database);
  if (!files.in.empty()) {
    surface = read_surface_state(files.in, sha256, database);
  }
  surface.writer = "palpate-run " PALPATE_VERSION;
  surface.database = std::filesystem::path(database).filename().string();
  surface.database_sha256 = sha256;
  return surface;
}

void refuse_surface(const SurfaceFiles& files) {
  if (!files.in.empty() || !files.out.empty()) {
    throw InputError(
        "--surface-in and --surface-out: a surface belongs to a database, which a "
        "scene "
        "does not have yet; build it first");
  }
}

std::vector<std::string> surface_tables(const ResponseDatabase& database,
                                        const std::vector<std::string>& tools) {
  std::vector<std::string> names;
  for (const ResponseTable* table :
       response_tables(database, find_tools(database, tools))) {
    names.push_back(table->tool.name);
  }
  return names;
}

void leave_surface(const SurfaceFiles& files, SurfaceState surface,
                   std::span<const SimulationReport> reports) {
  if (files.out.empty()) {
    return;
  }
  for (const SimulationReport& report : reports) {
    put_surface(report.render.surface, report.tables, surface);
  }
  write_surface_state(files.out, surface);
}

}  // namespace palpate

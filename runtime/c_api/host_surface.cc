#include "runtime/c_api/host_surface.h"

#include <string>

#include "formats/base/error.h"
#include "formats/base/utf8_path.h"
#include "formats/recording/recording.h"

namespace palpate {
namespace {

SurfaceState read_state(const HostBody& body, const std::filesystem::path& file) {
  if (body.sha256().empty()) {
    throw InputError(
        "a database in memory has no file that a surface could belong to: render its "
        "file");
  }
  return read_surface_state(file, body.sha256(), body.file());
}

}  // namespace

void save_surface(const HostBody& body, const HostTool& tool,
                  const std::filesystem::path& file) {
  SurfaceState surface;
  if (body.sha256().empty() || std::filesystem::exists(file)) {
    surface = read_state(body, file);
  }
  surface.writer = "libpalpate " PALPATE_VERSION;
  surface.database = utf8_of(path_of_utf8(body.file()).filename());
  surface.database_sha256 = body.sha256();
  put_surface(tool.kept(), tool.tables(), surface);
  write_surface_state(file, surface);
}

void load_surface(const HostBody& body, HostTool& tool,
                  const std::optional<std::filesystem::path>& file) {
  SurfaceState surface;
  if (file) {
    surface = read_state(body, *file);
  }
  tool.begin_with(surface_of(surface, tool.tables()));
}

}  // namespace palpate

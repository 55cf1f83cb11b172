#include "runtime/c_api/host_surface.h"

#include <string>

#include "formats/base/error.h"
#include "formats/recording/recording.h"

namespace palpate {
namespace {

SurfaceState read_state(const HostBody& body, const std::filesystem::path& file) {
  if (body.file().empty()) {
    throw InputError(
        "a database in memory has no file that a surface could belong to: render its "
        "file");
  }
  return read_surface_state(file, database_sha256(body.file()), body.file());
}

void refuse_contacts(const HostTool& tool) {
  if (tool.has_several()) {
    throw InputError(
        "what has yielded of several contacts is not kept in files: they begin on a "
        "fresh body");
  }
}

}  // namespace

void save_surface(const HostBody& body, const HostTool& tool,
                  const std::filesystem::path& file) {
  refuse_contacts(tool);
  SurfaceState surface;
  if (body.file().empty() || std::filesystem::exists(file)) {
    surface = read_state(body, file);
  }
  surface.writer = "libpalpate " PALPATE_VERSION;
  surface.database = body.file().filename();
  surface.database_sha256 = database_sha256(body.file());
  surface.tool[body.tool_name()] = tool.yielded();
  write_surface_state(file, surface);
}

void load_surface(const HostBody& body, HostTool& tool,
                  const std::optional<std::filesystem::path>& file) {
  SurfaceState surface;
  if (file) {
    refuse_contacts(tool);
    surface = read_state(body, *file);
  }
  tool.begin_with(surface.tool[body.tool_name()]);
}

}  // namespace palpate

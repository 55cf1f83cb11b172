#include "runtime/command/scene_options.h"

#include <filesystem>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/service/service_socket.h"
#include "runtime/served/service_process.h"

namespace palpate {

void add_scene_options(Command command, SceneFlags& flags) {
  command.add_option("--server", flags.server,
                     "Of a scene: the palpate-precompute that computes it; by default "
                     "the one beside this program, or in PATH");
  command.add_option("-o,--output", flags.output,
                     "Of a scene: the database that is computed; by default the "
                     "scene's name with .h5, in this folder. A service that is at it "
                     "already is joined");
}

bool is_scene(const std::string& file) {
  return std::filesystem::path(file).extension() == ".toml";
}

std::unique_ptr<ServedClient> join_scene(const std::string& scene,
                                         const SceneFlags& flags,
                                         const std::string& tool) {
  if (!std::filesystem::is_regular_file(scene)) {
    throw InputError(fmt::format("{}: no such scene", scene));
  }
  const std::filesystem::path output =
      flags.output.empty() ? served_output(scene) : std::filesystem::path(flags.output);
  return std::make_unique<ServedClient>(
      ServedClientOptions{.socket = service_socket(output),
                          .tool = tool,
                          .start = [scene, output, server = flags.server](bool anew) {
                            return std::make_unique<ServiceProcess>(
                                ServiceCommand{.program = find_server(server),
                                               .scene = scene,
                                               .output = output,
                                               .anew = anew});
                          }});
}

}  // namespace palpate

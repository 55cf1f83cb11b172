#include "runtime/command/scene_options.h"

#include <filesystem>

#include "formats/base/error.h"
#include "runtime/served/join_scene.h"

namespace palpate {

void add_scene_options(Command command, SceneFlags& flags) {
  command.add_option("--server", flags.server,
                     "Of a scene: the palpate-precompute that computes it; by default "
                     "the one beside this program, or in PATH");
  command.add_option("-o,--output", flags.output,
                     "Of a scene: the database that is computed; by default the "
                     "scene's name with .h5, in this folder. A service that is at it "
                     "already is joined");
  command.add_flag(
      "--estimate", flags.estimate,
      "Of a scene: where nothing is known yet, a force as if the body were "
      "a half space of its material, instead of none; mostly too stiff");
}

bool is_scene(const std::string& file) {
  return std::filesystem::path(file).extension() == ".toml";
}

void refuse_scene_options(const SceneFlags& flags) {
  if (flags.estimate || !flags.server.empty() || !flags.output.empty()) {
    throw InputError(
        "--server, --output and --estimate are of a scene (SCENE.toml), which is "
        "computed meanwhile: a database is whole");
  }
}

std::unique_ptr<ServedClient> join_scene(const std::string& scene,
                                         const SceneFlags& flags,
                                         const std::string& tool) {
  return join_scene({.scene = scene,
                     .server = flags.server,
                     .output = flags.output,
                     .tool = tool,
                     .estimate = flags.estimate});
}

}  // namespace palpate

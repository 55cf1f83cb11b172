// Options of the subcommands that render a scene while it is computed.
#pragma once

#include <memory>
#include <string>

#include "formats/base/command_line.h"
#include "runtime/served/served_client.h"

namespace palpate {

struct SceneFlags {
  std::string server;
  std::string output;
  bool estimate = false;
};

/// --server, --output and --estimate. @param flags must outlive the command.
void add_scene_options(Command command, SceneFlags& flags);

/// Whether what a command is given is a scene, no database: it ends in ".toml".
[[nodiscard]] bool is_scene(const std::string& file);

/// @throws InputError if any of them is given: of a database there is nothing to
/// compute.
void refuse_scene_options(const SceneFlags& flags);

/// Joins the service of the scene's output, or starts one. @param tool empty: the only
/// one. @throws InputError for a scene that is not there, and as ServedClient.
[[nodiscard]] std::unique_ptr<ServedClient> join_scene(const std::string& scene,
                                                       const SceneFlags& flags,
                                                       const std::string& tool);

}  // namespace palpate

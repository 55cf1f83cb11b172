// From a scene's file to the service that computes it: one that listens is joined, else
// one is started.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "runtime/served/served_client.h"

namespace palpate {

struct SceneRequest {
  std::filesystem::path scene;   ///< TOML
  std::filesystem::path server;  ///< palpate-precompute; empty: as find_server()
  std::filesystem::path output;  ///< the database; empty: as served_output()
  std::string tool;              ///< empty: the only one
  bool estimate = false;         ///< as ServedClientOptions
};

/// @throws InputError for a scene that is not there, and as ServedClient.
[[nodiscard]] std::unique_ptr<ServedClient> join_scene(const SceneRequest& request);

}  // namespace palpate

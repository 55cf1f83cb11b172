// A renderer (renderer.h) as the benchmark sees it: from a shared library, or functions
// of this program.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tests/peers/renderer.h"

namespace palpate::peers {

/// The six functions. Those of a shared library live as long as the program.
struct Renderer {
  std::string name;  ///< of the library, without "peer_" and ".so"
  decltype(&peer_variant) variant = nullptr;
  decltype(&peer_open) open = nullptr;
  decltype(&peer_pose) pose = nullptr;
  decltype(&peer_force) force = nullptr;
  decltype(&peer_slow) slow = nullptr;
  decltype(&peer_close) close = nullptr;

  [[nodiscard]] std::vector<std::string> variants() const;
};

/// @throws InputError naming the library and the function that it lacks.
[[nodiscard]] Renderer load_renderer(const std::filesystem::path& library);

/// How often peer_slow() is called.
constexpr double kSlowS = 0.01;

/// One tool of a renderer, opened on a scene.
class OpenTool {
 public:
  /// @throws InputError with the renderer's own reason.
  OpenTool(const Renderer& renderer, const std::string& variant,
           const std::filesystem::path& scene, const std::filesystem::path& own,
           double tick_s);

  /// One tick: pose, force, and where it is due the slow turn.
  Eigen::Vector3d tick(const Eigen::Vector3d& position_m);

  /// The parts of tick(), to be timed.
  void pose(const Eigen::Vector3d& position_m) const;
  [[nodiscard]] Eigen::Vector3d force() const;
  [[nodiscard]] bool slow_is_due();  ///< counts ticks
  void slow() const { renderer_.slow(tool_.get()); }

 private:
  const Renderer& renderer_;
  std::unique_ptr<peer, decltype(&peer_close)> tool_;
  int every_ = 1;
  int ticks_ = 0;
};

}  // namespace palpate::peers

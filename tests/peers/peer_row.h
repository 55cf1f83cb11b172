// One renderer on one scene: a row of the table.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/peers/loaded_renderer.h"
#include "tests/peers/measures.h"
#include "tests/peers/nodule_search.h"
#include "tests/peers/scene_folder.h"
#include "tests/peers/sideways.h"
#include "tests/peers/stable_stiffness.h"
#include "tests/peers/step_times.h"

namespace palpate::peers {

struct PeerRow {
  std::string scene;
  std::string renderer;      ///< library, a blank, variant
  std::string missing = {};  ///< why there is no more of it; else empty
  ForceError error = {};
  EdgeJumps jumps = {};         ///< along the slowest slide
  Sideways sideways = {};       ///< likewise
  double created_path_j = 0.0;  ///< [J] most of any hand that is no cycle
  double lost_path_j = 0.0;     ///< [J] least or most that a closed hand ended with
  double created_cycle_j =
      0.0;               ///< [J] of a press-slide-release cycle, either way round
  double cycle_j = 0.0;  ///< [J] most that such a cycle held
  std::vector<StableStiffness> stable = {};  ///< by leaning_devices()
  StepTimes time = {};
  double build_s = 0.0;                   ///< [s] of the first peer_open()
  std::uintmax_t bytes = 0;               ///< on disk
  std::optional<NoduleFind> nodule = {};  ///< of a scene with a raster
  std::string digest = {};                ///< of the bits of all forces
};

struct MeasureOptions {
  bool stability = true;
  bool times = true;
};

/// All rows of a renderer on a scene. What it keeps lies in the scene's folder
/// own/NAME, when and how long it was built in own/NAME.built.
[[nodiscard]] std::vector<PeerRow> measure(const Renderer& renderer,
                                           const PeerScene& scene,
                                           const MeasureOptions& options);

/// The raster's row of the true forces; without a raster or truth none.
[[nodiscard]] std::optional<PeerRow> true_raster(const PeerScene& scene);

}  // namespace palpate::peers

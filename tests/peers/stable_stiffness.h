// The largest stiffness at which a device leans on a renderer without vibrating.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/bench/bench_rate_trade.h"
#include "tests/peers/loaded_renderer.h"
#include "tests/peers/scene_folder.h"

namespace palpate::peers {

/// A device model, and the rate at which it asks for forces.
struct LeaningDevice {
  TradeDevice device;
  double fast_hz = 1000.0;
};

/// The virtual PenCat at 2000 Hz and a device like the Falcon at its 1000 Hz.
[[nodiscard]] std::vector<LeaningDevice> leaning_devices();

struct StableStiffness {
  double stiffness_n_per_m = 0.0;  ///< [N/m] largest at which a kick died out
  bool at_end = false;             ///< it was the largest that was tried
  double rest_n_per_m = 0.0;       ///< [N/m] of the renderer where the device leans
};

/// The device leans on the scene's site, at 0.6 of the largest depth, along the normal.
/// Forces are scaled by a gain, as a workspace that is scaled does it. The stiffness is
/// the gain times the renderer's own at rest, so that a renderer that is too soft wins
/// nothing. A hand damps the device while the device settles (2 s), lets go and kicks
/// the device with 5 mm/s. The device is stable if the device moves less in the fourth
/// second after that than in the first. The device must also move less than the kick
/// alone would make the device swing. Stiffness rises by a fifth from 10 N/m until that
/// fails, then is bisected to 1 %.
[[nodiscard]] StableStiffness largest_stable_stiffness(const Renderer& renderer,
                                                       const std::string& variant,
                                                       const PeerScene& scene,
                                                       const std::filesystem::path& own,
                                                       const LeaningDevice& device);

}  // namespace palpate::peers

// Where the events of an insertion lie among its samples.
#pragma once

#include <cstddef>
#include <vector>

#include "fitting/insertion/needle_model.h"
#include "fitting/insertion/needle_path.h"

namespace palpate {

/// The last sample before a rupture and the first after it.
struct RuptureSamples {
  std::size_t before = 0, after = 0;
  /// The rupture may as well lie between other neighbours: between these samples, with
  /// 95 % probability.
  std::size_t earliest = 0, latest = 0;
  /// [m] of travel afterwards that is left out. The channel has leapt, and the friction
  /// of the shaft lags behind until the shaft slides.
  double lag_m = 0.0;
};

/// How many samples of an extraction the shaft still sticks.
struct StuckSamples {
  static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
  std::size_t count = kUnknown;
  std::size_t least = kUnknown, most = kUnknown;  ///< with 95 % probability
};

struct NeedleSwitches {
  std::vector<RuptureSamples> ruptures;  ///< in order
  std::vector<StuckSamples> stuck;       ///< (passes)
};

/// Fewer samples do not determine a slope or a level.
constexpr std::size_t kNeedlePartMin = 5;
constexpr std::size_t kRupturesMax = 12;
/// [-] of a way after a reversal: left out until it is known when the shaft slides.
constexpr double kReversalShare = 0.4;

/// Falls of the force (force_falls.h). After the first pass those beyond its depth
/// count alone. @throws InputError for more than kRupturesMax of them, as stick-slip
/// makes.
[[nodiscard]] std::vector<RuptureSamples> find_ruptures(const NeedlePath& path);

/// The samples that are fitted, and the place of each in the path.
struct FittedSamples {
  std::vector<NeedleSample> sample;
  std::vector<double> force_n;
  std::vector<std::size_t> place;
};

/// Left out are holds, falls in progress and the lag after them. After a reversal the
/// way is left out while it is not known when the shaft slides. @param contact_m a pass
/// that begins deeper reverses.
[[nodiscard]] FittedSamples fitted_samples(const NeedlePath& path,
                                           const NeedleSwitches& switches,
                                           double contact_m);

[[nodiscard]] NeedleEvents needle_events(const NeedlePath& path,
                                         const NeedleSwitches& switches,
                                         double reference_m);

/// Moves ruptures to the neighbouring samples at which the model follows best.
/// @return whether any has moved. @param variance [N^2] of the residuals.
bool move_ruptures(const NeedlePath& path, const NeedleModel& model,
                   const Eigen::VectorXd& q, double variance, NeedleSwitches& switches);

/// Number of samples, of each extraction, until the shaft slides. The extraction is
/// divided where a straight line, and sliding friction after it, follow best.
/// @param least_gain [N^2] of the squares over those of fewer than kNeedlePartMin
/// samples; less gain is of the noise.
[[nodiscard]] std::vector<StuckSamples> find_stuck_samples(const NeedlePath& path,
                                                           const NeedleModel& model,
                                                           const Eigen::VectorXd& q,
                                                           double variance,
                                                           double least_gain);

}  // namespace palpate

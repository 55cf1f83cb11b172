#include "fitting/curve/corrected_press.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Displacements of the tip, with the measurement's own signs.
Measurement moved_tip(const Measurement& samples, const Approach& approach,
                      const FrameCompliance& frame) {
  Measurement m = turned(samples, approach);
  take_off_deflection(frame, approach.samples, m);
  return turned(m, approach);  // turning twice gives the signs back
}

FrameEffect effect_of(const FrameCompliance& frame, const CorrectedPress& press) {
  FrameEffect effect;
  effect.deflection_m = press.approach.frame_deflection_m;
  if (!press.contact.has(FitFlag::kEmptyRun)) {
    effect.share =
        effect.deflection_m / (effect.deflection_m + press.contact.depth_max_m);
  }
  effect.depth_sd_m =
      effect.deflection_m * frame.stiffness_sd_n_per_m / frame.stiffness_n_per_m;
  return effect;
}

}  // namespace

CorrectedPress correct_press(const Measurement& press, const FrameCompliance* frame,
                             const FitRange& range,
                             const std::optional<FitRange>& baseline,
                             double noise_relative) {
  CorrectedPress result;
  result.samples = press;
  const auto fit = [&] {
    result.approach = select_approach(result.samples, range, baseline, frame);
    result.contact = fit_contact(result.approach, {.noise_relative = noise_relative});
  };
  fit();
  PressCorrections& corrections = result.corrections;
  // 1. Drift with time, from free samples, which the fit names. The fit is made again.
  corrections.drift = find_time_drift(press, result.approach, result.contact);
  if (corrections.drift.significant) {
    take_off_drift(corrections.drift, result.approach, result.samples);
    fit();
    result.contact.flags.push_back(FitFlag::kTimeDriftRemoved);
  }
  // 2. The frame's deflection, in displacement. A second fit with a softer frame shows
  //    what the error of the frame's stiffness does.
  result.moved = result.samples;
  if (frame != nullptr) {
    result.moved = moved_tip(result.samples, result.approach, *frame);
    corrections.frame = effect_of(*frame, result);
    if (corrections.frame.share > kFrameShareMax) {
      result.contact.flags.push_back(FitFlag::kFrameTakesMost);
    }
    if (frame->stiffness_sd_n_per_m > 0.0) {
      const FrameCompliance other = softer(*frame);
      auto& changed = result.softer.emplace();
      changed.approach = select_approach(result.samples, range, baseline, &other);
      changed.contact =
          fit_contact(changed.approach, {.noise_relative = noise_relative});
    }
  }
  // 3. Adhesion, of the forces without drift.
  corrections.adhesion = find_adhesion(result.samples, result.approach, result.contact);
  if (corrections.adhesion.seen()) {
    result.contact.flags.push_back(FitFlag::kAdhesion);
  }
  return result;
}

}  // namespace palpate

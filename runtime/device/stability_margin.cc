#include "runtime/device/stability_margin.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "formats/response/press_inversion.h"
#include "formats/response/yielding.h"

namespace palpate {

double RenderedStiffness::largest_n_per_m() const noexcept {
  return std::max({normal_n_per_m + shaft_n_per_m, friction_n_per_m, lateral_n_per_m});
}

RenderedStiffness rendered_stiffness(const ResponseTable& stored, double force_max_n) {
  ResponseTable rendered;
  // A press at finite speed has relaxed on its way. The renderer's elastic response is
  // the instantaneous one, which is stiffer.
  const bool pressed =
      !stored.viscoelasticity.empty() && !stored.viscoelasticity.instantaneous;
  if (pressed) {
    rendered = stored;
    make_instantaneous(rendered);
  }
  const ResponseTable& table = pressed ? rendered : stored;
  const Yielding& yielding = table.viscoelasticity.yielding;
  const Puncture& puncture = stored.puncture;
  RenderedStiffness largest{
      .shaft_n_per_m = puncture.shaft_n_per_m,
      .lateral_n_per_m = puncture.lateral_n_per_m2 * puncture.insertable_m};
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const CurveView curve = table.curve(i);
    if (curve.force_n.empty()) {
      continue;
    }
    // Unloading after yielding is steeper than the first press.
    const double stiffness = yielding.empty() ? table.stiffness_max_n_per_m[node]
                                              : yielded_stiffness_max_n_per_m(
                                                    curve, yielding_of(yielding, i));
    if (stiffness > largest.normal_n_per_m) {
      largest.normal_n_per_m = stiffness;
      largest.node = i;
    }
    // k_t = mu f / delta_L with the largest f that the curve or the device allows.
    if (table.presliding_m[node] > 0.0) {
      const double force_n = std::min(
          force_max_n, *std::max_element(curve.force_n.begin(), curve.force_n.end()));
      largest.friction_n_per_m =
          std::max(largest.friction_n_per_m,
                   table.friction[node] * force_n / table.presliding_m[node]);
    }
  }
  return largest;
}

double StabilityBounds::renderable_n_per_m() const noexcept {
  return std::min({sampling_n_per_m, delay_n_per_m, quantisation_n_per_m});
}

StabilityBounds stability_bounds(const DeviceLimits& device, double hold_s) {
  const double b = device.damping_n_s_per_m;
  return {.passivity_n_per_m = b / (2.0 * hold_s),
          .sampling_n_per_m = 2.0 * b / hold_s,
          .delay_n_per_m = b / (hold_s / 2.0 + device.delay_s),
          .quantisation_n_per_m = device.resolution_m > 0.0
                                      ? 2.0 * device.coulomb_n / device.resolution_m
                                      : std::numeric_limits<double>::infinity()};
}

std::string margin_table(const StabilityBounds& bounds, double k_n_per_m) {
  struct Row {
    const char* bound;
    double allowed_n_per_m;
    bool demanded;
  };
  std::string text =
      fmt::format("{:<44}{:>12}{:>10}  verdict\n", "bound", "K [N/m]", "margin");
  for (const Row& row :
       {Row{"Mahvash & Hayward (8), B > 2 T J", bounds.passivity_n_per_m, false},
        Row{"Colgate & Schenkel, b > K T / 2", bounds.sampling_n_per_m, true},
        Row{"Diolaiti et al., b >= K (T/2 + T_delay)", bounds.delay_n_per_m, true},
        Row{"Abbott & Okamura, K <= 2 f_c / step", bounds.quantisation_n_per_m,
            true}}) {
    const bool held = k_n_per_m <= row.allowed_n_per_m;
    text += fmt::format("{:<44}{:>12.4g}{:>10.3g}  {}\n", row.bound,
                        row.allowed_n_per_m, row.allowed_n_per_m / k_n_per_m,
                        held           ? "held"
                        : row.demanded ? "BROKEN"
                                       : "not held, sufficient only");
  }
  return text;
}

std::string why_not_renderable(const RenderedStiffness& stiffness,
                               const StabilityBounds& bounds,
                               const DeviceLimits& device, double hold_s) {
  const double k = stiffness.largest_n_per_m();
  if (k <= bounds.renderable_n_per_m()) {
    return {};
  }
  const std::string what =
      k == stiffness.lateral_n_per_m
          ? fmt::format(
                "the stiffness {:.4g} N/m across a needle's shaft, inserted as "
                "far as the body has room,",
                k)
      : k == stiffness.friction_n_per_m
          ? fmt::format("the stiffness {:.4g} N/m of friction before sliding", k)
          : fmt::format("the body's largest stiffness {:.4g} N/m (node {})", k,
                        stiffness.node);
  // 2 b / T is never below b / (T/2 + T_delay), so that one of two bounds is broken.
  if (bounds.quantisation_n_per_m <= bounds.delay_n_per_m) {
    return fmt::format(
        "{} exceeds {:.4g} N/m, what a position step of {:.3g} m allows with {:.3g} N "
        "of "
        "dry friction (K <= 2 f_c / step)",
        what, bounds.quantisation_n_per_m, device.resolution_m, device.coulomb_n);
  }
  return fmt::format(
      "{} exceeds {:.4g} N/m, what a damping of {:.3g} N s/m allows at forces held "
      "{:.3g} ms and {:.3g} ms late (K <= b / (T/2 + T_delay))",
      what, bounds.delay_n_per_m, device.damping_n_s_per_m, hold_s * 1e3,
      device.delay_s * 1e3);
}

}  // namespace palpate

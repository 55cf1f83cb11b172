// How a tool's responses yield for good: dents that stay, curves that soften
// (rate-independent plasticity and damage), as they are rendered.
//
// With f the response of a node to a first press, as it is stored:
//
//   dents      pressed to d, D = share (d - yield_depth) stays. From the dent on the
//              response is elastic, f with its depth past yield_depth taken
//              (1 - share) times, up to the deepest press: then f once more.
//   softening  pressed to m, all responses are 1 - omega(m) of the undamaged one,
//              f / (1 - omega),
//              omega(m) = largest (1 - exp(-max(m - onset, 0) / scale)).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response/curve_view.h"
#include "formats/response/press_inversion.h"
#include "formats/response/response_table.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// Node by node.
struct NodeYielding {
  double yield_depth_m = 0.0;  ///< [m] >= 0
  double share = 0.0;          ///< [-] [0, 1); 0: no dent stays
  double onset_m = 0.0;        ///< [m] >= 0
  double scale_m = 1.0;        ///< [m] > 0
  double largest = 0.0;        ///< [-] [0, 1); 0: nothing softens
};

[[nodiscard]] NodeYielding yielding_of(const Yielding& yielding, std::int64_t node);

/// omega(m) [-]. @param deepest_m [m] m.
[[nodiscard]] double softened_share(const NodeYielding& node, double deepest_m);

/// Undamaged curve of a node's response. The curve has f / (1 - omega) and its slopes
/// at the samples and at others between them, so many as fit an element message. At
/// samples (1 - omega) of it is f to rounding; between them as near as its cubics are.
[[nodiscard]] OwnedCurve undamaged_curve(const CurveView& first_press,
                                         const NodeYielding& node);

/// Largest slope that a response can have after a press, by which devices are judged:
/// where it is let go and pressed again [N/m].
[[nodiscard]] double yielded_stiffness_max_n_per_m(const CurveView& first_press,
                                                   const NodeYielding& node);

/// All softening curves of a table become the undamaged ones, as element messages have
/// them.
void make_undamaged(ResponseTable& table);

/// One line for people: from which depth on how much stays, and how far it softens;
/// empty for nothing.
[[nodiscard]] std::string describe(const Yielding& yielding);

}  // namespace palpate

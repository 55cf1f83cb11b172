// Mean force curves of repeats, points and specimens, with what scatters.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fitting/session/batch.h"
#include "fitting/session/random_effects.h"

namespace palpate {

struct MeanCurve {
  std::string name;  ///< "all", "specimen A", "point P", "point P of specimen A"
  std::size_t runs = 0;
  std::vector<double> depth_m;  ///< (k) [m] rising, > 0, beyond the contact point
  std::vector<RandomEffects> force_n;  ///< (k) [N] each depth's
};

/// Even depths from 0 on. The step is round (1, 2 or 5 times a power of ten), at most a
/// twenty-fifth of `largest_m`. The last depth is at most `largest_m`.
[[nodiscard]] std::vector<double> depth_grid_m(double largest_m);

struct MeanCurves {
  std::vector<MeanCurve> curves;
  bool from_first_sample = false;  ///< depths are counted from there, not from contact
  std::size_t left_out = 0;        ///< runs that are in no mean
};

/// Of all runs, of each specimen with two points, of each point with two repeats, as
/// far as its shallowest run goes. Left out are runs to skip and those whose contact
/// point is not known, or that stick. Where fewer than two are left, those that begin
/// in contact are taken, their depths counted from the first sample. Where runs name no
/// specimen, each point is one, and what is between specimens is reported as between
/// points. The interval of a point's mean is Student's t of its repeats.
[[nodiscard]] MeanCurves mean_curves(const BatchReport& report);

/// One sentence on what the means leave out; empty where nothing.
[[nodiscard]] std::string left_out_text(const MeanCurves& means);

}  // namespace palpate

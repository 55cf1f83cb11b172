#include "precompute/press/needle_curve.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/response/puncture.h"
#include "precompute/material/material.h"
#include "precompute/press/node_yielding.h"

namespace palpate {
namespace {

// Below the surface of a vertex [m], to be in its tissue.
constexpr double kBelowM = 1e-5;

double round_tip_depth_m(const TipTissue& tissue, double radius_m, bool nonlinear,
                         double force_n) {
  return nonlinear ? nonlinear_tip_depth_m(tissue, radius_m, force_n)
                   : linear_tip_depth_m(tissue, radius_m, force_n);
}

double tip_depth_m(const TipTissue& tissue, const NeedleTip& tip, bool nonlinear,
                   double force_n) {
  const double round_m = round_tip_depth_m(tissue, tip.radius_m, nonlinear, force_n);
  return tip.half_angle_rad > 0.0
             ? round_m + linear_cone_depth_m(tissue, tip, force_n) -
                   linear_tip_depth_m(tissue, tip.radius_m, force_n)
             : round_m;
}

}  // namespace

void sharpen(const TipTissue& tissue, const NeedleTip& tip, double ball_m,
             bool nonlinear, NodeResponse& response) {
  if (response.depth_m.empty() ||
      (tip.radius_m == ball_m && tip.half_angle_rad == 0.0)) {
    return;
  }
  const double ball_end_m = response.depth_m.back();
  double more_m = 0.0;
  double part = 0.0;
  for (std::size_t k = 0; k < response.depth_m.size(); ++k) {
    // Where the force falls, the tip has lost a part of its contact: it stays sunk in.
    more_m = std::max(
        more_m, tip_depth_m(tissue, tip, nonlinear, response.force_n[k]) -
                    round_tip_depth_m(tissue, ball_m, nonlinear, response.force_n[k]));
    response.depth_m[k] += more_m;
    if (response.depth_m[k] > 0.0) {
      part = std::max(part, more_m / response.depth_m[k]);
    }
  }
  if (response.tilt) {
    response.tilt->by_depth_per_m *= ball_end_m / response.depth_m.back();
  }
  response.error_relative = std::hypot(response.error_relative, kSharpenError * part);
}

std::vector<std::string> needle_notes(const Scene& scene) {
  std::vector<std::string> notes;
  for (std::size_t t = 0; t < scene.tool_needle.size(); ++t) {
    const auto& needle = scene.tool_needle[t];
    if (needle && !needle->is_its_ball() &&
        scene.reach.depth_max_m > kComparedRadii * needle->radius_m) {
      notes.push_back(fmt::format(
          "needle \"{}\": below {:.3g} mm, {:.0f} radii, its curve was compared with "
          "no press of a tip{}",
          scene.tool[t].name, 1e3 * kComparedRadii * needle->radius_m, kComparedRadii,
          scene.reach.depth_max_m > kComputedRadii * needle->radius_m
              ? fmt::format("; below {:.1f}, a soft half-space's is extrapolated",
                            kComputedRadii)
              : std::string()));
    }
  }
  return notes;
}

TipTissue tissue_at(const BodySource& body, std::int32_t vertex) {
  const Eigen::Vector3d below_m = body.surface.position_m.row(vertex).transpose() -
                                  kBelowM * body.normal.row(vertex).transpose();
  const Material& material =
      body.material[static_cast<std::size_t>(region_of(body, below_m))];
  const double e_pa = small_youngs_modulus_pa(material);
  // E = 2 G (1 + nu)
  return {.youngs_modulus_pa = e_pa,
          .poissons_ratio = 0.5 * e_pa / small_shear_modulus_pa(material) - 1.0};
}

}  // namespace palpate

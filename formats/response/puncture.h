// What a needle breaks, cuts and rubs against in a body, as it is rendered
// (runtime/needle/channel.h).
//
// Along the axis of a node the needle meets layers of materials. A membrane in front of
// a layer bears a force, and then breaks. In the layer the tip cuts at a constant force
// J w, toughness times the width of the edge. The shaft rubs by its length in the
// layer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/response/tool_shape.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

constexpr std::int64_t kMostPunctureMaterials = 8;  ///< of a tool
constexpr std::int64_t kMostPunctureLayers = 6;     ///< below a node
/// [J/m^2] More is of no needle: porcine skin has 1136 for a needle, 17100 to 30400 by
/// tearing (Chinese Journal of Mechanical Engineering 2022,
/// 10.1186/s10033-022-00767-4).
constexpr double kToughestPuncture = 3000.0;

/// Of a tool that punctures; no materials: it does not.
struct Puncture {
  std::string rule = {};  ///< what breaks the first membrane: "force" or "energy"
  // Of every material (M).
  std::vector<std::string> material = {};       ///< its name in the scene
  std::vector<double> membrane_n = {};          ///< [N] >= 0; infinite: nothing does
  std::vector<double> cutting_n = {};           ///< [N] >= 0 J w; infinite likewise
  std::vector<double> friction_n_per_m = {};    ///< [N/m] >= 0, kinetic
  std::vector<double> static_ratio = {};        ///< [-] >= 1 static over kinetic
  std::vector<double> toughness_j_per_m2 = {};  ///< [J/m^2] >= 0 J; NaN: not known
  /// [J] >= 0 that breaks it below the surface, instead; NaN: membrane_n does. Empty:
  /// NaN for all.
  std::vector<double> membrane_j = {};
  // Of the tool.
  double edge_width_m = 0.0;      ///< [m] >= 0 w; 0: not known
  double shaft_n_per_m = 0.0;     ///< [N/m] > 0 along the shaft before it slips
  double lateral_n_per_m2 = 0.0;  ///< [N/m^2] >= 0 across, per inserted length
  double mouth_m = 0.0;           ///< [m] > 0 from a channel's axis: found again there
  double radius_m = 0.0;          ///< [m] >= 0 of the shaft; 0: not known
  double tip_angle_rad = 0.0;     ///< [rad] [0, pi) full; 0: a hemisphere, or not known
  /// [m] >= 0 of the shaft in the body, at most, below any node; 0: not known.
  double insertable_m = 0.0;
  // Of the nodes: a row for all alike, or (n).
  std::vector<double> rupture = {};          ///< [N] or [J] >= 0, as the rule says
  RowsOf<double> layer_depth_m = {};         ///< (n x K) [m] first 0, rising; NaN: none
  RowsOf<std::int32_t> layer_material = {};  ///< (n x K) row of `material`; -1: none

  [[nodiscard]] bool empty() const noexcept { return material.empty(); }
};

/// Calls with(name, number) for the numbers of the tool that each file has.
template <typename Rows, typename With>
void for_each_puncture_number(Rows& puncture, const With& with) {
  with("edge_width_m", puncture.edge_width_m);
  with("shaft_n_per_m", puncture.shaft_n_per_m);
  with("lateral_n_per_m2", puncture.lateral_n_per_m2);
  with("mouth_m", puncture.mouth_m);
}

/// The same for those that files lack where they are 0.
template <typename Rows, typename With>
void for_each_optional_puncture_number(Rows& puncture, const With& with) {
  with("radius_m", puncture.radius_m);
  with("tip_angle_rad", puncture.tip_angle_rad);
  with("insertable_m", puncture.insertable_m);
}

/// The numbers of both, in their order.
[[nodiscard]] std::vector<double> numbers_of(const Puncture& puncture);

/// [J] that breaks a material's membrane below the surface; NaN: membrane_n does.
[[nodiscard]] double membrane_j_of(const Puncture& puncture, std::size_t material);

/// The unit of `rupture` as files name it: "J" by the rule "energy", else "N".
[[nodiscard]] const char* rupture_units(const Puncture& puncture) noexcept;

/// The rows of some nodes, in their order. @param nodes rows of the whole.
[[nodiscard]] Puncture rows_of(const Puncture& puncture,
                               std::span<const std::int32_t> nodes);

/// The same of the rows [begin, begin + count).
[[nodiscard]] Puncture rows_of(const Puncture& puncture, std::int64_t begin,
                               std::int64_t count);

/// Whether both hold the same numbers, where NaN is NaN.
[[nodiscard]] bool same(const Puncture& a, const Puncture& b);

/// [m] where the last layer that a needle gets to begins below a node; nothing enters a
/// membrane that never breaks. @param node row of the whole.
[[nodiscard]] double last_layer_m(const Puncture& puncture, std::int64_t node);

/// A tool in a few words: "needle of radius 0.75 mm, pressed as sphere of radius 3 mm".
/// That of the shape where it is no needle, or its radius is not known.
[[nodiscard]] std::string describe_tool(const ToolShape& tool,
                                        const Puncture& puncture);

/// [-] Depth over radius beyond which no needle's curve that was made of a larger
/// ball's was compared with presses of a tip (precompute/press/needle_curve.h). Of a
/// nonlinear half-space the curve was computed to 5.5 radii (tests/bench/deep_tip).
inline constexpr double kComparedRadii = 4.0;

/// How deep such a curve goes beyond that, in a sentence's end; else empty.
/// @param depth_m [m] >= 0 its largest depth.
[[nodiscard]] std::string doubts_of_depth(const ToolShape& tool,
                                          const Puncture& puncture, double depth_m);

/// One line for people: what is broken, cut and rubbed against; empty for nothing.
[[nodiscard]] std::string describe(const Puncture& puncture);

/// What may be wrong with its numbers, in a sentence's end; empty without doubts. A
/// toughness may come from tear tests. A membrane may bear less than the cut behind it.
/// @param puncture that keeps the rules of files (puncture_rules.h).
[[nodiscard]] std::string doubts_of(const Puncture& puncture);

}  // namespace palpate

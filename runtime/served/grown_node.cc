#include "runtime/served/grown_node.h"

#include <algorithm>
#include <array>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "formats/response/response_table.h"
#include "formats/response/tilt_line.h"
#include "runtime/served/node_blend.h"
#include "runtime/slow/element_message.h"

namespace palpate {
namespace {

constexpr double kLeanLeast = 0.05;

}  // namespace

std::string_view name(GrownQuality quality) noexcept {
  constexpr std::array<std::string_view, kGrownQualities> kNames{
      "none", "estimated", "preliminary", "final"};
  return kNames[static_cast<std::size_t>(quality)];
}

double stiffness_n_per_m(const ElementNode& node) {
  if (node.samples == 0) {
    return 0.0;
  }
  const double rubs_n = node.friction * largest_normal_force_n(node);
  const double friction = rubs_n > 0.0 ? rubs_n / node.presliding_m : 0.0;
  return std::max(stiffness_max_n_per_m(node.curve()), friction);
}

GrownNode grown_node(const ToolShape& tool, const WorkUnitNode& answer,
                     GrownQuality quality, const Eigen::Vector3d& position_m,
                     const Eigen::Vector3d& normal, double longest_edge_m) {
  GrownNode grown{.node = answer.vertex, .quality = quality, .message = {}};
  NodeResponse response = answer.response;
  if (response.depth_m.empty() || !(response.direction.dot(normal) >= kLeanLeast)) {
    response = {};
  }
  (void)limit_tilt(response, normal, longest_edge_m);
  Points position_row(1, 3);
  Points normal_row(1, 3);
  position_row.row(0) = position_m.transpose();
  normal_row.row(0) = normal.transpose();
  ResponseTable table;
  try {
    table = make_table(tool, {response});
  } catch (const InputError&) {
    table = make_table(tool, {NodeResponse{}});
  }
  grown.message = node_message({position_row, normal_row, table}, 0);
  grown.message.node = answer.vertex;
  return grown;
}

double soften(ElementNode& node, double stiffness_max_n_per_m) {
  if (node.samples == 0) {
    return 1.0;
  }
  const double steepest = palpate::stiffness_max_n_per_m(node.curve());
  const double factor =
      steepest > stiffness_max_n_per_m ? stiffness_max_n_per_m / steepest : 1.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(node.samples); ++k) {
    node.force_n[k] *= factor;
    node.stiffness_n_per_m[k] *= factor;
    node.energy_j[k] *= factor;
  }
  const double rubs_n = node.friction * largest_normal_force_n(node);
  node.presliding_m = std::max(node.presliding_m, rubs_n / stiffness_max_n_per_m);
  return factor;
}

}  // namespace palpate

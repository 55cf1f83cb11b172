#include "formats/database/puncture_rules.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "formats/database/format_error.h"

namespace palpate {
namespace {

void check_rule(const std::string& group, const Puncture& puncture) {
  if (puncture.rule != "force" && puncture.rule != "energy") {
    fail("{}@rule is {:?}, must be \"force\" or \"energy\"", group,
         puncture.rule.substr(0, 80));
  }
}

void check_names(const std::string& path, const std::vector<std::string>& names) {
  if (names.empty() || std::ssize(names) > kMostPunctureMaterials) {
    fail("{} has {} lines, must have 1 to {}", path, names.size(),
         kMostPunctureMaterials);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (name.empty() || name.find('\n') != std::string::npos ||
        name.find('\0') != std::string::npos) {
      fail("{}: line {} is {:?}, must be one line with something in it", path, i,
           name.substr(0, 80));
    }
    const auto first = std::find(names.begin(), names.end(), name) - names.begin();
    if (first != static_cast<std::ptrdiff_t>(i)) {
      fail("{}: line {} is {:?} as line {} is, must be unique", path, i,
           name.substr(0, 80), first);
    }
  }
}

// What may be a material's.
struct MaterialRange {
  double low = 0.0;
  bool finite = false;
  bool may_be_unknown = false;
};

// A row per material.
void check_material_values(const std::string& path, const std::vector<double>& values,
                           std::size_t materials, const MaterialRange& range = {}) {
  if (values.size() != materials) {
    fail("{} has {} rows, must have one per material: {}", path, values.size(),
         materials);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool unknown = range.may_be_unknown && std::isnan(values[i]);
    const bool finite = !range.finite || values[i] <= kLargest;
    if (!unknown && !(values[i] >= range.low && finite)) {
      fail("{}: row {} has {}, must be at least {}{}{}", path, i, values[i], range.low,
           range.finite ? " and finite" : "",
           range.may_be_unknown ? " or not a number" : "");
    }
  }
}

// Of the tool, finite.
void check_tool_value(const std::string& group, const char* name, double value,
                      bool positive) {
  if (!(value >= 0.0 && value <= kLargest) || (positive && value == 0.0)) {
    fail("{}@{} is {}, must be {}", group, name, value,
         positive ? "positive and finite" : "at least 0 and finite");
  }
}

void require_node_rows(const std::string& path, std::int64_t rows, std::int64_t nodes) {
  if (rows != 1 && rows != nodes) {
    fail("{} has {} rows, must have 1 or {}", path, rows, nodes);
  }
}

void check_rupture(const std::string& path, const Puncture& puncture,
                   std::int64_t nodes) {
  require_node_rows(path, std::ssize(puncture.rupture), nodes);
  for (std::size_t i = 0; i < puncture.rupture.size(); ++i) {
    if (!(puncture.rupture[i] >= 0.0)) {
      fail("{}: row {} has {}, must be at least 0", path, i, puncture.rupture[i]);
    }
  }
}

// The first layer begins at the surface, each of the others deeper, and where there is
// none, none follows.
void check_layers_of_node(const std::string& group, const Puncture& puncture,
                          Eigen::Index i) {
  const std::int64_t materials = std::ssize(puncture.material);
  bool ended = false;
  for (Eigen::Index k = 0; k < puncture.layer_depth_m.cols(); ++k) {
    const double depth_m = puncture.layer_depth_m(i, k);
    const std::int32_t material = puncture.layer_material(i, k);
    if (k == 0 && depth_m != 0.0) {
      fail("{}/layer_depth_m: row {} begins with {}, must begin with 0", group, i,
           depth_m);
    }
    ended = ended || std::isnan(depth_m);
    if (ended) {
      if (!std::isnan(depth_m) || material != -1) {
        fail(
            "{}: row {} has a layer at {} of material {} behind its last, must have "
            "none: not a number and -1",
            group, i, depth_m, material);
      }
      continue;
    }
    if (k > 0 && !(depth_m > puncture.layer_depth_m(i, k - 1) && depth_m <= kLargest)) {
      fail("{}/layer_depth_m: row {} has {} after {}, must increase and be finite",
           group, i, depth_m, puncture.layer_depth_m(i, k - 1));
    }
    if (material < 0 || material >= materials) {
      fail("{}/layer_material: row {} has {} at {} m, must lie in [0, {}]", group, i,
           material, depth_m, materials - 1);
    }
  }
}

void check_layers(const std::string& group, const Puncture& puncture,
                  std::int64_t nodes) {
  const auto& depth_m = puncture.layer_depth_m;
  const auto& material = puncture.layer_material;
  require_node_rows(group + "/layer_depth_m", depth_m.rows(), nodes);
  if (depth_m.cols() < 1 || depth_m.cols() > kMostPunctureLayers) {
    fail("{}/layer_depth_m has {} columns, must have 1 to {}", group, depth_m.cols(),
         kMostPunctureLayers);
  }
  if (material.rows() != depth_m.rows() || material.cols() != depth_m.cols()) {
    fail("{}/layer_material is {} x {}, must be as layer_depth_m: {} x {}", group,
         material.rows(), material.cols(), depth_m.rows(), depth_m.cols());
  }
  for (Eigen::Index i = 0; i < depth_m.rows(); ++i) {
    check_layers_of_node(group, puncture, i);
  }
}

}  // namespace

void check_puncture(const std::string& tool, const Puncture& puncture,
                    std::int64_t nodes) {
  if (puncture.empty() && puncture.rupture.empty() &&
      puncture.layer_depth_m.rows() == 0) {
    return;
  }
  const std::string group = tool + "/puncture";
  check_rule(group, puncture);
  check_names(group + "/material", puncture.material);
  const std::size_t materials = puncture.material.size();
  check_material_values(group + "/membrane_n", puncture.membrane_n, materials);
  check_material_values(group + "/cutting_n", puncture.cutting_n, materials);
  check_material_values(group + "/friction_n_per_m", puncture.friction_n_per_m,
                        materials, {.finite = true});
  check_material_values(group + "/static_ratio", puncture.static_ratio, materials,
                        {.low = 1.0, .finite = true});
  check_material_values(group + "/toughness_j_per_m2", puncture.toughness_j_per_m2,
                        materials, {.may_be_unknown = true});
  if (!puncture.membrane_j.empty()) {
    check_material_values(group + "/membrane_j", puncture.membrane_j, materials,
                          {.finite = true, .may_be_unknown = true});
  }
  check_tool_value(group, "edge_width_m", puncture.edge_width_m, false);
  check_tool_value(group, "shaft_n_per_m", puncture.shaft_n_per_m, true);
  check_tool_value(group, "lateral_n_per_m2", puncture.lateral_n_per_m2, false);
  check_tool_value(group, "mouth_m", puncture.mouth_m, true);
  check_tool_value(group, "radius_m", puncture.radius_m, false);
  check_tool_value(group, "insertable_m", puncture.insertable_m, false);
  if (!(puncture.tip_angle_rad >= 0.0 && puncture.tip_angle_rad < std::numbers::pi)) {
    fail("{}@tip_angle_rad is {}, must be in [0, pi)", group, puncture.tip_angle_rad);
  }
  check_rupture(group + "/rupture", puncture, nodes);
  check_layers(group, puncture, nodes);
}

}  // namespace palpate

#include "formats/response/puncture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

namespace palpate {
namespace {

bool same_numbers(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return x == y || (std::isnan(x) && std::isnan(y));
  });
}

template <typename Values>
auto flat_span(const Values& values) {
  return std::span(values.data(), static_cast<std::size_t>(values.size()));
}

template <typename Matrix>
Matrix matrix_rows(const Matrix& values, std::span<const std::int32_t> nodes) {
  if (values.rows() < 2) {
    return values;
  }
  Matrix rows(static_cast<Eigen::Index>(nodes.size()), values.cols());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = values.row(nodes[i]);
  }
  return rows;
}

std::string describe_material(const Puncture& puncture, std::size_t m) {
  const double membrane_n = puncture.membrane_n[m];
  const double membrane_j = membrane_j_of(puncture, m);
  const double cutting_n = puncture.cutting_n[m];
  const std::string& name = puncture.material[m];
  if (std::isinf(cutting_n)) {
    return fmt::format("{} is not cut", name);
  }
  const std::string membrane = membrane_j >= 0.0 ? fmt::format("{:.3g} J", membrane_j)
                               : std::isinf(membrane_n)
                                   ? "that nothing breaks"
                                   : fmt::format("{:.3g} N", membrane_n);
  return fmt::format(
      "{}: membrane {}, cutting {:.3g} N, friction {:.3g} N/m, {:.3g} times it at rest",
      name, membrane, cutting_n, puncture.friction_n_per_m[m],
      puncture.static_ratio[m]);
}

// Layers of the node that has most.
Eigen::Index most_layers(const Puncture& puncture) {
  Eigen::Index most = 0;
  for (const auto& row : puncture.layer_material.rowwise()) {
    most = std::max(most, (row.array() >= 0).count());
  }
  return most;
}

// Rows of nodes at which the surface breaks at less than the cut behind it.
std::int64_t weak_ruptures(const Puncture& puncture) {
  const std::int64_t rows = std::max<std::int64_t>(std::ssize(puncture.rupture),
                                                   puncture.layer_material.rows());
  std::int64_t weak = 0;
  for (std::int64_t i = 0; i < rows && puncture.rule == "force"; ++i) {
    const double rupture_n = row_of(puncture.rupture, i);
    const std::int32_t first =
        puncture.layer_material(puncture.layer_material.rows() == 1 ? 0 : i, 0);
    weak += rupture_n > 0.0 &&
            rupture_n < puncture.cutting_n[static_cast<std::size_t>(first)];
  }
  return weak;
}

// The ball that was pressed has the needle's own tip.
bool is_its_ball(const ToolShape& tool, const Puncture& puncture) {
  return tool.radius_m == puncture.radius_m && puncture.tip_angle_rad == 0.0;
}

void add_doubt(std::string& doubts, const std::string& doubt) {
  doubts += (doubts.empty() ? "" : "; ") + doubt;
}

}  // namespace

std::vector<double> numbers_of(const Puncture& puncture) {
  std::vector<double> numbers;
  const auto add = [&](const char* /*name*/, double number) {
    numbers.push_back(number);
  };
  for_each_puncture_number(puncture, add);
  for_each_optional_puncture_number(puncture, add);
  return numbers;
}

double membrane_j_of(const Puncture& puncture, std::size_t material) {
  return puncture.membrane_j.empty() ? std::numeric_limits<double>::quiet_NaN()
                                     : puncture.membrane_j[material];
}

const char* rupture_units(const Puncture& puncture) noexcept {
  return puncture.rule == "energy" ? "J" : "N";
}

Puncture rows_of(const Puncture& puncture, std::span<const std::int32_t> nodes) {
  Puncture part = puncture;
  if (puncture.rupture.size() > 1) {
    part.rupture.clear();
    for (const std::int32_t node : nodes) {
      part.rupture.push_back(puncture.rupture[static_cast<std::size_t>(node)]);
    }
  }
  part.layer_depth_m = matrix_rows(puncture.layer_depth_m, nodes);
  part.layer_material = matrix_rows(puncture.layer_material, nodes);
  return part;
}

Puncture rows_of(const Puncture& puncture, std::int64_t begin, std::int64_t count) {
  std::vector<std::int32_t> nodes(static_cast<std::size_t>(count));
  std::iota(nodes.begin(), nodes.end(), static_cast<std::int32_t>(begin));
  return rows_of(puncture, nodes);
}

bool same(const Puncture& a, const Puncture& b) {
  const auto same_shape = [](const auto& x, const auto& y) {
    return x.rows() == y.rows() && x.cols() == y.cols();
  };
  return a.rule == b.rule && a.material == b.material &&
         same_numbers(a.membrane_n, b.membrane_n) &&
         same_numbers(a.cutting_n, b.cutting_n) &&
         same_numbers(a.friction_n_per_m, b.friction_n_per_m) &&
         same_numbers(a.static_ratio, b.static_ratio) &&
         same_numbers(a.toughness_j_per_m2, b.toughness_j_per_m2) &&
         same_numbers(a.membrane_j, b.membrane_j) && numbers_of(a) == numbers_of(b) &&
         same_numbers(a.rupture, b.rupture) &&
         same_shape(a.layer_depth_m, b.layer_depth_m) &&
         same_numbers(flat_span(a.layer_depth_m), flat_span(b.layer_depth_m)) &&
         same_shape(a.layer_material, b.layer_material) &&
         a.layer_material == b.layer_material;
}

double last_layer_m(const Puncture& puncture, std::int64_t node) {
  const Eigen::Index row = puncture.layer_depth_m.rows() == 1 ? 0 : node;
  double last_m = 0.0;
  for (Eigen::Index k = 0; k < puncture.layer_depth_m.cols(); ++k) {
    const std::int32_t material = puncture.layer_material(row, k);
    if (material < 0) {
      break;
    }
    last_m = puncture.layer_depth_m(row, k);
    const auto m = static_cast<std::size_t>(material);
    if (std::isinf(puncture.membrane_n[m]) && std::isnan(membrane_j_of(puncture, m))) {
      break;
    }
  }
  return last_m;
}

std::string describe_tool(const ToolShape& tool, const Puncture& puncture) {
  if (puncture.empty() || !(puncture.radius_m > 0.0)) {
    return describe(tool);
  }
  std::string text = fmt::format("needle of radius {:.4g} mm", 1e3 * puncture.radius_m);
  if (puncture.tip_angle_rad > 0.0) {
    text += fmt::format(", tip angle {:.4g} deg",
                        puncture.tip_angle_rad * 180.0 / std::numbers::pi);
  }
  return is_its_ball(tool, puncture) ? text : text + ", pressed as " + describe(tool);
}

std::string doubts_of_depth(const ToolShape& tool, const Puncture& puncture,
                            double depth_m) {
  const double radii = puncture.radius_m > 0.0 ? depth_m / puncture.radius_m : 0.0;
  if (is_its_ball(tool, puncture) || !(radii > kComparedRadii)) {
    return {};
  }
  return fmt::format(
      "its curve goes {:.3g} radii deep, {:.3g} beyond the {:.0f} down "
      "to which such curves were compared with presses of a tip",
      radii, radii - kComparedRadii, kComparedRadii);
}

std::string describe(const Puncture& puncture) {
  if (puncture.empty()) {
    return {};
  }
  std::string text = "the first membrane breaks at ";
  const auto [low, high] = std::ranges::minmax(puncture.rupture);
  const char* const units = rupture_units(puncture);
  text += low == high ? fmt::format("{:.3g} {}", low, units)
                      : fmt::format("{:.3g} to {:.3g} {}", low, high, units);
  text += fmt::format("; up to {} layers", most_layers(puncture));
  for (std::size_t m = 0; m < puncture.material.size(); ++m) {
    text += "; " + describe_material(puncture, m);
  }
  return text;
}

std::string doubts_of(const Puncture& puncture) {
  std::string doubts;
  for (std::size_t m = 0; m < puncture.material.size(); ++m) {
    const std::string& name = puncture.material[m];
    const double toughness = puncture.toughness_j_per_m2[m];
    if (toughness > kToughestPuncture) {
      add_doubt(
          doubts,
          fmt::format("the toughness of {} is {:.4g} J/m^2, above {:.0f}: it is "
                      "likely from tear tests, which give 15 to 27 times too much "
                      "for a needle",
                      name, toughness, kToughestPuncture));
    }
    const double membrane_n = puncture.membrane_n[m];
    const double cutting_n = puncture.cutting_n[m];
    if (membrane_n > 0.0 && membrane_n < cutting_n &&
        std::isnan(membrane_j_of(puncture, m))) {
      add_doubt(doubts, fmt::format("the membrane of {} bears {:.3g} N, less than its "
                                    "cutting force {:.3g} N",
                                    name, membrane_n, cutting_n));
    }
  }
  if (const std::int64_t weak = weak_ruptures(puncture); weak > 0) {
    add_doubt(doubts, fmt::format("{} ruptures bear less than the cutting force of the "
                                  "first layer",
                                  weak));
  }
  return doubts;
}

}  // namespace palpate

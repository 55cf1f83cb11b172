#include "precompute/press/needle_layers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/material/material.h"
#include "precompute/press/node_yielding.h"

namespace palpate {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
// A layer thinner than this is none [m].
constexpr double kThinnestM = 1e-5;
// Length of shaft whose grip stands for the spring along it [m].
constexpr double kGripM = 0.01;

// Depths at which a ray crosses a surface (Moeller and Trumbore 1997).
void add_crossings(const SurfaceMesh& surface, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& along, std::vector<double>& depth_m) {
  for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
    const auto corner = [&](Eigen::Index j) -> Eigen::Vector3d {
      return surface.position_m.row(surface.triangle(t, j)).transpose();
    };
    // from + depth along = a + u (b - a) + v (c - a)
    Eigen::Matrix3d m;
    m << -along, corner(1) - corner(0), corner(2) - corner(0);
    const double volume = m.determinant();
    if (std::abs(volume) <= 1e-12 * m.col(1).norm() * m.col(2).norm()) {
      continue;
    }
    const Eigen::Vector3d at = m.inverse() * (from - corner(0));
    if (at[0] > 0.0 && at[1] >= 0.0 && at[2] >= 0.0 && at[1] + at[2] <= 1.0) {
      depth_m.push_back(at[0]);
    }
  }
}

struct NodeLayers {
  std::vector<double> depth_m;
  std::vector<std::int32_t> region;
  double end_m = kInfinite;  // of the body
};

// Regions along the axis, each from where it begins, as far as the body goes.
NodeLayers layers_below(const BodySource& body, const Eigen::Vector3d& node_m,
                        const Eigen::Vector3d& inward) {
  std::vector<double> ends_m;
  add_crossings(body.surface, node_m + kThinnestM * inward, inward, ends_m);
  const double end_m =
      ends_m.empty() ? kInfinite : *std::min_element(ends_m.begin(), ends_m.end());
  std::vector<double> cut_m;
  for (const InnerSurface& inner : body.inner) {
    if (inner.under_m > 0.0) {
      cut_m.push_back(inner.under_m);
    } else if (!inner.cavity) {
      add_crossings(inner.surface, node_m, inward, cut_m);
    }
  }
  std::sort(cut_m.begin(), cut_m.end());
  NodeLayers below;
  double begin_m = 0.0;
  for (std::size_t k = 0; k <= cut_m.size(); ++k) {
    const double next_m = k < cut_m.size() ? std::min(cut_m[k], end_m) : end_m;
    if (next_m - begin_m < kThinnestM) {
      continue;
    }
    const double within_m =
        std::isfinite(next_m) ? 0.5 * (begin_m + next_m) : begin_m + kThinnestM;
    const std::int32_t region = region_of(body, node_m + within_m * inward);
    if (below.region.empty() || below.region.back() != region) {
      below.depth_m.push_back(below.region.empty() ? 0.0 : begin_m);
      below.region.push_back(region);
    }
    begin_m = next_m;
  }
  if (below.region.empty()) {
    below = {{0.0}, {region_of(body, node_m)}};
  }
  below.end_m = end_m;
  return below;
}

double friction_n_per_m(const ScenePuncture& puncture, const SceneNeedle& needle) {
  if (puncture.friction) {
    return *puncture.friction * *puncture.radial_stress_pa * 2.0 * std::numbers::pi *
           needle.radius_m;
  }
  return puncture.friction_n_per_m.value_or(0.0);
}

// The scene's material of a region.
const SceneMaterial& material_of(const Scene& scene, std::int32_t region) {
  const std::string_view name =
      region == 0 ? kBodyRegion
                  : std::string_view(
                        scene.inclusion[static_cast<std::size_t>(region) - 1].name);
  return *std::find_if(scene.material.begin(), scene.material.end(),
                       [&](const SceneMaterial& m) {
                         return m.region == name;
                       });
}

void add_material(const SceneMaterial& material, const SceneNeedle& needle,
                  Puncture& all) {
  const std::optional<ScenePuncture>& puncture = material.puncture;
  const double cutting_n =
      puncture ? puncture->toughness_j_per_m2 * needle.edge_width_m : kInfinite;
  all.material.push_back(material.region);
  all.cutting_n.push_back(cutting_n);
  all.membrane_n.push_back(puncture ? puncture->membrane_n.value_or(cutting_n)
                                    : kInfinite);
  all.membrane_j.push_back(puncture ? puncture->membrane_j.value_or(kNotKnown)
                                    : kNotKnown);
  all.friction_n_per_m.push_back(puncture ? friction_n_per_m(*puncture, needle) : 0.0);
  all.static_ratio.push_back(puncture ? puncture->static_ratio : 1.0);
  all.toughness_j_per_m2.push_back(puncture ? puncture->toughness_j_per_m2 : kNotKnown);
}

// Row of a region's material, added if it is new.
std::int32_t row_of_region(const Scene& scene, const SceneNeedle& needle,
                           std::int32_t region, Puncture& all) {
  const SceneMaterial& material = material_of(scene, region);
  const auto row = static_cast<std::int32_t>(
      std::find(all.material.begin(), all.material.end(), material.region) -
      all.material.begin());
  if (row == std::ssize(all.material)) {
    add_material(material, needle, all);
  }
  return row;
}

// What breaks a node's first membrane: a force, or an energy.
double rupture_of(const Scene& scene, std::int32_t region, const Puncture& all,
                  std::int32_t row) {
  const std::optional<ScenePuncture>& puncture = material_of(scene, region).puncture;
  const bool by_energy = puncture && puncture->membrane_j;
  return by_energy ? *puncture->membrane_j
                   : all.membrane_n[static_cast<std::size_t>(row)];
}

void set_springs(const BodySource& body, const SceneNeedle& needle, Puncture& all) {
  const Material& own = body.material.front();
  const double e_pa = small_youngs_modulus_pa(own);
  // E = 2 G (1 + nu)
  const double nu = 0.5 * e_pa / small_shear_modulus_pa(own) - 1.0;
  const double plane_pa = e_pa / (1.0 - nu * nu);
  all.edge_width_m = needle.edge_width_m;
  all.lateral_n_per_m2 = needle.lateral_n_per_m2.value_or(0.65 * plane_pa);
  all.shaft_n_per_m =
      needle.shaft_n_per_m > 0.0 ? needle.shaft_n_per_m : 0.5 * plane_pa * kGripM;
  all.mouth_m = needle.mouth_m;
}

// Length of shaft that a node's axis has room for.
double insertable_m(const Puncture& all, const NodeLayers& node, Eigen::Index v) {
  for (std::size_t k = 0; k < node.depth_m.size(); ++k) {
    const auto m =
        static_cast<std::size_t>(all.layer_material(v, static_cast<Eigen::Index>(k)));
    if (std::isinf(all.cutting_n[m])) {
      return node.depth_m[k];
    }
  }
  return node.end_m;
}

// The longest of the nodes that the needle can reach. An axis that numbers let slip
// between two triangles has no end, and does not count.
double insertable_m(const Puncture& all, std::span<const NodeLayers> nodes,
                    std::span<const std::int32_t> reachable) {
  double most_m = 0.0;
  for (const std::int32_t v : reachable) {
    const double length_m = insertable_m(all, nodes[static_cast<std::size_t>(v)], v);
    most_m = std::isfinite(length_m) ? std::max(most_m, length_m) : most_m;
  }
  return most_m;
}

Puncture punctured(const Scene& scene, const BodySource& body,
                   const SceneNeedle& needle, const std::string& tool) {
  Puncture all;
  const Eigen::Index n = body.normal.rows();
  std::vector<NodeLayers> nodes;
  std::size_t most = 1;
  for (Eigen::Index v = 0; v < n; ++v) {
    nodes.push_back(layers_below(body, body.surface.position_m.row(v).transpose(),
                                 -body.normal.row(v).transpose()));
    nodes.back().depth_m.resize(std::min<std::size_t>(
        nodes.back().depth_m.size(), static_cast<std::size_t>(kMostPunctureLayers)));
    most = std::max(most, nodes.back().depth_m.size());
  }
  all.layer_depth_m.setConstant(n, static_cast<Eigen::Index>(most), kNotKnown);
  all.layer_material.setConstant(n, static_cast<Eigen::Index>(most), -1);
  std::size_t by_energy = 0;
  for (Eigen::Index v = 0; v < n; ++v) {
    const NodeLayers& node = nodes[static_cast<std::size_t>(v)];
    for (std::size_t k = 0; k < node.depth_m.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      all.layer_depth_m(v, column) = node.depth_m[k];
      all.layer_material(v, column) = row_of_region(scene, needle, node.region[k], all);
    }
    const std::optional<ScenePuncture>& first =
        material_of(scene, node.region.front()).puncture;
    by_energy += first && first->membrane_j ? 1 : 0;
    all.rupture.push_back(
        rupture_of(scene, node.region.front(), all, all.layer_material(v, 0)));
  }
  if (by_energy != 0 && by_energy != static_cast<std::size_t>(n)) {
    throw InputError(fmt::format(
        "[[tool]] {:?}: materials at the surface have membrane_j or not, must all have "
        "it or none",
        tool));
  }
  if (std::ssize(all.material) > kMostPunctureMaterials) {
    throw InputError(
        fmt::format("[[tool]] {:?} meets {} materials, must meet at most {}", tool,
                    all.material.size(), kMostPunctureMaterials));
  }
  all.rule = by_energy > 0 ? "energy" : "force";
  if (std::ranges::all_of(all.membrane_j, [](double j) {
        return std::isnan(j);
      })) {
    all.membrane_j.clear();
  }
  set_springs(body, needle, all);
  all.radius_m = needle.radius_m;
  all.tip_angle_rad = needle.tip_angle_rad;
  all.insertable_m = insertable_m(all, nodes, reachable_vertices(scene, body));
  return all;
}

}  // namespace

std::vector<Puncture> needle_layers(const Scene& scene, const BodySource& body) {
  std::vector<Puncture> tools;
  for (std::size_t t = 0; t < scene.tool_needle.size(); ++t) {
    const std::optional<SceneNeedle>& needle = scene.tool_needle[t];
    tools.push_back(needle ? punctured(scene, body, *needle, scene.tool[t].name)
                           : Puncture{});
  }
  const bool any = std::any_of(tools.begin(), tools.end(), [](const Puncture& p) {
    return !p.empty();
  });
  return any ? tools : std::vector<Puncture>{};
}

}  // namespace palpate

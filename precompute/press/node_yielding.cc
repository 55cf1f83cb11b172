#include "precompute/press/node_yielding.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_search.h"
#include "formats/response/memory_sites.h"
#include "precompute/surface/winding_number.h"

namespace palpate {
namespace {

double box_m3(const SurfaceMesh& surface) {
  return (surface.position_m.colwise().maxCoeff() -
          surface.position_m.colwise().minCoeff())
      .prod();
}

// How the region of a point yields; every region has a material.
const SceneYielding& material_under(const Scene& scene, const BodySource& body,
                                    const Eigen::Vector3d& p_m) {
  const std::int32_t region = region_of(body, p_m);
  const std::string name =
      region == 0 ? std::string(kBodyRegion)
                  : scene.inclusion[static_cast<std::size_t>(region) - 1].name;
  return std::find_if(scene.material.begin(), scene.material.end(),
                      [&](const SceneMaterial& material) {
                        return material.region == name;
                      })
      ->yielding;
}

void require_within(const Scene& scene, const SceneYielding& yielding,
                    const std::string& whose) {
  const double most_m = scene.reach.depth_max_m;
  const auto require = [&](const char* key, double depth_m) {
    if (!(depth_m < most_m)) {
      throw InputError(fmt::format(
          "{}: {} is {:.4g} m, must be less than depth_max_m of [reach], {:.4g} m: "
          "nothing that is pressed so deep yields",
          whose, key, depth_m, most_m));
    }
  };
  if (yielding.plastic) {
    require("plastic.yield_depth_m", yielding.plastic->yield_depth_m);
  }
  if (yielding.damage) {
    require("damage.onset_m", yielding.damage->onset_m);
  }
}

bool yields_somewhere(const Scene& scene) {
  const auto yields = [](const SceneYielding& yielding) {
    return yielding.plastic || yielding.damage;
  };
  return std::any_of(scene.tool_yielding.begin(), scene.tool_yielding.end(), yields) ||
         std::any_of(scene.material.begin(), scene.material.end(),
                     [&](const SceneMaterial& material) {
                       return yields(material.yielding);
                     });
}

bool all_same(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) ==
         values.end();
}

// Columns of one tool, from what each node has. A node that does not yield would at the
// largest depth: places between it and one that does yield somewhere between.
Yielding columns_of(const std::vector<const SceneYielding*>& of_node, double most_m) {
  const auto any = [&](const auto& has) {
    return std::any_of(of_node.begin(), of_node.end(), has);
  };
  Yielding all;
  if (any([](const SceneYielding* y) {
        return y->plastic && y->plastic->share > 0.0;
      })) {
    for (const SceneYielding* node : of_node) {
      const ScenePlastic plastic =
          node->plastic.value_or(ScenePlastic{.yield_depth_m = most_m});
      all.yield_depth_m.push_back(plastic.yield_depth_m);
      all.share.push_back(plastic.share);
    }
  }
  if (any([](const SceneYielding* y) {
        return y->damage && y->damage->largest > 0.0;
      })) {
    for (const SceneYielding* node : of_node) {
      const SceneDamage damage =
          node->damage.value_or(SceneDamage{.onset_m = most_m, .scale_m = most_m});
      all.onset_m.push_back(damage.onset_m);
      all.scale_m.push_back(damage.scale_m);
      all.largest.push_back(damage.largest);
    }
  }
  // One value stands for all nodes where no column varies.
  bool same = true;
  for_each_dataset(all, [&](const auto&, const auto&, const auto& values) {
    same = same && all_same(values);
  });
  for_each_dataset(all, [&](const auto&, const auto&, auto& values) {
    values.resize(same ? std::min<std::size_t>(1, values.size()) : values.size());
  });
  return all;
}

// The region of the thinnest layer that is deep enough; 0: none.
std::int32_t layer_of(const BodySource& body, const Eigen::Vector3d& p_m) {
  std::int32_t region = 0;
  double thinnest_m = std::numeric_limits<double>::infinity();
  double depth_m = -1.0;  // not known yet
  for (std::size_t i = 0; i < body.inner.size(); ++i) {
    const double under_m = body.inner[i].under_m;
    if (!(under_m > 0.0) || under_m >= thinnest_m) {
      continue;
    }
    if (depth_m < 0.0) {
      depth_m = SurfaceSearch(body.surface).nearest(p_m).distance_m;
    }
    if (depth_m < under_m) {
      region = static_cast<std::int32_t>(i) + 1;
      thinnest_m = under_m;
    }
  }
  return region;
}

}  // namespace

std::int32_t region_of(const BodySource& body, const Eigen::Vector3d& p_m) {
  std::int32_t region = layer_of(body, p_m);
  double smallest_m3 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < body.inner.size(); ++i) {
    const SurfaceMesh& surface = body.inner[i].surface;
    if (body.inner[i].cavity || body.inner[i].under_m > 0.0) {
      continue;
    }
    const double size_m3 = box_m3(surface);
    if (winding_number(surface, p_m) > 0.5 && size_m3 < smallest_m3) {
      region = static_cast<std::int32_t>(i) + 1;
      smallest_m3 = size_m3;
    }
  }
  return region;
}

std::vector<Yielding> node_yielding(const Scene& scene, const BodySource& body) {
  const double most_m = scene.reach.depth_max_m;
  if (!yields_somewhere(scene)) {
    return {};
  }
  for (const SceneMaterial& material : scene.material) {
    require_within(scene, material.yielding,
                   fmt::format("[[material]] of region {:?}", material.region));
  }
  std::vector<Yielding> tools;
  for (std::size_t t = 0; t < scene.tool.size(); ++t) {
    const SceneYielding own =
        t < scene.tool_yielding.size() ? scene.tool_yielding[t] : SceneYielding{};
    require_within(scene, own, fmt::format("[[tool]] {:?}", scene.tool[t].name));
    // The place of the largest shear, 0.48 contact radii deep (Johnson 1985), rounded
    // to half a radius. The radius is that at half of the largest depth.
    const double under_m = 0.5 * contact_radius_m(body.tool[t]->shape(), 0.5 * most_m);
    std::vector<SceneYielding> merged;
    for (Eigen::Index v = 0; v < body.normal.rows(); ++v) {
      const Eigen::Vector3d p_m =
          (body.surface.position_m.row(v) - under_m * body.normal.row(v)).transpose();
      const SceneYielding& under =
          own.plastic && own.damage ? own : material_under(scene, body, p_m);
      // What the tool states replaces what the material under the node has.
      merged.push_back({.plastic = own.plastic ? own.plastic : under.plastic,
                        .damage = own.damage ? own.damage : under.damage});
    }
    std::vector<const SceneYielding*> of_node;
    for (const SceneYielding& node : merged) {
      of_node.push_back(&node);
    }
    tools.push_back(columns_of(of_node, most_m));
  }
  return tools;
}

}  // namespace palpate

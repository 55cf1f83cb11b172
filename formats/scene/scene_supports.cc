// [[inclusion]], [[layer]] and [[support]]: what is in the body, where it is held.
#include <algorithm>

#include "formats/scene/scene_parts.h"

namespace palpate {
namespace scene_parts {
namespace {

constexpr std::string_view kInclusionKeys[] = {"name", "sphere", "mesh", "length_unit",
                                               "cavity"};
constexpr std::string_view kLayerKeys[] = {"name", "thickness_m"};
constexpr std::string_view kInclusionShapes[] = {"sphere", "mesh"};
constexpr std::string_view kSupportKeys[] = {"kind", "box_m", "plane", "patch",
                                             "stiffness_pa_per_m"};
constexpr std::string_view kSupportKinds[] = {"fixed", "foundation"};
constexpr std::string_view kSupportPlaces[] = {"box_m", "plane", "patch"};
constexpr std::string_view kPlaneKeys[] = {"point_m", "normal", "within_m"};

ScenePlane read_plane(const SceneSection& section) {
  const SceneSection table = section.table("plane", kPlaneKeys);
  ScenePlane plane{table.vector("point_m"), table.direction("normal")};
  plane.within_m = table.number_or(plane.within_m, "within_m", kPositive);
  return plane;
}

void read_place(const SceneSection& section, SceneSupport& support) {
  const std::string_view place = section.only_one_of(kSupportPlaces);
  if (place == "box_m") {
    support.box_m = section.box("box_m");
  } else if (place == "plane") {
    support.plane = read_plane(section);
  } else {
    support.patch = read_ball(section, "patch");
  }
}

// Of an inclusion or a layer; the scene has those before it.
std::string read_region_name(const SceneSection& section, const Scene& scene) {
  std::string name = section.text("name");
  if (name == kBodyRegion) {
    section.fail(section.need("name"),
                 "an inclusion cannot be named \"body\", which is what is around it");
  }
  for (const SceneInclusion& other : scene.inclusion) {
    if (other.name == name) {
      section.fail(section.need("name"), "the name {:?} belongs to two inclusions",
                   name);
    }
  }
  return name;
}

// From the surface inwards: each starts where the one before it ends.
void read_layers(const Sections& sections, Scene& scene) {
  if (!sections.has("layer")) {
    return;
  }
  double under_m = 0.0;
  for (const SceneSection& section : sections.all("layer", kLayerKeys)) {
    SceneInclusion layer;
    layer.name = read_region_name(section, scene);
    under_m += section.number("thickness_m", kPositive);
    layer.under_m = under_m;
    scene.inclusion.push_back(std::move(layer));
  }
}

}  // namespace

void read_inclusions(const Sections& sections, Scene& scene) {
  read_layers(sections, scene);
  if (!sections.has("inclusion")) {
    return;
  }
  for (const SceneSection& section : sections.all("inclusion", kInclusionKeys)) {
    SceneInclusion inclusion;
    inclusion.name = read_region_name(section, scene);
    if (section.only_one_of(kInclusionShapes) == "sphere") {
      inclusion.sphere = read_ball(section, "sphere");
      if (const toml::node* unit = section.find("length_unit")) {
        section.fail(*unit,
                     "length_unit in [[inclusion]] belongs to a mesh, a sphere "
                     "is in metres");
      }
    } else {
      inclusion.mesh = read_mesh_keys(section, sections.file());
    }
    inclusion.cavity = section.boolean_or(false, "cavity");
    scene.inclusion.push_back(std::move(inclusion));
  }
}

void read_supports(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("support", kSupportKeys)) {
    SceneSupport support;
    if (section.choice_or("fixed", "kind", kSupportKinds) == "foundation") {
      support.stiffness_pa_per_m = section.number("stiffness_pa_per_m", kPositive);
    } else if (const toml::node* stiffness = section.find("stiffness_pa_per_m")) {
      section.fail(*stiffness,
                   "stiffness_pa_per_m in [[support]] belongs to kind \"foundation\", "
                   "a fixed one does not yield");
    }
    read_place(section, support);
    scene.support.push_back(support);
  }
}

}  // namespace scene_parts

bool holds(const SceneSupport& support, const Eigen::Vector3d& p_m) {
  if (support.box_m) {
    return support.box_m->contains(p_m);
  }
  if (support.plane) {
    const Eigen::Vector3d apart = p_m - support.plane->point_m;
    const double below = -support.plane->normal.dot(apart);
    const double rounding = 1e-9 * apart.norm();
    return below >= -rounding && below <= support.plane->within_m + rounding;
  }
  return support.patch &&
         (p_m - support.patch->center_m).norm() <= support.patch->radius_m;
}

}  // namespace palpate

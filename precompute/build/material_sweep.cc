#include "precompute/build/material_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "formats/response/response_curve.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"

namespace palpate {
namespace {

constexpr double kMeshTimesFiner = 2.0;
constexpr double kDepthShareMin = 0.1;  // [-] of the depth: before, touch decides
constexpr double kErrorMax = 0.9;

using Constant = std::pair<const char*, double SceneMaterial::*>;

constexpr std::array<Constant, 9> kConstants{
    {{"youngs_modulus_pa", &SceneMaterial::youngs_modulus_pa},
     {"poissons_ratio", &SceneMaterial::poissons_ratio},
     {"c10_pa", &SceneMaterial::c10_pa},
     {"c01_pa", &SceneMaterial::c01_pa},
     {"youngs_modulus_fibre_pa", &SceneMaterial::youngs_modulus_fibre_pa},
     {"shear_modulus_fibre_pa", &SceneMaterial::shear_modulus_fibre_pa},
     {"poissons_ratio_fibre", &SceneMaterial::poissons_ratio_fibre},
     {"k1_pa", &SceneMaterial::k1_pa},
     {"k2", &SceneMaterial::k2}}};

// "mu_pa.2" or "alpha.1": the list and the place in it, from 0.
double* listed_constant(SceneMaterial& material, const std::string& constant) {
  for (const auto& [name, list] :
       {std::pair{"mu_pa.", &material.mu_pa}, std::pair{"alpha.", &material.alpha}}) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (constant == fmt::format("{}{}", name, i + 1)) {
        return &(*list)[i];
      }
    }
  }
  return nullptr;
}

// The constant's place, or none if the material does not have it.
double* place_of(SceneMaterial& material, const std::string& constant) {
  for (const auto& [name, member] : kConstants) {
    if (constant == name && material.*member != 0.0) {
      return &(material.*member);
    }
  }
  return listed_constant(material, constant);
}

std::vector<std::string> constants_of(const SceneMaterial& material) {
  std::vector<std::string> names;
  for (const auto& [name, member] : kConstants) {
    if (material.*member != 0.0) {
      names.emplace_back(name);
    }
  }
  for (std::size_t i = 0; i < material.mu_pa.size(); ++i) {
    names.push_back(fmt::format("mu_pa.{}", i + 1));
    names.push_back(fmt::format("alpha.{}", i + 1));
  }
  return names;
}

// Force along the tool's way against depth from the first touch.
ResponseCurve curve_of(const PressedNode& pressed, const std::string& where) {
  const auto& sample = pressed.indentation.sample;
  if (sample.size() < 2) {
    throw NumericalError(fmt::format("{}: {}", where,
                                     pressed.failure.empty()
                                         ? "the tool does not touch the body"
                                         : pressed.failure));
  }
  std::vector<double> depth_m;
  std::vector<double> force_n;
  for (const IndentationSample& s : sample) {
    depth_m.push_back(s.penetration_m - sample.front().penetration_m);
    force_n.push_back(s.force_n.dot(pressed.path.outward));
  }
  force_n.front() = 0.0;
  return {depth_m, force_n};
}

std::string where_of(std::int32_t vertex, const ResponseSweep& sweep,
                     std::size_t combination) {
  const std::vector<double> value = sweep.values_at(combination);
  std::string text = fmt::format("vertex {}", vertex);
  for (std::size_t j = 0; j < value.size(); ++j) {
    text += fmt::format(", {} = {:.6g}", sweep.parameter[j].name, value[j]);
  }
  return text;
}

std::vector<PressedNode> pressed_with(const Scene& scene, const BodySource& body,
                                      const SharedTool& tool,
                                      std::span<const std::int32_t> vertices,
                                      const ContactFocus& focus) {
  const PressMode mode{.nonlinear = is_nonlinear(scene, body),
                       .options = nonlinear_options(scene, tool)};
  return press_on_own_mesh(scene, body, tool, vertices, focus, mode);
}

void sample_curves(const std::vector<ResponseCurve>& curves, int samples,
                   ResponseSweep& sweep) {
  double deepest = std::numeric_limits<double>::infinity();
  for (const ResponseCurve& curve : curves) {
    deepest = std::min(deepest, curve.depth_max_m());
  }
  for (int k = 1; k <= samples; ++k) {
    const double share = static_cast<double>(k) / samples;
    sweep.depth_m.push_back(deepest * share * share);
  }
  const std::size_t vertices = sweep.vertex.size();
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t c = 0; c < sweep.combinations(); ++c) {
      for (const double depth_m : sweep.depth_m) {
        sweep.force_n.push_back(curves[c * vertices + v].at(depth_m).force_n);
      }
    }
  }
}

double largest_difference(const ResponseSweep& sweep, std::size_t place,
                          std::size_t combination, const ResponseCurve& better) {
  double largest = 0.0;
  for (std::size_t k = 0; k < sweep.depth_m.size(); ++k) {
    const double depth_m = std::min(sweep.depth_m[k], better.depth_max_m());
    if (depth_m >= kDepthShareMin * sweep.depth_m.back()) {
      const double force_n = better.at(depth_m).force_n;
      largest = std::max(
          largest, std::abs(sweep.curve_n(place, combination)[k] / force_n - 1.0));
    }
  }
  return largest;
}

}  // namespace

SweepParameter grid_of(const std::string& name, double from, double to, int count) {
  if (!(from > 0.0) || !(to > from) || !std::isfinite(to) || count < 2 || count > 100) {
    throw InputError(fmt::format(
        "sweep of {}: {} values from {} to {}: must be 2 to 100, positive, rising",
        name, count, from, to));
  }
  SweepParameter grid{name, {}};
  for (int i = 0; i < count; ++i) {
    grid.value.push_back(from * reproducible::pow(to / from, i / (count - 1.0)));
  }
  grid.value.back() = to;
  return grid;
}

void set_constant(Scene& scene, const std::string& name, double value) {
  std::vector<std::string> regions;
  for (SceneMaterial& material : scene.material) {
    regions.push_back(material.region);
    const std::string prefix = material.region + ".";
    const bool named = name.starts_with(prefix);
    if (!named && material.region != kBodyRegion) {
      continue;
    }
    const std::string constant = named ? name.substr(prefix.size()) : name;
    if (double* place = place_of(material, constant)) {
      *place = value;
      return;
    }
    if (named) {
      throw InputError(fmt::format(
          "sweep: the material of {:?} has no constant {:?}; "
          "it has: {}",
          material.region, constant, fmt::join(constants_of(material), ", ")));
    }
  }
  throw InputError(
      fmt::format("sweep: no material has {:?}; write region.constant, regions: {}; "
                  "the first has: {}",
                  name, fmt::join(regions, ", "),
                  fmt::join(constants_of(scene.material.front()), ", ")));
}

ResponseSweep sweep_materials(const Scene& scene, const BodySource& body,
                              const SharedTool& tool,
                              std::span<const std::int32_t> vertices,
                              std::vector<SweepParameter> parameters,
                              Progress& progress) {
  ResponseSweep sweep;
  sweep.parameter = std::move(parameters);
  sweep.vertex.assign(vertices.begin(), vertices.end());
  Scene changed = scene;
  BodySource changed_body = body;
  for (std::size_t c = 0; c < sweep.combinations(); ++c) {  // wrong values first
    for (std::size_t j = 0; j < sweep.parameter.size(); ++j) {
      set_constant(changed, sweep.parameter[j].name, sweep.values_at(c)[j]);
    }
    (void)materials_of(changed);
  }
  const ContactFocus focus = contact_focus(scene, body);
  progress.stage("sweep");
  std::vector<ResponseCurve> curves;
  for (std::size_t c = 0; c < sweep.combinations(); ++c) {
    for (std::size_t j = 0; j < sweep.parameter.size(); ++j) {
      set_constant(changed, sweep.parameter[j].name, sweep.values_at(c)[j]);
    }
    changed_body.material = materials_of(changed);
    for (const PressedNode& pressed :
         pressed_with(changed, changed_body, tool, vertices, focus)) {
      curves.push_back(curve_of(pressed, where_of(pressed.vertex, sweep, c)));
    }
    progress.advance(c + 1, sweep.combinations(), "combinations");
  }
  progress.finish();
  sample_curves(curves, scene.accuracy.depths, sweep);
  // The mesh's error is that of the middle combination, against a finer mesh.
  const std::size_t middle = sweep.combinations() / 2;
  for (std::size_t j = 0; j < sweep.parameter.size(); ++j) {
    set_constant(changed, sweep.parameter[j].name, sweep.values_at(middle)[j]);
  }
  changed_body.material = materials_of(changed);
  const auto finer_presses = pressed_with(changed, changed_body, tool, vertices,
                                          finer(focus, kMeshTimesFiner));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const ResponseCurve better =
        curve_of(finer_presses[v], where_of(vertices[v], sweep, middle) + ", finer");
    sweep.error_relative =
        std::max(sweep.error_relative, largest_difference(sweep, v, middle, better));
  }
  sweep.error_relative = std::min(sweep.error_relative, kErrorMax);
  check(sweep);
  return sweep;
}

}  // namespace palpate

// A body pressed by a rigid tool at its origin, for studies of accuracy.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "precompute/contact/linear_indentation.h"
#include "precompute/contact/nonlinear_indentation.h"
#include "precompute/fem/batched_solves.h"
#include "precompute/surface/refine_surface.h"
#include "precompute/tets/tetrahedralise.h"
#include "tests/support/study_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {

// Every contact has this radius at the largest depth.
inline constexpr double kContactRadius_m = 1e-3;
inline constexpr double kYoung_pa = 10e3;
// A half-space is a block of so many contact radii: it adds about 0.2 % of force.
inline constexpr double kLargeBlock = 400.0;

// Transversely isotropic, axis along z, with its plane modulus M in place of E*.
struct Transverse {
  double youngs_along = 0.0, youngs_across = 0.0, shear_along = 0.0, poisson_lt = 0.0,
         poisson_tt = 0.0;
  double plane_modulus = 0.0;
};

// A slab [-half_width, half_width]^2 x [-depth, 0], held at its floor.
struct Body {
  double half_width_m = kLargeBlock * kContactRadius_m;
  double depth_m = kLargeBlock * kContactRadius_m;
  double poissons_ratio = 0.3;

  std::optional<Transverse> transverse = std::nullopt;  // in units of kYoung_pa
  bool neo_hookean_law = false;

  [[nodiscard]] Material material() const {
    if (transverse) {
      return transversely_isotropic(
          kYoung_pa * transverse->youngs_along, kYoung_pa * transverse->youngs_across,
          kYoung_pa * transverse->shear_along, transverse->poisson_lt,
          transverse->poisson_tt, Eigen::Vector3d::UnitZ(), false);
    }
    if (neo_hookean_law) {
      return neo_hookean(kYoung_pa, poissons_ratio);
    }
    return linear(kYoung_pa, poissons_ratio);
  }
  [[nodiscard]] double plane_modulus_pa() const {
    if (transverse) {
      return kYoung_pa * transverse->plane_modulus;
    }
    return kYoung_pa / (1.0 - poissons_ratio * poissons_ratio);
  }
};

// Edges are growth times the distance from a circle about the origin on the top, never
// shorter than finest_m. A circle without radius is the origin itself.
struct Grading {
  double growth = 0.7;
  double finest_m = 0.0;
  double circle_m = 0.0;
  bool apex = false;    // and from the origin
  bool inside = false;  // inside the body too, where tets otherwise grow by themselves
};

struct Press {
  std::string where;
  double depth_m = 0.0;
  double force_n = 0.0;  // reference
};

// Thin bodies have two edges or more through their thickness under the contact.
// @param parameter growth, finest_m, circle_m, apex, and the body's depth_m.
inline double graded_edge_m(const Eigen::Vector3d& p,
                            const std::array<double, 5>& parameter) {
  const auto& [growth, finest_m, circle_m, apex, depth_m] = parameter;
  const double r = std::hypot(p.x(), p.y());
  double distance = std::hypot(r - circle_m, p.z());
  if (apex != 0.0) {
    distance = std::min(distance, p.norm());
  }
  const double beside = std::max(0.0, r - kContactRadius_m - depth_m);
  const double thin = 0.5 * depth_m + 0.7 * beside;
  return std::min(std::max(growth * distance, finest_m), thin);
}

// A body ready to be pressed at its origin.
class Bench {
 public:
  Bench(const Body& body, const Grading& grading) : material_{body.material()} {
    const SurfaceMesh coarse =
        graded_block(body.half_width_m, body.depth_m, 0.5 * body.half_width_m, 2);
    const std::array<double, 5> parameter{grading.growth, grading.finest_m,
                                          grading.circle_m, grading.apex ? 1.0 : 0.0,
                                          body.depth_m};
    const SurfaceMesh fine = refine_longest_edge(
        coarse,
        [&](const Eigen::Vector3d& p) {
          return graded_edge_m(p, parameter);
        },
        200000);
    TetOptions options;
    if (grading.inside) {
      options.size = graded_edge_m;
      options.size_parameter = parameter;
    }
    const TetMesh tets = tetrahedralise(fine, options);
    tets_ = tets.tet.rows();
    mesh_ = make_quadratic(tets, fine.triangle);
    const double w = body.half_width_m;
    const double floor_m = -body.depth_m * (1.0 - 1e-9);
    const Eigen::AlignedBox3d floor(Eigen::Vector3d(-2.0 * w, -2.0 * w, 2.0 * floor_m),
                                    Eigen::Vector3d(2.0 * w, 2.0 * w, floor_m));
    supports_ = hold_boxes(mesh_, std::span(&floor, 1));
    surface_ = make_contact_surface(mesh_);
    factor_ = std::make_unique<CholeskyFactor>(
        reduce(assemble_stiffness(mesh_, material_), supports_));
  }

  // The nodes that the tool may touch at the largest depth.
  void reach(const ToolShape& tool, double depth_m, double spacing_m) {
    path_ = {.vertex_m = Eigen::Vector3d::Zero(),
             .outward = Eigen::Vector3d::UnitZ(),
             .tool = std::make_shared<const ToolSurface>(tool),
             .depth_max_m = depth_m,
             .force_max_n = std::numeric_limits<double>::infinity(),
             .samples = 1};
    patch_ = contact_patch(surface_, supports_, surface_.of_mesh_node[0], path_.outward,
                           patch_radius_m(path_, spacing_m));
    compliance_ =
        std::make_unique<SurfaceCompliance>(*factor_, supports_, surface_, patch_);
  }

  [[nodiscard]] IndentationSample press(double depth_m) const {
    IndentationPath path = path_;
    path.depth_max_m = depth_m;
    const Indentation indentation = indent(surface_, *compliance_, patch_, path);
    if (!indentation.converged || indentation.edge_share > 0.0) {
      throw std::runtime_error("the contact was not found");
    }
    return indentation.sample.back();
  }

  // Pressed a little without friction, then stuck to the tool.
  [[nodiscard]] double stuck_force_n(double depth_m) const {
    std::vector<PressStep> steps;
    for (const double depth : {1e-3 * depth_m, depth_m}) {
      steps.push_back({depth, tool_at(path_, depth), press(depth).pressure_n});
    }
    NonlinearOptions options;
    options.sticking = true;
    options.equilibrium.multiplier_relative = 1e-3;
    const NonlinearIndentation result = indent_nonlinear(
        {mesh_, material_, supports_, surface_}, patch_, compliance_->among(patch_),
        0.0, steps,
        [this](double depth) {
          return tool_at(path_, depth);
        },
        single_solves(*factor_), options);
    if (!result.converged()) {
      throw std::runtime_error(result.failure);
    }
    return result.sample.back().force_n.z();
  }

  // Forces of the nonlinear body at growing depths.
  [[nodiscard]] std::vector<double> path_force_n(std::span<const Press> presses) const {
    std::vector<PressStep> steps;
    for (const Press& at : presses) {
      steps.push_back(
          {at.depth_m, tool_at(path_, at.depth_m), press(at.depth_m).pressure_n});
    }
    const NonlinearIndentation result =
        indent_nonlinear({mesh_, material_, supports_, surface_}, patch_,
                         compliance_->among(patch_), 0.0, steps,
                         [this](double depth) {
                           return tool_at(path_, depth);
                         },
                         single_solves(*factor_), {});
    if (!result.converged()) {
      throw std::runtime_error(result.failure);
    }
    std::vector<double> force;
    for (const NonlinearSample& sample : result.sample) {
      force.push_back(sample.force_n.z());
    }
    return force;
  }

  [[nodiscard]] Eigen::Index tets() const { return tets_; }
  [[nodiscard]] std::size_t patch() const { return patch_.size(); }

 private:
  std::vector<Material> material_;
  Eigen::Index tets_ = 0;
  QuadraticMesh mesh_;
  Supports supports_;
  ContactSurface surface_;
  std::unique_ptr<CholeskyFactor> factor_;
  IndentationPath path_;
  std::vector<std::int32_t> patch_;
  std::unique_ptr<SurfaceCompliance> compliance_;
};

}  // namespace palpate

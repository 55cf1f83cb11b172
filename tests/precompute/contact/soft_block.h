// Blocks on a floor, and a ball above the middle, for tests of contact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "precompute/contact/contact_gap.h"
#include "precompute/contact/contact_surface.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/batched_solves.h"
#include "precompute/fem/linear_elasticity.h"
#include "precompute/material/material.h"
#include "tests/support/box_tets.h"
#include "tests/support/tool_shapes.h"

namespace palpate {

/// As deep as half of its width, its top at z = 0, held below, fine around the middle.
struct HeldBlock {
  /// Arguments as of graded().
  HeldBlock(double half_m, double inner_m, double fine_m, double growth) {
    const std::vector<double> x = graded(half_m, inner_m, fine_m, growth);
    const std::vector<double> z(
        x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2) + 1);
    const BoxTets box = box_tets(x, x, z);
    mesh = make_quadratic(box.tets, box.surface);
    const Eigen::AlignedBox3d floor(Eigen::Vector3d::Constant(-1),
                                    Eigen::Vector3d(1, 1, -half_m + 1e-9));
    supports = hold_boxes(mesh, std::span(&floor, 1));
    surface = make_contact_surface(mesh);
  }

  QuadraticMesh mesh;
  Supports supports;
  ContactSurface surface;
};

/// 40 x 40 x 20 mm; contact nodes are those of the top within 9 mm of the middle.
struct SoftBlock : HeldBlock {
  static constexpr double kRadius = 0.006;

  explicit SoftBlock(const Material& law)
      : HeldBlock(0.02, 0.004, 0.004, 2.0), material{law} {
    stiffness = reduce(assemble_stiffness(mesh, material), supports);
    factor = std::make_unique<CholeskyFactor>(stiffness);
    solve = single_solves(*factor);
    for (std::size_t v = 0; v < surface.node.size(); ++v) {
      const ContactNode& node = surface.node[v];
      if (node.normal.z() > 0.9 && node.position_m.norm() < 0.009) {
        patch.push_back(static_cast<std::int32_t>(v));
      }
    }
  }

  std::array<Material, 1> material;
  std::shared_ptr<const ToolSurface> ball =
      std::make_shared<const ToolSurface>(sphere(kRadius));
  Stiffness stiffness;  // over free unknowns, lower triangle
  std::unique_ptr<CholeskyFactor> factor;
  RestSolve solve;
  std::vector<std::int32_t> patch;
};

}  // namespace palpate

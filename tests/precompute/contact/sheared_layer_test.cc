// The lateral stiffness of contacts on layers, against the rigid shift of all nodes in
// contact.
#include <array>
#include <memory>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "formats/response/tangent_frame.h"
#include "precompute/contact/lateral_state.h"
#include "precompute/contact/patch_state.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kPunchM = 0.006;
constexpr double kShearedM = 2e-4;
constexpr double kLayerPa = 10e3;

// A punch on a layer that is held below.
struct ShearedLayer {
  ShearedLayer(double half_m, double thickness_m, double poissons_ratio,
               const ToolShape& tool) {
    constexpr double kGridM = 0.001;
    const std::vector<double> x = graded(half_m, 0.0065, kGridM, 2.2);
    const std::vector<double> z{-thickness_m, -thickness_m / 2, 0.0};
    const BoxTets box = box_tets(x, x, z);
    const QuadraticMesh mesh = make_quadratic(box.tets, box.surface);
    const Eigen::AlignedBox3d floor(Eigen::Vector3d::Constant(-1),
                                    Eigen::Vector3d(1, 1, -thickness_m + 1e-9));
    const Supports supports = hold_boxes(mesh, std::span(&floor, 1));
    const ContactSurface surface = make_contact_surface(mesh);
    const std::array<Material, 1> gel{linear(kLayerPa, poissons_ratio)};
    const CholeskyFactor factor(reduce(assemble_stiffness(mesh, gel), supports));
    std::int32_t centre = -1;
    for (std::size_t i = 0; i < surface.node.size(); ++i) {
      if (surface.node[i].position_m.norm() < 1e-12) {
        centre = static_cast<std::int32_t>(i);
      }
    }
    const IndentationPath path{.vertex_m = Eigen::Vector3d::Zero(),
                               .outward = Eigen::Vector3d::UnitZ(),
                               .tool = std::make_shared<const ToolSurface>(tool),
                               .depth_max_m = kShearedM,
                               .force_max_n = 1e9,
                               .samples = 8};
    const std::vector<std::int32_t> patch =
        contact_patch(surface, supports, centre, Eigen::Vector3d::UnitZ(),
                      patch_radius_m(path, kGridM / 2));
    const SurfaceCompliance compliance(factor, supports, surface, patch);
    Indentation press = indent(surface, compliance, patch, path);
    add_pressure_states(surface, patch, path, press);
    add_lateral_states(factor, supports, surface, compliance, patch, path, press);
    const ContactTable contact = stored_contact(press, path);
    found_n_per_m =
        lateral_at(contact, 0, 1.0) * press.sample.back().force_n.z() / kShearedM;
    rigid_n_per_m = rigid(factor, supports, surface, patch, press.sample.back());
  }

  // All nodes in contact are moved along the surface as one.
  static Eigen::Matrix2d rigid(const CholeskyFactor& factor, const Supports& supports,
                               const ContactSurface& surface,
                               const std::vector<std::int32_t>& patch,
                               const IndentationSample& sample) {
    std::vector<std::int32_t> in;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      if (sample.pressure_n[static_cast<Eigen::Index>(i)] > 0.0) {
        in.push_back(patch[i]);
      }
    }
    const auto n = static_cast<Eigen::Index>(in.size());
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(supports.free, 2 * n);
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(2 * n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ContactNode& node = node_of(surface, in[static_cast<std::size_t>(i)]);
      double sum = 0.0;
      for (const NodalForce& entry : node.load) {
        sum += entry.force.z();
      }
      for (const NodalForce& entry : node.load) {
        for (int axis = 0; axis < 2; ++axis) {
          const std::int64_t row =
              supports.free_index[3 * static_cast<std::size_t>(entry.node) +
                                  static_cast<std::size_t>(axis)];
          if (row >= 0) {
            load(row, 2 * i + axis) += entry.force.z() / sum;
          }
        }
      }
      whole.block<2, 2>(2 * i, 0).setIdentity();
    }
    const Eigen::MatrixXd W = load.transpose() * factor.solve(load);
    return whole.transpose() * W.ldlt().solve(whole);
  }

  Eigen::Matrix2d found_n_per_m;
  Eigen::Matrix2d rigid_n_per_m;
};

// G A / h, off by the free sides: by their share, which is linear in h.
TEST(ShearedLayer, ABlockUnderAPlateIsAsStiffAsAShearBlock) {
  constexpr double kHalfM = 0.006;
  const ToolShape plate{.name = "plate", .kind = "flat-punch", .radius_m = 0.02};
  for (const double nu : {0.3, 0.49}) {
    const auto over_closed_form = [&](double thickness_m) {
      const ShearedLayer block(kHalfM, thickness_m, nu, plate);
      EXPECT_NEAR(block.found_n_per_m(0, 0) / block.rigid_n_per_m(0, 0), 1.0, 0.02)
          << nu << " " << thickness_m;
      EXPECT_NEAR(block.found_n_per_m(0, 1) / block.rigid_n_per_m(0, 0), 0.0, 0.01);
      return block.found_n_per_m(0, 0) * 2 * (1 + nu) * thickness_m /
             (kLayerPa * 4 * kHalfM * kHalfM);
    };
    const double thick = over_closed_form(0.001);
    const double thin = over_closed_form(0.0005);
    EXPECT_LT(thick, thin) << nu;
    EXPECT_NEAR(2 * thin - thick, 1.0, 0.02) << nu;
  }
}

// On skin over bone the pressure gathers in the middle; what shears it does not.
TEST(ShearedLayer, AThinLayerIsAsStiffAsItsRigidShift) {
  const ToolShape punch{.name = "punch", .kind = "flat-punch", .radius_m = kPunchM};
  for (const double nu : {0.3, 0.49}) {
    const ShearedLayer layer(0.015, 0.001, nu, punch);
    const double ratio = layer.found_n_per_m(0, 0) / layer.rigid_n_per_m(0, 0);
    EXPECT_GT(ratio, 0.95) << nu;
    EXPECT_LT(ratio, 1.01) << nu;  // at most true, but for the normal stiffness' own
  }
}

}  // namespace
}  // namespace palpate

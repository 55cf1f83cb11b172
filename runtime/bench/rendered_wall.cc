#include "runtime/bench/rendered_wall.h"

#include <cmath>
#include <limits>

#include "runtime/bench/bench_body.h"
#include "runtime/bench/paper_wall.h"
#include "runtime/paper/scalar_model.h"

namespace palpate {
namespace {

constexpr double kRadiusM = 0.06;   // of the cylinder
constexpr double kAsideM = 0.005;   // of its crest
constexpr double kSampleM = 0.005;  // knots of the curves: the knee is one
constexpr int kCells = 4;           // a patch that the fast process holds whole
constexpr double kCellM = 0.004;

void set_response(ElementNode& node, WallShape shape, double k) {
  node.samples = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const SlowValue at = response(shape, k, static_cast<double>(i) * kSampleM);
    node.depth_m[i] = at.x_m;
    node.force_n[i] = at.f_n;
    node.stiffness_n_per_m[i] = shape == WallShape::kLinear ? k : at.k_n_per_m;
    node.energy_j[i] = at.energy_j;
  }
}

// Rolls the flat patch up around an axis along y, its middle to the crest at z = 0.
void roll_up(ElementNode& node) {
  const double angle = (node.position_m[0] - 0.5 * kCells * kCellM) / kRadiusM;
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  node.position_m = {kRadiusM * s, node.position_m[1], kRadiusM * (c - 1.0)};
  node.normal = {s, 0.0, c};
  node.direction = node.normal;
}

std::vector<Element> wall_elements(WallShape shape, double k,
                                   const WallRelaxation& relaxation) {
  const bool cylinder = shape == WallShape::kCylinder;
  std::vector<Element> elements = make_bench_body({.cells = cylinder ? kCells : 1,
                                                   .cell_m = kCellM,
                                                   .relaxing = relaxation.share,
                                                   .relaxation_s = relaxation.time_s})
                                      .element;
  for (Element& element : elements) {
    for (ElementNode& node : element.node) {
      set_response(node, shape, k);
      if (cylinder) {
        roll_up(node);
      }
    }
  }
  return elements;
}

// Within the cell beside the crest; else inside the first element.
Eigen::Vector3d place_of_tool(WallShape shape) {
  return shape == WallShape::kCylinder
             ? Eigen::Vector3d(kAsideM, 0.4 * kCells * kCellM, 0.0)
             : Eigen::Vector3d(2e-3, 1e-3, 0.0);
}

// Depth along the cylinder's normal, and its share of z.
struct OnCylinder {
  explicit OnCylinder(double x_m)
      : from_axis_m(std::hypot(kAsideM, kRadiusM - x_m)),
        upwards((kRadiusM - x_m) / from_axis_m) {}
  double from_axis_m;
  double upwards;
};

}  // namespace

SlowValue response(WallShape shape, double k_n_per_m, double x_m) noexcept {
  if (shape != WallShape::kLinear) {
    return wall_response(k_n_per_m, x_m);
  }
  return x_m > 0.0
             ? SlowValue{x_m, k_n_per_m * x_m, k_n_per_m, 0.5 * k_n_per_m * x_m * x_m}
             : SlowValue{x_m, 0.0, 0.0, 0.0};
}

RenderedWall::RenderedWall(LocalModel model, WallShape shape, double k_n_per_m,
                           const WallRelaxation& relaxation)
    : shape_(shape), k_(k_n_per_m) {
  if (!follows_surface(model) && shape != WallShape::kCylinder &&
      relaxation.share.empty()) {
    model_.kind = model;
    return;
  }
  element_ = wall_elements(shape, k_n_per_m, relaxation);
  at_ = place_of_tool(shape);
  const std::size_t active = shape == WallShape::kCylinder ? element_.size() / 2 : 0;
  element_[active].active = true;
  state_ = std::make_unique<FastState>();
  state_->config.model = model;
  state_->config.force_max_n = std::numeric_limits<double>::infinity();
  state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
}

double RenderedWall::tick(double x_m, double dt_s, bool slow) noexcept {
  if (scalar()) {
    advance(model_, ledger_, x_m, dt_s);
    if (slow) {
      update(model_, ledger_, response(shape_, k_, x_m));
    }
    return force_n(model_, x_m);
  }
  if (slow) {
    for (const Element& element : element_) {
      accept(*state_, element);
    }
  }
  at_.z() = -x_m;
  return step(*state_, {at_, 0}, dt_s).force_n.z();
}

double RenderedWall::work_j() const noexcept {
  return scalar() ? ledger_.work_j : state_->ledger.work_j;
}

double RenderedWall::true_force_n(double x_m) const noexcept {
  if (shape_ != WallShape::kCylinder) {
    return response(shape_, k_, x_m).f_n;
  }
  const OnCylinder at(x_m);
  return at.upwards * response(shape_, k_, kRadiusM - at.from_axis_m).f_n;
}

}  // namespace palpate

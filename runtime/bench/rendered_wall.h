// A wall through a local model, on one axis: what the benches of stability lean on.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "runtime/account/local_model.h"
#include "runtime/element/element.h"
#include "runtime/fast/fast_step.h"
#include "runtime/paper/slow_value_curve.h"

namespace palpate {

enum class WallShape : std::uint8_t {
  kLinear,     ///< f = k x
  kNonlinear,  ///< the paper's (25), on a flat body
  kCylinder,   ///< the paper's (31), along the normals of a cylinder (5.2.4)
};
constexpr std::array<WallShape, 3> kWallShapes{
    WallShape::kLinear, WallShape::kNonlinear, WallShape::kCylinder};

[[nodiscard]] constexpr std::string_view name(WallShape shape) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"linear", "nonlinear", "cylinder"};
  return kNames[static_cast<std::size_t>(shape)];
}

/// Response along the normal at penetration x_m [m].
[[nodiscard]] SlowValue response(WallShape shape, double k_n_per_m,
                                 double x_m) noexcept;

/// How a wall relaxes; its response is then that to a sudden press.
struct WallRelaxation {
  std::vector<double> share = {};   ///< [-] g_k >= 0, sum <= 1; none: it does not
  std::vector<double> time_s = {};  ///< [s] tau_k > 0, rising, as many
};

/// The wall and the two processes that render it. The tool is a point that moves along
/// z, over the cylinder 5 mm aside of the crest.
class RenderedWall {
 public:
  RenderedWall(LocalModel model, WallShape shape, double k_n_per_m,
               const WallRelaxation& relaxation = {});

  /// One fast tick with the tool x_m [m] deep below z = 0. @param slow the slow process
  /// has its turn. @return force against x [N].
  double tick(double x_m, double dt_s, bool slow) noexcept;

  /// Work that the tool has put in [J].
  [[nodiscard]] double work_j() const noexcept;

  /// Force of the response itself at x_m [N], along z.
  [[nodiscard]] double true_force_n(double x_m) const noexcept;

 private:
  [[nodiscard]] bool scalar() const noexcept { return state_ == nullptr; }

  WallShape shape_;
  double k_;
  ScalarModel model_;
  PassivityLedger ledger_;
  std::unique_ptr<FastState> state_;  // null: model_ alone, along z
  std::vector<Element> element_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate

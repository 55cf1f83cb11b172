// Bodies that relax, and a hand on them: what the tests of the fast step share.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/relaxation_reference.h"

namespace palpate {

inline void set_terms(BenchBodyOptions& options, const PronyTerms2& terms) {
  options.relaxing = {terms.g[0], terms.g[1]};
  options.relaxation_s = {terms.tau_s[0], terms.tau_s[1]};
}

/// Without clamps.
inline std::unique_ptr<FastState> free_state(LocalModel model, double tool_radius_m) {
  auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = tool_radius_m;
  state->config.force_max_n = 1e9;
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

/// A tool of no radius on a flat body, pressed along z.
class PressedPlace {
 public:
  PressedPlace(const BenchBody& body, LocalModel model, const Eigen::Vector2d& at_m)
      : body_(body), state_(free_state(model, 0.0)), at_m_(at_m) {}

  /// One tick at a depth [m]. @return the normal force [N].
  double press(double depth_m, double dt_s) {
    const Eigen::Vector3d x(at_m_.x(), at_m_.y(), -depth_m);
    if (ticks_++ % 20 == 0) {
      send(*state_, body_, x);
    }
    relax_ahead(*state_, dt_s);
    command_ = account_.step(*state_, x, dt_s);
    return command_.force_n.z();
  }

  [[nodiscard]] const FastState& state() const { return *state_; }
  [[nodiscard]] FastState& state() { return *state_; }
  [[nodiscard]] const FastCommand& command() const { return command_; }
  [[nodiscard]] const Account& account() const { return account_; }

 private:
  const BenchBody& body_;
  std::unique_ptr<FastState> state_;
  Eigen::Vector2d at_m_;
  Account account_;
  FastCommand command_;
  int ticks_ = 0;
};

/// For PressedPlace: a node, an edge's middle, a centroid, and anywhere.
inline const std::array<Eigen::Vector2d, 4> kPressedPlaces{
    Eigen::Vector2d(0.03, 0.03), Eigen::Vector2d(0.0325, 0.03),
    Eigen::Vector2d(0.03 + 0.01 / 3.0, 0.03 + 0.005 / 3.0),
    Eigen::Vector2d(0.031, 0.0306)};

/// Difference of forces, over the reference's.
struct ForceError {
  double square = 0.0;
  double reference_square = 0.0;
  double worst_n = 0.0;
  double largest_n = 0.0;

  void add(double force_n, double wanted_n) {
    square += (force_n - wanted_n) * (force_n - wanted_n);
    reference_square += wanted_n * wanted_n;
    worst_n = std::max(worst_n, std::abs(force_n - wanted_n));
    largest_n = std::max(largest_n, wanted_n);
  }
  [[nodiscard]] double rms() const { return std::sqrt(square / reference_square); }
};

/// The seven programmes of depth in which rendered forces are compared with the
/// convolution; the first four long against pork's short time.
struct DepthProgramme {
  const char* name;
  DepthPath depth_m;
  double seconds;
};

inline std::vector<DepthProgramme> depth_programmes() {
  const DepthPath press = line_path({{0.0, -0.001},
                                     {0.12, 0.005},
                                     {1.5, 0.005},
                                     {1.6, 0.0},
                                     {1.8, 0.0},
                                     {1.9, 0.005},
                                     {3.0, 0.005},
                                     {3.1, -0.001},
                                     {5.0, -0.001},
                                     {5.1, 0.005},
                                     {6.0, 0.005}});
  const DepthPath shake = [](double t) {
    return t < 0.1 ? -0.0005 + 0.035 * t
                   : 0.004 - 0.001 * std::cos(50.26548245743669 * (t - 0.1));
  };
  return {{"sine 0.5 Hz, contact lost", sine_path(0.004, 0.002, 0.5), 6.0},
          {"sine 2 Hz, contact lost", sine_path(0.004, 0.002, 2.0), 3.0},
          {"sine 8 Hz in contact", shake, 2.0},
          {"press, hold, retract, press again", press, 6.0}};
}

}  // namespace palpate

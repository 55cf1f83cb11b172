#include "formats/response/press_inversion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "formats/base/reproducible.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// Steps between two samples, so that p is nearly linear in each.
constexpr int kInversionSteps = 16;

// Relaxed forces of a press, step by step.
class Press {
 public:
  Press(const Eigen::RowVectorXd& g, const std::vector<double>& tau_s)
      : g_(g), tau_s_(tau_s), relaxed_n_(tau_s.size(), 0.0) {}

  // The instantaneous force after a step in which the press's became force_n.
  void step(double force_n, double step_s) {
    double known = force_n;
    double own = 1.0;
    for (std::size_t k = 0; k < tau_s_.size(); ++k) {
      const Weights w = weights(step_s / tau_s_[k]);
      const double g = g_(static_cast<Eigen::Index>(k));
      known += g * (w.decay * relaxed_n_[k] + w.before * pressure_n_);
      own -= g * w.now;
    }
    const double pressure = known / own;
    for (std::size_t k = 0; k < tau_s_.size(); ++k) {
      const Weights w = weights(step_s / tau_s_[k]);
      relaxed_n_[k] =
          w.decay * relaxed_n_[k] + w.before * pressure_n_ + w.now * pressure;
    }
    pressure_n_ = pressure;
  }

  [[nodiscard]] double force_n() const { return pressure_n_; }

  // How fast what is carried grows with depth.
  [[nodiscard]] double carried_slope_n_per_m(double speed_m_per_s) const {
    double slope = 0.0;
    for (std::size_t k = 0; k < tau_s_.size(); ++k) {
      slope += g_(static_cast<Eigen::Index>(k)) * (pressure_n_ - relaxed_n_[k]) /
               (tau_s_[k] * speed_m_per_s);
    }
    return slope;
  }

 private:
  struct Weights {
    double decay;
    double before;
    double now;
  };
  static Weights weights(double x) {
    const double decay = reproducible::exp(-x);
    const double mean = -reproducible::expm1(-x) / x;
    return {decay, mean - decay, 1.0 - mean};
  }

  const Eigen::RowVectorXd& g_;
  const std::vector<double>& tau_s_;
  std::vector<double> relaxed_n_;
  double pressure_n_ = 0.0;
};

// Slopes within [0, 3 secant] of both sides (Fritsch & Carlson 1980); where the force
// falls, of the other sign likewise.
void limit_slopes(OwnedCurve& curve) {
  const std::size_t n = curve.depth_m.size();
  const auto secant = [&](std::size_t i) {
    return (curve.force_n[i + 1] - curve.force_n[i]) /
           (curve.depth_m[i + 1] - curve.depth_m[i]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double left = i > 0 ? secant(i - 1) : secant(0);
    const double right = i + 1 < n ? secant(i) : left;
    double& slope = curve.stiffness_n_per_m[i];
    if (!(left * right > 0.0)) {
      slope = 0.0;
    } else {
      const double most = 3.0 * std::min(std::abs(left), std::abs(right));
      slope =
          std::copysign(std::clamp(slope * (left > 0.0 ? 1.0 : -1.0), 0.0, most), left);
    }
  }
}

void integrate(OwnedCurve& curve) {
  curve.energy_j.assign(curve.depth_m.size(), 0.0);
  for (std::size_t i = 1; i < curve.depth_m.size(); ++i) {
    const double h = curve.depth_m[i] - curve.depth_m[i - 1];
    curve.energy_j[i] =
        curve.energy_j[i - 1] + 0.5 * h * (curve.force_n[i - 1] + curve.force_n[i]) +
        h * h / 12.0 * (curve.stiffness_n_per_m[i - 1] - curve.stiffness_n_per_m[i]);
  }
}

OwnedCurve copy_of(const CurveView& curve) {
  return {{curve.depth_m.begin(), curve.depth_m.end()},
          {curve.force_n.begin(), curve.force_n.end()},
          {curve.stiffness_n_per_m.begin(), curve.stiffness_n_per_m.end()},
          {curve.energy_j.begin(), curve.energy_j.end()}};
}

}  // namespace

OwnedCurve instantaneous_curve(const CurveView& press, const Eigen::RowVectorXd& g,
                               const std::vector<double>& tau_s, double speed_m_per_s) {
  OwnedCurve curve = copy_of(press);
  if (curve.depth_m.empty()) {
    return curve;
  }
  Press state(g, tau_s);
  curve.stiffness_n_per_m[0] = press.stiffness_n_per_m[0];
  for (std::size_t i = 1; i < curve.depth_m.size(); ++i) {
    const double from = press.depth_m[i - 1];
    const double h = (press.depth_m[i] - from) / kInversionSteps;
    for (int step = 1; step <= kInversionSteps; ++step) {
      state.step(press.inside(i - 1, from + step * h).force_n, h / speed_m_per_s);
    }
    curve.force_n[i] = std::max(0.0, state.force_n());
    curve.stiffness_n_per_m[i] =
        press.stiffness_n_per_m[i] + state.carried_slope_n_per_m(speed_m_per_s);
  }
  limit_slopes(curve);
  integrate(curve);
  return curve;
}

OwnedCurve instantaneous_curve(const CurveView& curve,
                               const Viscoelasticity& relaxation, std::int64_t node) {
  return relaxation.empty() || relaxation.instantaneous
             ? copy_of(curve)
             : instantaneous_curve(curve, relaxation.shares(node), relaxation.tau_s,
                                   relaxation.speed_m_per_s);
}

double stiffness_factor(const Viscoelasticity& relaxation) {
  if (relaxation.empty() || relaxation.instantaneous) {
    return 1.0;
  }
  const double most = relaxation.g.cast<double>().rowwise().sum().maxCoeff();
  return most < 1.0 ? 1.0 / (1.0 - most) : std::numeric_limits<double>::infinity();
}

void make_instantaneous(ResponseTable& table) {
  Viscoelasticity& relaxation = table.viscoelasticity;
  if (relaxation.empty() || relaxation.instantaneous) {
    return;
  }
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    const OwnedCurve curve = instantaneous_curve(table.curve(node), relaxation, node);
    const auto begin = table.sample_begin[static_cast<std::size_t>(node)];
    std::copy(curve.force_n.begin(), curve.force_n.end(),
              table.force_n.begin() + begin);
    std::copy(curve.stiffness_n_per_m.begin(), curve.stiffness_n_per_m.end(),
              table.stiffness_n_per_m.begin() + begin);
    std::copy(curve.energy_j.begin(), curve.energy_j.end(),
              table.energy_j.begin() + begin);
    table.stiffness_max_n_per_m[static_cast<std::size_t>(node)] =
        stiffness_max_n_per_m(curve.view());
  }
  relaxation.instantaneous = true;
}

}  // namespace palpate

// What is said of machine and specimens, against what went in: coverage of 95 %
// intervals, wrong alarms, and what is seen. Usage: machine_study [runs]
#include <cmath>
#include <cstdlib>
#include <random>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/frame_run.h"
#include "fitting/session/random_effects.h"
#include "fitting/session/rigid_registration.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

constexpr double kNormal95 = 1.959964;
using Generator = std::mt19937;
using Normal = std::normal_distribution<double>;

// Noise whose neighbours are alike by rho.
class Noise {
 public:
  Noise(double sd, double rho, unsigned seed)
      : generator_(seed), sd_(sd), rho_(rho), now_(normal_(generator_)) {}
  double operator()() {
    now_ = rho_ * now_ + std::sqrt(1.0 - rho_ * rho_) * normal_(generator_);
    return sd_ * now_;
  }

 private:
  Generator generator_;
  Normal normal_;
  double sd_, rho_, now_;
};

void report_means(int specimens, bool balanced, unsigned runs) {
  unsigned covered = 0;
  double between = 0.0, within = 0.0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    Generator generator(seed);
    Normal normal;
    std::vector<std::vector<std::vector<double>>> y;
    for (int i = 0; i < specimens; ++i) {
      const double specimen = 1.0 + 0.15 * normal(generator);
      auto& points = y.emplace_back();
      for (int j = 0; j < (balanced ? 2 : 1 + i % 4); ++j) {
        const double point = specimen + 0.1 * normal(generator);
        auto& values = points.emplace_back();
        for (int k = 0; k < (balanced ? 3 : 1 + (i + 2 * j) % 4); ++k) {
          values.push_back(point + 0.05 * normal(generator));
        }
      }
    }
    const RandomEffects e = random_effects(y);
    covered += e.lower <= 1.0 && 1.0 <= e.upper ? 1 : 0;
    between += e.specimen_sd * e.specimen_sd / runs;
    within += std::isnan(e.repeat_sd) ? 0.0 : e.repeat_sd * e.repeat_sd / runs;
  }
  fmt::print(
      "mean of {:>2} specimens, {:<10}  coverage {:.3f}, sd between {:.4f} (0.15), "
      "within {:.4f} (0.05)\n",
      specimens, balanced ? "balanced" : "unbalanced", 1.0 * covered / runs,
      std::sqrt(between), std::sqrt(within));
}

void report_frame(double noise_n, double rho, unsigned runs) {
  constexpr double kStiffness = 2e4;  // [N/m]
  unsigned covered = 0, straight = 0;
  double sum = 0.0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    Noise noise(noise_n, rho, seed);
    Measurement plate;
    for (int i = 0; i < 400; ++i) {
      plate.depth_m.push_back(2e-3 * i / 399.0);
      plate.force_n.push_back(kStiffness * std::max(0.0, plate.depth_m.back() - 1e-3) +
                              noise());
    }
    const FrameCompliance frame = frame_of_run(plate).frame;
    const double error = frame.stiffness_n_per_m - kStiffness;
    straight += frame.linear ? 1 : 0;
    covered += std::abs(error) <= kNormal95 * frame.stiffness_sd_n_per_m ? 1 : 0;
    sum += error / runs;
  }
  fmt::print(
      "frame, noise {:.3f} of the force, neighbours alike by {:.1f}: coverage "
      "{:.3f}, bias {:+.4f} %, straight {:.3f}\n",
      noise_n / 20.0, rho, 1.0 * covered / runs, 100.0 * sum / kStiffness,
      1.0 * straight / runs);
}

// A loop with time, without adhesion; 10 samples a second, 5 mm deep, 1 N.
Measurement loop(double drift_n_per_s, double rho, unsigned seed, double back) {
  const Measurement press = synthetic({.noise_n = 0.0}, 1);
  Noise noise(0.005, rho, seed);
  Measurement m;
  const std::size_t n = press.depth_m.size();
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const std::size_t at = i < n ? i : 2 * n - 1 - i;
    m.time_s.push_back(0.1 * static_cast<double>(i));
    m.depth_m.push_back(press.depth_m[at]);
    m.force_n.push_back((i < n ? 1.0 : back) * press.force_n[at] +
                        drift_n_per_s * m.time_s.back() + noise());
  }
  return m;
}

void report_drift(double rho, unsigned runs) {
  unsigned alarms = 0, stuck = 0, covered = 0, found = 0, told = 0;
  constexpr double kDrift = 1e-3;  // [N/s]: 0.07 N over the loop
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const CorrectedPress none = correct_press(loop(0.0, rho, seed, 0.8), nullptr);
    alarms += none.corrections.drift.significant ? 1 : 0;
    stuck += none.corrections.adhesion.seen() ? 1 : 0;
    const TimeDrift drift =
        correct_press(loop(kDrift, rho, seed, 0.8), nullptr).corrections.drift;
    told += drift.refused.empty() ? 1 : 0;
    found += drift.significant ? 1 : 0;
    covered += std::abs(drift.n_per_s - kDrift) <= kNormal95 * drift.sd_n_per_s ? 1 : 0;
  }
  fmt::print(
      "loop, neighbours alike by {:.1f}: drift of 0.07 N found {:.3f}, coverage "
      "{:.3f} of {} told; wrong alarms: drift {:.4f}, adhesion {:.4f}\n",
      rho, 1.0 * found / runs, 1.0 * covered / told, told, 1.0 * alarms / runs,
      1.0 * stuck / runs);
}

// A sphere of 5 mm pressed 1 mm into 10 kPa that sticks.
Measurement sticky(double work_j_per_m2, double noise_n, unsigned seed) {
  constexpr double kRadius = 5e-3, kModulus = 1e4;
  Noise noise(noise_n, 0.0, seed);
  Measurement m;
  const double least_a =
      std::cbrt(M_PI * work_j_per_m2 * kRadius * kRadius / (8.0 * kModulus));
  const double least_m = least_a * least_a / kRadius -
                         std::sqrt(2.0 * M_PI * work_j_per_m2 * least_a / kModulus);
  for (int i = 0; i <= 1000; ++i) {
    const double x = 2.5e-3 * (i <= 500 ? i : 1000 - i) / 500.0, d = x - 1.5e-3;
    const bool touches = d >= (i <= 500 ? 0.0 : least_m);
    m.depth_m.push_back(x);
    m.force_n.push_back(
        (touches ? jkr_force_n(d, kRadius, kModulus, work_j_per_m2) : 0.0) + noise());
  }
  return m;
}

void report_adhesion(double work_j_per_m2, unsigned runs) {
  unsigned seen = 0, told = 0, point = 0, modulus = 0, work = 0;
  double hertz_m = 0.0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const CorrectedPress press =
        correct_press(sticky(work_j_per_m2, 2e-4, seed), nullptr);
    seen += press.corrections.adhesion.seen() ? 1 : 0;
    hertz_m += (press.contact.contact_point_m - 1.5e-3) / runs;
    const JkrFit fit = fit_jkr(press.approach, press.corrections.adhesion, 5e-3);
    if (!fit.refused.empty()) {
      continue;
    }
    ++told;
    const auto holds = [](double error, double sd) {
      return std::abs(error) <= kNormal95 * sd ? 1U : 0U;
    };
    point += holds(fit.contact_point_m - 1.5e-3, fit.contact_point_sd_m);
    modulus += holds(fit.reduced_modulus_pa - 1e4, fit.reduced_modulus_sd_pa);
    work += holds(fit.work_j_per_m2 - work_j_per_m2, fit.work_sd_j_per_m2);
  }
  const double n = told;
  fmt::print(
      "adhesion {:.2f} J/m^2: seen {:.3f}, JKR told {:.3f}, coverage of contact "
      "point {:.3f}, modulus {:.3f}, work {:.3f}; pushing law's contact point "
      "{:+.3f} mm off\n",
      work_j_per_m2, 1.0 * seen / runs, n / runs, point / n, modulus / n, work / n,
      1e3 * hertz_m);
}

void report_registration(int pairs, unsigned runs) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Generator places(7);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  std::vector<RegistrationPair> truth;
  for (int i = 0; i < pairs; ++i) {
    const Eigen::Vector3d x(place(places), place(places), place(places));
    truth.push_back({"", x, R * x});
  }
  const Eigen::Vector3d target(0.05, -0.03, 0.04);
  double real = 0.0, expected = 0.0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    Generator generator(seed);
    Normal normal(0.0, 5e-4);
    auto given = truth;
    for (RegistrationPair& pair : given) {
      pair.mesh_m +=
          Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    }
    const Registration r = register_rigidly(given);
    real += (r.to_mesh_m(target) - R * target).squaredNorm() / runs;
    expected += std::pow(registration_error_m(r, R * target), 2) / runs;
  }
  fmt::print(
      "registration by {} pairs: rms error of a probe {:.3f} mm, told {:.3f} mm\n",
      pairs, 1e3 * std::sqrt(real), 1e3 * std::sqrt(expected));
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const auto runs = static_cast<unsigned>(argc > 1 ? std::atoi(argv[1]) : 400);
  for (const int specimens : {3, 5, 10}) {
    palpate::report_means(specimens, true, 20 * runs);
    palpate::report_means(specimens, false, 20 * runs);
  }
  palpate::report_frame(0.1, 0.0, runs);
  palpate::report_frame(1.0, 0.0, runs);
  palpate::report_frame(0.1, 0.8, runs);
  for (const double rho : {0.0, 0.5, 0.8}) {
    palpate::report_drift(rho, runs);
  }
  for (const double work : {0.02, 0.05, 0.1, 0.3}) {
    palpate::report_adhesion(work, runs);
  }
  for (const int pairs : {3, 4, 8}) {
    palpate::report_registration(pairs, 20 * runs);
  }
  return 0;
}

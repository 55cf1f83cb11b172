// Presses and holds that a laboratory measured, fitted together and then rendered by
// the fast step along the measured way: how far the held force is from the fit's and
// from the measured one.
//
// rendered_holds_study FILE...     columns displacement [mm], force [N], time [s]
#include <algorithm>
#include <cmath>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fitting/curve/time_effects.h"
#include "formats/base/quantile.h"
#include "formats/measurement/measurement_file.h"
#include "formats/response/response_curve.h"
#include "runtime/slow/thinned_curve.h"
#include "tests/support/relaxing_body.h"

namespace palpate {
namespace {

constexpr double kTickS = 0.0005;

// A flat body with the instantaneous curve and the terms of a fit.
BenchBody body_of(const JointRelaxation& joint) {
  std::vector<double> depth_m;
  std::vector<double> force_n;
  for (std::size_t i = 0; i < joint.displacement_m.size(); ++i) {
    const double d = joint.displacement_m[i] - joint.displacement_m.front();
    if (depth_m.empty() || d > depth_m.back()) {
      depth_m.push_back(d);
      force_n.push_back(std::max(0.0, joint.force_n[i]));
    }
  }
  force_n.front() = 0.0;
  const ResponseCurve curve(depth_m, force_n);
  BenchBodyOptions options;
  for (const RelaxationTerm& term : joint.terms) {
    options.relaxing.push_back(term.g);
    options.relaxation_s.push_back(term.tau_s);
  }
  BenchBody body = make_bench_body(options);
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      set_curve(node, curve.view());
    }
  }
  return body;
}

// The fit's force at the measured samples.
Eigen::VectorXd fitted_n(const JointRelaxation& joint,
                         const std::vector<double>& time_s,
                         const std::vector<double>& displacement_m) {
  const auto n = std::ssize(time_s);
  const Eigen::Map<const Eigen::VectorXd> time(time_s.data(), n);
  Eigen::VectorXd elastic(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = displacement_m[static_cast<std::size_t>(i)];
    const auto above = std::clamp<std::ptrdiff_t>(
        std::upper_bound(joint.displacement_m.begin(), joint.displacement_m.end(), x) -
            joint.displacement_m.begin(),
        1, std::ssize(joint.displacement_m) - 1);
    const auto k = static_cast<std::size_t>(above);
    const double share = (x - joint.displacement_m[k - 1]) /
                         (joint.displacement_m[k] - joint.displacement_m[k - 1]);
    elastic[i] = std::max(
        0.0, joint.force_n[k - 1] + share * (joint.force_n[k] - joint.force_n[k - 1]));
  }
  Eigen::VectorXd force = elastic;
  for (const RelaxationTerm& term : joint.terms) {
    force -= term.g * relaxed_force(time, elastic, term.tau_s);
  }
  return force;
}

struct Held {
  double from_fit = 0.0;  // [-] largest difference while held, over the largest force
  double from_measured = 0.0;  // likewise
};

Held render(const Measurement& m, const JointRelaxation& joint) {
  const BenchBody body = body_of(joint);
  const Eigen::VectorXd fit = fitted_n(joint, m.time_s, m.depth_m);
  const double largest_n = fit.maxCoeff();
  const double deepest = *std::max_element(m.depth_m.begin(), m.depth_m.end());
  PressedPlace place(body, LocalModel::kPotential, {0.031, 0.029});
  (void)place.press(-1e-6, kTickS);
  Held held;
  for (std::size_t i = 1; i < m.time_s.size(); ++i) {
    const double step_s = m.time_s[i] - m.time_s[i - 1];
    const int ticks = std::max(1, static_cast<int>(std::ceil(step_s / kTickS)));
    double force_n = 0.0;
    for (int k = 1; k <= ticks; ++k) {
      const double x = m.depth_m[i - 1] + static_cast<double>(k) / ticks *
                                              (m.depth_m[i] - m.depth_m[i - 1]);
      force_n = place.press(x - joint.displacement_m.front(), step_s / ticks);
    }
    if (m.depth_m[i] >= 0.999 * deepest) {
      const double off_n = force_n - fit[static_cast<Eigen::Index>(i)];
      const double missed_n = force_n + joint.baseline_n - m.force_n[i];
      held.from_fit = std::max(held.from_fit, std::abs(off_n) / largest_n);
      held.from_measured = std::max(held.from_measured, std::abs(missed_n) / largest_n);
    }
  }
  return held;
}

void run(const std::vector<std::string>& files) {
  std::vector<double> from_fit;
  std::vector<double> from_measured;
  fmt::print("{:<16}{:>6}{:>14}{:>14}{:>16}\n", "file", "terms", "fit's rms", "to fit",
             "to measured");
  for (const std::string& file : files) {
    const MeasurementFile read = read_measurement(
        file, {{"displacement", "mm"}, {"force", "N"}, MeasurementColumn{"time", "s"}});
    const JointRelaxation joint = find_relaxation(read.samples).joint;
    const std::string name = file.substr(file.find_last_of('/') + 1);
    if (!joint.refused.empty()) {
      fmt::print("{:<16}{}\n", name, joint.refused);
      continue;
    }
    const Held held = render(read.samples, joint);
    from_fit.push_back(held.from_fit);
    from_measured.push_back(held.from_measured);
    fmt::print("{:<16}{:>6}{:>12.2f} %{:>12.3f} %{:>14.2f} %\n", name,
               joint.terms.size(), 100.0 * joint.rms_relative, 100.0 * held.from_fit,
               100.0 * held.from_measured);
  }
  std::sort(from_fit.begin(), from_fit.end());
  std::sort(from_measured.begin(), from_measured.end());
  fmt::print(
      "{} holds: from the fit {:.3f} % in the median, {:.3f} % at most; from what was "
      "measured {:.2f} %, {:.2f} %\n",
      from_fit.size(), 100.0 * quantile(from_fit, 0.5), 100.0 * quantile(from_fit, 1.0),
      100.0 * quantile(from_measured, 0.5), 100.0 * quantile(from_measured, 1.0));
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}

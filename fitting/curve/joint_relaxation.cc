#include "fitting/curve/joint_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "fitting/curve/press_model.h"
#include "fitting/curve/press_rows.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::size_t kPressSamplesMin = 8;
constexpr int kTermsMax = 3;
constexpr int kNodesMin = 4, kNodesMax = 17;  // of the spline
constexpr Eigen::Index kPressRowsPerNode = 5;
constexpr int kCurvePoints = 48;
constexpr double kReleaseWorse = 1.25;  // [-] of the residuals' rms
constexpr double kRise = 0.03;          // [-] of the force: surely in contact
constexpr double kContactRise = 0.25;   // [-] of the force: surely after contact
constexpr double kLengthsOfHold = 10.0;
constexpr double kTauIntervals = 0.3;

struct Candidate {
  PressModel::Shape shape;
  std::optional<PressModel> model;
  LeastSquaresReport report;
  double independent = 0.0;  // samples
  std::size_t rows = 0;
};

// Depth at which the force has first risen by a share of its largest.
double depth_at_rise(const PressRows& rows, double share) {
  const Eigen::Index few = std::min<Eigen::Index>(3, rows.press);
  const double before = rows.all.force.head(few).mean();
  for (Eigen::Index i = 0; i < rows.press; ++i) {
    if (rows.all.force[i] > before + share * (1.0 - before)) {
      return std::clamp(rows.all.depth[i], 0.02, 0.9);
    }
  }
  return 0.9;
}

// Shares of the hold.
std::vector<Eigen::VectorXd> times_to_start_from(int terms) {
  switch (terms) {
    case 1:
      return {Eigen::VectorXd::Constant(1, 0.15)};
    case 2:
      return {Eigen::Vector2d(0.03, 0.4), Eigen::Vector2d(0.005, 0.1),
              Eigen::Vector2d(0.15, 1.5)};
    default:
      return {Eigen::Vector3d(0.01, 0.08, 0.5), Eigen::Vector3d(0.03, 0.2, 1.5)};
  }
}

// @param near if given, of as many terms, whose times are tried as well.
Candidate fitted(const PressRows& rows, int nodes, int terms,
                 const Candidate* near = nullptr) {
  Candidate c;
  c.shape = {.nodes = nodes,
             .terms = terms,
             .contact_max = depth_at_rise(rows, kContactRise),
             .tau_min_s = kTauIntervals * rows.sample_s,
             .tau_max_s = kLengthsOfHold * rows.hold_s};
  c.model.emplace(first_rows(rows.all, rows.hold), c.shape);
  c.rows = static_cast<std::size_t>(rows.hold);
  // Starts: a contact point well before the force has surely risen, and exponent 1.5.
  // Terms share 0.6 of the force that stays; their times are shares of the hold.
  const double contact =
      std::min(0.7 * depth_at_rise(rows, kRise), 0.99 * c.shape.contact_max);
  std::vector<Eigen::VectorXd> starts;
  std::vector<Eigen::VectorXd> shares = times_to_start_from(terms);
  if (near != nullptr) {
    const Eigen::VectorXd tau = near->report.q.tail(terms).array().exp();
    shares = {shares.front(), tau / rows.hold_s};
  }
  const Eigen::VectorXd ratio = Eigen::VectorXd::Constant(terms, 0.6 / terms);
  for (const Eigen::VectorXd& share : shares) {
    const Eigen::VectorXd tau = (rows.hold_s * share)
                                    .cwiseMax(1.01 * c.shape.tau_min_s)
                                    .cwiseMin(0.99 * c.shape.tau_max_s);
    starts.push_back(c.model->start(contact, 1.5, ratio, tau));
  }
  LeastSquaresOptions options;
  options.tolerance = 1e-8;
  options.iterations_max = 300;
  const LeastSquaresProblem problem = c.model->problem();
  c.report = solve_from_starts(problem, starts, options);
  Eigen::VectorXd r(problem.residuals);
  problem.evaluate(c.report.q, r, nullptr);
  c.independent = effective_samples({r.data(), static_cast<std::size_t>(r.size())});
  return c;
}

// The better of some by squares and parameters.
Candidate chosen(std::vector<Candidate>& candidates) {
  double independent = 0.0;
  for (const Candidate& c : candidates) {
    independent = std::max(independent, c.independent);
  }
  // n ln(mean square) + p ln n, n the independent samples, p the parameters.
  const auto cost = [&](const Candidate& c) {
    const double mean = 2.0 * c.report.cost / static_cast<double>(c.rows);
    return independent * std::log(std::max(mean, 1e-16)) +
           static_cast<double>(c.model->parameters()) * std::log(independent);
  };
  Candidate* best = nullptr;
  for (Candidate& c : candidates) {
    if (c.report.converged && (best == nullptr || cost(c) < cost(*best))) {
      best = &c;
    }
  }
  return best != nullptr ? std::move(*best) : std::move(candidates.front());
}

Candidate chosen_model(const PressRows& rows) {
  std::vector<Candidate> curves;
  curves.push_back(fitted(rows, 0, 2));
  // A supple one, since what it cannot follow would be taken for relaxation.
  const int nodes = std::clamp(static_cast<int>(rows.moving / kPressRowsPerNode),
                               kNodesMin, kNodesMax);
  const Candidate* law = &curves.front();
  curves.push_back(fitted(rows, nodes, 2, law->report.converged ? law : nullptr));
  std::vector<Candidate> by_terms;
  by_terms.push_back(chosen(curves));
  const int taken = by_terms.front().shape.nodes;
  for (const int terms : {1, kTermsMax}) {
    by_terms.push_back(fitted(rows, taken, terms));
  }
  return chosen(by_terms);
}

double rms_relative(const Candidate& c) {
  return std::sqrt(2.0 * c.report.cost / static_cast<double>(c.rows));
}

// The same model over the release too; that of press and hold where it does not follow.
void add_release(const PressRows& rows, Candidate& c, JointRelaxation& result) {
  const Eigen::Index n = rows.all.force.size();
  if (n < rows.hold + static_cast<Eigen::Index>(kPressSamplesMin)) {
    return;
  }
  Candidate all;
  all.shape = c.shape;
  all.model.emplace(rows.all, c.shape);
  all.rows = static_cast<std::size_t>(n);
  const LeastSquaresProblem problem = all.model->problem();
  Eigen::VectorXd r(n);
  problem.evaluate(c.report.q, r, nullptr);
  const Eigen::VectorXd after = r.tail(n - rows.hold);
  all.report = solve_least_squares(problem, c.report.q);
  if (all.report.converged && rms_relative(all) <= kReleaseWorse * rms_relative(c)) {
    c = std::move(all);
    result.release = true;
  } else {
    result.release_rms_relative =
        after.norm() / std::sqrt(static_cast<double>(after.size()));
  }
}

std::string why_not_claimed(double tau_s, const PressRows& rows) {
  return tau_s > rows.hold_s     ? "longer than the hold"
         : tau_s < rows.sample_s ? "shorter than the samples' interval"
                                 : "";
}

// Of g and ln tau from that of the model's r and ln tau, side by side there:
// dg_k / dr_j = ([j = k] - g_k) / (1 + sum r).
Eigen::MatrixXd terms_covariance(const Candidate& c,
                                 const Eigen::MatrixXd& covariance) {
  const Eigen::Index K = c.shape.terms, at = c.model->ratio_at();
  const Eigen::VectorXd ratio = c.report.q.segment(at, K);
  const double all = 1.0 + ratio.sum();
  Eigen::MatrixXd slope = Eigen::MatrixXd::Identity(2 * K, 2 * K);
  slope.topLeftCorner(K, K).colwise() -= ratio / all;
  slope.topLeftCorner(K, K) /= all;
  return slope * covariance.block(at, at, 2 * K, 2 * K) * slope.transpose();
}

void take_terms(const PressRows& rows, const Candidate& c,
                const Eigen::MatrixXd& covariance, JointRelaxation& result) {
  const Eigen::Index K = c.shape.terms, at = c.model->ratio_at();
  const Eigen::VectorXd ratio = c.report.q.segment(at, K);
  const Eigen::VectorXd log_tau = c.report.q.segment(c.model->tau_at(), K);
  // The model's ratios r_k are over the part that stays:
  //   g_k = r_k / (1 + sum r),  g_inf = 1 / (1 + sum r)
  //   sd(g_inf) = sd(sum r) / (1 + sum r)^2
  const double all = 1.0 + ratio.sum();
  const Eigen::MatrixXd of_ratio = covariance.block(at, at, K, K);
  const Eigen::MatrixXd of_terms = terms_covariance(c, covariance);
  std::vector<Eigen::Index> rising(static_cast<std::size_t>(K));
  std::iota(rising.begin(), rising.end(), 0);
  std::sort(rising.begin(), rising.end(), [&](Eigen::Index a, Eigen::Index b) {
    return log_tau[a] < log_tau[b];
  });
  for (const Eigen::Index k : rising) {
    RelaxationTerm term;
    term.g = ratio[k] / all;
    term.g_sd = std::sqrt(of_terms(k, k));
    term.tau_s = std::exp(log_tau[k]);
    term.tau_sd_s = term.tau_s * std::sqrt(of_terms(K + k, K + k));
    term.not_claimed = why_not_claimed(term.tau_s, rows);
    result.terms.push_back(term);
  }
  std::vector<Eigen::Index> order = rising;
  for (const Eigen::Index k : rising) {
    order.push_back(K + k);
  }
  result.covariance = of_terms(order, order);
  result.g_inf = 1.0 / all;
  result.g_inf_sd = std::sqrt(of_ratio.sum()) / (all * all);
}

void take_curve(const PressRows& rows, const Candidate& c,
                const Eigen::MatrixXd& covariance, JointRelaxation& result) {
  const double contact = c.report.q[c.model->contact_at()];
  const Eigen::VectorXd depth =
      Eigen::VectorXd::LinSpaced(kCurvePoints + 1, contact, 1.0);
  Eigen::MatrixXd jacobian;
  const Eigen::VectorXd force = c.model->instantaneous(c.report.q, depth, &jacobian);
  for (Eigen::Index i = 0; i < depth.size(); ++i) {
    result.displacement_m.push_back(rows.origin_m + rows.travel_m * depth[i]);
    result.force_n.push_back(rows.force_n * force[i]);
    const double variance = jacobian.row(i) * covariance * jacobian.row(i).transpose();
    result.force_sd_n.push_back(rows.force_n * std::sqrt(variance));
  }
}

// The shortest time at which a term of g = 0.1 would stand out from the residuals of
// the hold by kSeen standard deviations: what is left of it at the end of the press,
// times the root of the samples over which it dies away.
double seen_from_s(const PressRows& rows, const JointRelaxation& result) {
  constexpr double kTermShare = 0.1, kSeen = 4.0;
  const double travel_m = result.displacement_m.back() - rows.origin_m;
  const double speed = travel_m / std::max(rows.moving_s, rows.sample_s);
  double tau_s = kTauIntervals * rows.sample_s;
  for (; tau_s < rows.hold_s; tau_s *= 1.1) {
    const RelaxationTerm term{kTermShare, 0.0, tau_s, 0.0, {}};
    const double end_n = result.force_n.back();
    const auto shown =
        shown_by_press({&term, 1}, result.displacement_m, result.force_n, speed);
    // g (e - q), from g' = g (e - q) / (e - g q).
    const double left = shown[0].g * (1.0 - kTermShare) / (1.0 - shown[0].g) * end_n;
    const double samples = 0.5 * tau_s / rows.interval_s;
    if (left * std::sqrt(samples) > kSeen * result.rms_relative * rows.force_n) {
      break;
    }
  }
  return tau_s;
}

std::string why_refused(const PressAndHold& m) {
  if (m.hold_begin < kPressSamplesMin || m.hold_end < m.hold_begin + kHoldSamplesMin) {
    return fmt::format(
        "{} samples in the press and {} in the hold, at least {} and {} are needed",
        m.hold_begin, m.hold_end - m.hold_begin, kPressSamplesMin, kHoldSamplesMin);
  }
  for (std::size_t i = 1; i < m.time_s.size(); ++i) {
    if (m.time_s[i] < m.time_s[i - 1]) {
      return "the time goes back";
    }
  }
  const double first = m.displacement_m.front();
  return m.displacement_m[m.hold_begin] > first && m.force_n[m.hold_begin] > 0.0 &&
                 m.time_s[m.hold_end - 1] > m.time_s[m.hold_begin]
             ? ""
             : "the press does not rise";
}

}  // namespace

JointRelaxation fit_press_and_hold(const PressAndHold& measured) {
  JointRelaxation result;
  result.refused = why_refused(measured);
  if (!result.refused.empty()) {
    return result;
  }
  // 1. Rows of means, then the curve and the number of terms, of press and hold.
  const PressRows rows = rows_of(measured);
  Candidate best = chosen_model(rows);
  result.converged = best.report.converged;
  if (!result.converged) {
    result.refused = "the fit did not converge";
    return result;
  }
  // 2. The release joins if the same model follows the release.
  add_release(rows, best, result);
  // 3. Results with their errors.
  const Eigen::MatrixXd covariance =
      least_squares_covariance(best.model->problem(), best.report.q);
  take_terms(rows, best, covariance, result);
  take_curve(rows, best, covariance, result);
  result.curve = best.shape.nodes == 0 ? "power-law" : "monotone-spline";
  result.baseline_n = rows.force_n * best.report.q[0];
  result.rms_relative = rms_relative(best);
  result.samples = best.rows;
  result.seen_from_s = seen_from_s(rows, result);
  result.holds = rows.holds.size();
  for (const PressRows::Hold& hold : rows.holds) {
    result.holds_used += hold.row < static_cast<Eigen::Index>(best.rows) &&
                                 hold.depth > best.report.q[best.model->contact_at()]
                             ? 1
                             : 0;
  }
  return result;
}

double held_share(const JointRelaxation& joint, double speed_m_per_s, double time_s) {
  double share = 1.0;
  for (const RelaxationTerm& term : shown_by_press(joint.terms, joint.displacement_m,
                                                   joint.force_n, speed_m_per_s)) {
    share += term.g * std::expm1(-time_s / term.tau_s);
  }
  return share;
}

RelaxedShare relaxed_within(const JointRelaxation& joint, double time_s) {
  const auto K = std::ssize(joint.terms);
  RelaxedShare share;
  Eigen::VectorXd slope(2 * K);
  for (Eigen::Index k = 0; k < K; ++k) {
    const RelaxationTerm& term = joint.terms[static_cast<std::size_t>(k)];
    const double x = time_s / term.tau_s;
    slope[k] = -std::expm1(-x);
    slope[K + k] = -term.g * x * std::exp(-x);  // d / d ln tau
    share.value += term.g * slope[k];
  }
  share.sd = joint.covariance.rows() == 2 * K
                 ? std::sqrt(slope.dot(joint.covariance * slope))
                 : std::numeric_limits<double>::quiet_NaN();
  return share;
}

std::string describe(const JointRelaxation& joint) {
  if (!joint.refused.empty()) {
    return "Press and hold together: not fitted, " + joint.refused;
  }
  const std::string used =
      joint.holds_used < joint.holds ? fmt::format("{} of ", joint.holds_used) : "";
  std::string text = fmt::format(
      "{} together: {:.3g} +- {:.2g} of the instantaneous force stays",
      joint.holds > 1 ? fmt::format("Press and {}{} holds", used, joint.holds)
                      : "Press and hold",
      joint.g_inf, joint.g_inf_sd);
  for (const RelaxationTerm& term : joint.terms) {
    text += fmt::format("; {:.3g} +- {:.2g} in {:.3g} +- {:.2g} s{}", term.g, term.g_sd,
                        term.tau_s, term.tau_sd_s,
                        term.not_claimed.empty()
                            ? ""
                            : fmt::format(" (not claimed: {})", term.not_claimed));
  }
  return text + fmt::format(
                    "; what relaxes in less than {:.2g} s is not seen; rms "
                    "{:.2g} % of the largest force{}",
                    joint.seen_from_s, 100.0 * joint.rms_relative,
                    joint.release ? ", the release too" : "");
}

}  // namespace palpate

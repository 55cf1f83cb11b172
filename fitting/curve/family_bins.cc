#include "fitting/curve/family_bins.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fitting/numerics/bounded_linear.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr int kBins = 16, kHalvings = 8;
constexpr std::size_t kSamplesPerBin = 1;
constexpr double kBaselineSamples = 3.0;
constexpr double kOffMax = 8.0;  // times the median: 1 of 250 for chi squared of two

// Samples in contact in the order of their depth, cut into bins.
struct Bins {
  std::vector<Eigen::Index> order;   // of the samples
  std::vector<std::size_t> begin;    // of each bin in it, and the end
  std::vector<double> depth, force;  // means, [-]

  [[nodiscard]] std::size_t count() const { return depth.size(); }
  [[nodiscard]] double samples(std::size_t bin) const {
    return static_cast<double>(begin[bin + 1] - begin[bin]);
  }
};

// Cuts at these places, less those that leave a bin empty or no deeper than the last.
void cut(const FamilyData& data, double contact, const std::vector<std::size_t>& cuts,
         Bins& bins) {
  bins.begin = {0};
  bins.depth.clear();
  bins.force.clear();
  for (const std::size_t end : cuts) {
    double depth = 0.0, force = 0.0;
    for (std::size_t i = bins.begin.back(); i < end; ++i) {
      const Eigen::Index k = bins.order[i];
      depth += data.x[k] - contact;
      force += data.f[k] - data.baseline_force -
               (data.flat ? 0.0 : data.baseline_slope) * data.x[k];
    }
    const auto samples = static_cast<double>(end - bins.begin.back());
    if (samples > 0.0 &&
        depth / samples > (bins.depth.empty() ? 0.0 : bins.depth.back())) {
      bins.depth.push_back(depth / samples);
      bins.force.push_back(force / samples);
      bins.begin.push_back(end);
    }
  }
}

Bins even_bins(const FamilyData& data, double contact) {
  Bins bins;
  for (Eigen::Index i = 0; i < data.x.size(); ++i) {
    if (data.x[i] > contact) {
      bins.order.push_back(i);
    }
  }
  std::stable_sort(bins.order.begin(), bins.order.end(), [&](auto a, auto b) {
    return data.x[a] < data.x[b];
  });
  const double deepest = data.x.maxCoeff() - contact;
  std::vector<std::size_t> cuts;
  for (int bin = 1; bin <= kBins; ++bin) {
    const double end = contact + deepest * bin / kBins;
    const auto beyond =
        bin == kBins ? bins.order.end()
                     : std::find_if(bins.order.begin(), bins.order.end(), [&](auto i) {
                         return data.x[i] >= end;
                       });
    cuts.push_back(static_cast<std::size_t>(beyond - bins.order.begin()));
  }
  cut(data, contact, cuts, bins);
  return bins;
}

// A cubic through the bins, and its residuals.
struct BinFit {
  Bins bins;
  std::shared_ptr<const CurveFamily> family;
  Eigen::VectorXd q, residual;
};

BinFit fit_bins(const FamilyData& data, std::string_view name, double contact,
                Bins bins) {
  BinFit fit;
  std::vector<double> force = bins.force;
  if (name == "monotone-cubic") {
    std::vector<double> samples;
    for (std::size_t bin = 0; bin < bins.count(); ++bin) {
      samples.push_back(bins.samples(bin));
    }
    force = isotonic(force, samples);
  }
  // The cubic passes through (mean depth, mean force) of each bin; no force is
  // negative.
  const auto p = std::ssize(force);
  fit.family = cubic_family(name, bins.depth);
  fit.q = Eigen::VectorXd::Zero(kFamilyShared + p);
  fit.q[kFamilyForce] = data.baseline_force;
  fit.q[kFamilySlope] = data.flat ? 0.0 : data.baseline_slope;
  fit.q[kFamilyContact] = contact;
  for (Eigen::Index j = 0; j < p; ++j) {
    fit.q[kFamilyShared + j] = std::max(0.0, force[static_cast<std::size_t>(j)]);
  }
  fit.residual.resize(data.x.size());
  for (Eigen::Index i = 0; i < fit.residual.size(); ++i) {
    fit.residual[i] =
        data.weight[i] * (scaled_force(*fit.family, fit.q, data.x[i]) - data.f[i]);
  }
  fit.bins = std::move(bins);
  return fit;
}

// What the means of a bin's two halves say against the curve: for noise that is white
// over a bin, chi squared of two degrees of freedom times its long-run variance.
double off_in_halves(const BinFit& fit, std::size_t bin) {
  const std::size_t begin = fit.bins.begin[bin], end = fit.bins.begin[bin + 1];
  const std::size_t half = begin + (end - begin) / 2;
  double left = 0.0, right = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    (i < half ? left : right) += fit.residual[fit.bins.order[i]];
  }
  const auto of = [](double sum, std::size_t samples) {
    return samples > 0 ? sum * sum / static_cast<double>(samples) : 0.0;
  };
  return of(left, half - begin) + of(right, end - half);
}

// Halves bins until the curve is nowhere off by more than most bins are.
BinFit adapted_bins(const FamilyData& data, std::string_view name, double contact) {
  BinFit fit = fit_bins(data, name, contact, even_bins(data, contact));
  std::vector<double> first;
  for (std::size_t bin = 0; bin < fit.bins.count(); ++bin) {
    first.push_back(off_in_halves(fit, bin));
  }
  const double limit = kOffMax * median(first);
  for (int pass = 0; pass < kHalvings; ++pass) {
    std::vector<std::size_t> cuts;
    for (std::size_t bin = 0; bin < fit.bins.count(); ++bin) {
      const std::size_t begin = fit.bins.begin[bin], end = fit.bins.begin[bin + 1];
      if (end - begin >= 2 * kSamplesPerBin && off_in_halves(fit, bin) > limit) {
        cuts.push_back(begin + (end - begin) / 2);
      }
      cuts.push_back(end);
    }
    if (cuts.size() == fit.bins.count()) {
      break;
    }
    cut(data, contact, cuts, fit.bins);
    fit = fit_bins(data, name, contact, fit.bins);
  }
  return fit;
}

// The force before contact, a drift taken off, and of how many samples it is the mean:
// of the free ones, else of the first few.
std::pair<double, double> baseline_of(const FamilyData& data, double contact) {
  const double slope = data.flat ? 0.0 : data.baseline_slope;
  double sum = 0.0, count = 0.0;
  for (Eigen::Index i = 0; i < data.x.size(); ++i) {
    if (data.x[i] <= contact) {
      sum += data.f[i] - slope * data.x[i];
      count += 1.0;
    }
  }
  if (count >= kBaselineSamples) {
    return {sum / count, count};
  }
  const auto few = static_cast<Eigen::Index>(kBaselineSamples);
  return {median({data.f.data(), data.f.data() + few}) - slope * data.x[0],
          kBaselineSamples};
}

}  // namespace

FamilySolution solve_bins(const FamilyData& given, std::string_view name,
                          double contact) {
  FamilySolution solution;
  FamilyData data = given;
  const auto [baseline, free_samples] = baseline_of(given, contact);
  data.baseline_force = baseline;
  const BinFit fit = adapted_bins(data, name, contact);
  const auto p = std::ssize(fit.bins.depth);
  solution.family = fit.family;
  solution.q = fit.q;
  const double variance = long_run_variance(
      noises_of(Eigen::MatrixXd(fit.residual.size(), 0), fit.residual));
  // A bin's force is its mean less the baseline, whose error they share.
  const double shared = variance / free_samples;
  solution.covariance =
      Eigen::MatrixXd::Constant(kFamilyShared + p, kFamilyShared + p, shared);
  solution.covariance.row(kFamilyForce) *= -1.0;
  solution.covariance.col(kFamilyForce) *= -1.0;
  for (const Eigen::Index held :
       {Eigen::Index{kFamilySlope}, Eigen::Index{kFamilyContact}}) {
    solution.covariance.row(held).setZero();
    solution.covariance.col(held).setZero();
  }
  for (Eigen::Index j = 0; j < p; ++j) {
    solution.covariance(kFamilyShared + j, kFamilyShared + j) +=
        variance / fit.bins.samples(static_cast<std::size_t>(j));
  }
  solution.held.assign(static_cast<std::size_t>(kFamilyShared + p), "");
  solution.held[kFamilySlope] = data.flat ? "assumed" : "power law";
  solution.held[kFamilyContact] = data.contact_held ? "assumed" : "power law";
  solution.free_parameters = static_cast<int>(p) + (data.flat ? 1 : 2);
  solution.converged = p > 0;
  solution.iterations = 1;
  return solution;
}

}  // namespace palpate

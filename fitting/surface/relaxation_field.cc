#include "fitting/surface/relaxation_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/surface/attached_point.h"
#include "fitting/surface/field_patches.h"
#include "fitting/surface/held_shares.h"
#include "fitting/surface/probe_repeats.h"
#include "fitting/surface/probe_screen.h"

namespace palpate {
namespace {

struct Held {
  std::vector<std::vector<std::size_t>> place;  // probes, by index
  JoinedPresses joined;                         // a set a share, a datum a place
};

Held joined_holds(const SurfaceMesh& body,
                  const std::vector<const SurfaceProbe*>& probes,
                  const std::vector<double>& time_s) {
  std::vector<Eigen::Vector3d> position;
  for (const SurfaceProbe* probe : probes) {
    position.push_back(probe->position_m);
  }
  Held held;
  held.place = places_of(position, kSamePlace * bounding_box(body).diagonal().norm());
  held.joined = join_presses(held_shares(probes, time_s), held.place);
  return held;
}

double shortest_hold_s(const std::vector<const SurfaceProbe*>& probes) {
  double seconds = probes.front()->relaxation->seconds;
  for (const SurfaceProbe* probe : probes) {
    seconds = std::min(seconds, probe->relaxation->seconds);
  }
  return seconds;
}

// Places that say something of every share.
std::size_t places_with_all(const std::vector<FieldData>& data) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < data.front().used.size(); ++i) {
    count += std::all_of(data.begin(), data.end(), [&](const FieldData& set) {
      return set.used[i] != 0;
    });
  }
  return count;
}

// Of the set's values or errors.
std::vector<double> used_values(const FieldData& set, const Eigen::VectorXd& of) {
  std::vector<double> values;
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    if (set.used[i] != 0) {
      values.push_back(of[static_cast<Eigen::Index>(i)]);
    }
  }
  return values;
}

// One share's field: each has its own parameters.
struct ShareField {
  FieldParameters most_probable;
  std::vector<ProbableParameters> probable;
  FieldPosterior posterior;

  ShareField(const FieldModel& model, const FieldData& set,
             const FieldParameters& near) {
    const FieldParametersReport found = fit_field_parameters(model, {&set, 1}, &near);
    most_probable = found.parameters;
    probable = probable_parameters(model, {&set, 1}, found);
    posterior = mixed_posterior(model, probable, set);
  }

  [[nodiscard]] double mean_square_nugget() const {
    double sum = 0.0;
    for (const auto& [parameters, weight] : probable) {
      sum += weight * parameters.nugget_sd * parameters.nugget_sd;
    }
    return sum;
  }
};

// Sums over places left out of weighed squares: of what the field misses, and what one
// value for all misses: the median of all, or the mean of the others.
struct Misses {
  double weights = 0.0, field = 0.0, median = 0.0, mean = 0.0, count = 0.0,
         covered = 0.0;
};

// How far the shares are apart beyond their own errors.
double excess_spread(const FieldData& set) {
  const double spread = robust_standard_deviation(used_values(set, set.value));
  const double error = median(used_values(set, set.sd));
  return std::sqrt(std::max(0.0, spread * spread - error * error));
}

// The weights know nothing of any prediction.
Misses misses_of(const FieldData& set, const FieldPosterior& posterior,
                 const std::vector<std::size_t>& patch) {
  const double spread = excess_spread(set);
  double all = 0.0, sum = 0.0;
  const auto weight = [&](Eigen::Index i) {
    return 1.0 / (set.sd[i] * set.sd[i] + spread * spread);
  };
  for (Eigen::Index i = 0; i < set.value.size(); ++i) {
    if (set.used[static_cast<std::size_t>(i)] != 0) {
      all += weight(i);
      sum += weight(i) * set.value[i];
    }
  }
  const double middle = median(used_values(set, set.value));
  Misses misses;
  for (const std::size_t at : patch) {
    const auto i = static_cast<Eigen::Index>(at);
    if (set.used[at] == 0) {
      continue;
    }
    // Each place is left out: of the field, and of the mean (sum - w y) / (all - w).
    // The median keeps the place, which favours one value for all.
    const double w = weight(i), y = set.value[i];
    const double off = posterior.left_out_residual[i];
    misses.weights += w;
    misses.field += w * off * off;
    misses.median += w * std::pow(y - middle, 2);
    misses.mean += w * std::pow(y - (sum - w * y) / (all - w), 2);
    misses.count += 1.0;
    misses.covered += std::abs(off) <= kNormal95 * posterior.left_out_sd[i] ? 1.0 : 0.0;
  }
  return misses;
}

Misses operator+(const Misses& a, const Misses& b) {
  return {a.weights + b.weights, a.field + b.field, a.median + b.median,
          a.mean + b.mean,       a.count + b.count, a.covered + b.covered};
}

// Sum of some gains over its standard error, as their own scatter tells it.
double over_error(const std::vector<double>& gains) {
  const auto n = static_cast<double>(gains.size());
  const double sum = std::accumulate(gains.begin(), gains.end(), 0.0);
  double squares = 0.0;
  for (const double gain : gains) {
    squares += std::pow(gain - sum / n, 2);
  }
  return sum / std::sqrt(n / (n - 1.0) * squares);
}

// Neighbours err together: gains are summed over patches of them, and scatter so.
void compare(const FieldModel& model, const std::vector<FieldData>& data,
             const std::vector<ShareField>& fields, RelaxationFieldReport& report) {
  const auto patches =
      patches_of(model, std::min(kPatchesMax, model.point().size() / kPatchPoints));
  Misses all;
  std::vector<double> over_median, over_mean;
  for (const auto& patch : patches) {
    Misses here;
    for (std::size_t k = 0; k < data.size(); ++k) {
      here = here + misses_of(data[k], fields[k].posterior, patch);
    }
    // Gain of a patch: squares that one value for all misses, less those that the field
    // misses.
    over_median.push_back(here.median - here.field);
    over_mean.push_back(here.mean - here.field);
    all = all + here;
  }
  report.patches = patches.size();
  report.field_rms = std::sqrt(all.field / all.weights);
  report.common_rms = std::sqrt(std::min(all.median, all.mean) / all.weights);
  report.coverage = all.covered / all.count;
  report.gain_over_error = std::min(over_error(over_median), over_error(over_mean));
  report.taken = report.gain_over_error > kFieldGainMin;
  report.reason = fmt::format(
      "shares of the force that relax, each place left out in turn, are predicted to "
      "{:.3g} by the field, to {:.3g} by one value for all; better by {:.2g} standard "
      "errors (more than {})",
      report.field_rms, report.common_rms, report.gain_over_error, kFieldGainMin);
}

// Rows of g and their errors at every node.
void fill_rows(const std::vector<ShareField>& fields,
               const std::vector<double>& repeatability,
               const Eigen::MatrixXd& of_terms, RelaxationFieldReport& report,
               Viscoelasticity& relaxation) {
  const Eigen::Index n = fields.front().posterior.mean.size();
  Eigen::MatrixXd shares(n, std::ssize(fields));
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(n);
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const double own =
        std::isnan(repeatability[k]) ? 0.0 : fields[k].mean_square_nugget();
    shares.col(static_cast<Eigen::Index>(k)) = fields[k].posterior.at_nodes();
    variance = variance.max(fields[k].posterior.sd.array().square() + own);
  }
  const Eigen::ArrayXd error =
      (variance + report.common_times_error * report.common_times_error).sqrt();
  relaxation.g.resize(n, of_terms.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    relaxation.g.row(i) =
        nearest_terms(of_terms, shares.row(i).transpose()).cast<float>().transpose();
  }
  relaxation.error_relative.assign(error.begin(), error.end());
  report.error_median = median({error.begin(), error.end()});
}

}  // namespace

RelaxationField relaxation_field(const SurfaceMesh& body,
                                 const std::vector<const SurfaceProbe*>& probes,
                                 const Viscoelasticity& common) {
  RelaxationField result{common, {}};
  RelaxationFieldReport& report = result.report;
  if (common.empty() || probes.empty()) {
    return result;
  }
  // 1. Times that suit all probes, and the shares relaxed at a few of them at each
  //    place.
  const double seconds = shortest_hold_s(probes);
  const std::vector<double> tau_s =
      times_that_miss_least_s(probes, common.tau_s, seconds);
  report.time_s = share_times_s(tau_s, seconds);
  const Held held = joined_holds(body, probes, report.time_s);
  report.places = places_with_all(held.joined.data);
  if (report.places < kHeldPlacesMin) {
    report.reason = fmt::format("holds at {} places, a field needs {}", report.places,
                                kHeldPlacesMin);
    return result;
  }
  std::vector<AttachedPoint> point;
  for (const auto& place : held.place) {
    point.push_back(closest_surface_point(body, probes[place.front()]->position_m));
  }
  // 2. A field for each share, of probes that are not bad.
  const FieldModel model(body, std::move(point));
  const ScreenedField screened = screen_probes(model, held.joined.data);
  const FieldParameters& near = screened.parameters.parameters;
  report.left_out = screened.bad.size();
  report.common_times_error = common_times_error(probes, tau_s, seconds);
  std::vector<ShareField> fields;
  for (const FieldData& set : screened.data) {
    fields.emplace_back(model, set, near);
    report.parameters.push_back(fields.back().most_probable);
  }
  // 3. The fields are taken only if they predict left-out places surely better.
  compare(model, screened.data, fields, report);
  if (report.taken) {
    result.relaxation.tau_s = tau_s;
    fill_rows(fields, held.joined.repeatability, shares_of_terms(report.time_s, tau_s),
              report, result.relaxation);
    result.relaxation.rule = fmt::format(
        "times that suit all probes best; g a field over the surface through the "
        "shares that holds at {} places show relaxed after {:.3g} s, within its error; "
        "{}",
        report.places - report.left_out, fmt::join(report.time_s, " and "),
        report.reason);
  }
  return result;
}

std::string describe(const RelaxationFieldReport& report) {
  return report.reason.empty()
             ? ""
             : fmt::format("relaxation of the nodes: {}: {}\n",
                           report.taken ? "a field" : "the median for all",
                           report.reason);
}

}  // namespace palpate

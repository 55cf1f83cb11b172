#include "fitting/surface/relaxation_field.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/surface/attached_point.h"
#include "fitting/surface/field_patches.h"
#include "fitting/surface/held_shares.h"
#include "fitting/surface/probe_repeats.h"
#include "fitting/surface/probe_screen.h"

namespace palpate {
namespace {

constexpr double kSamePlace = 1e-6;  // of the body's diagonal
constexpr double kZ = 1.959964;      // 95 % of a normal distribution

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

std::vector<double> used_values(const FieldData& set) {
  std::vector<double> values;
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    if (set.used[i] != 0) {
      values.push_back(set.value[static_cast<Eigen::Index>(i)]);
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

// Sums over what is left out: weighed squares, and how many are within the intervals.
struct Scores {
  double weights = 0.0, field = 0.0, median = 0.0, count = 0.0, covered = 0.0;

  void add(double weight, double of_field, double of_median, bool within) {
    weights += weight;
    field += weight * of_field * of_field;
    median += weight * of_median * of_median;
    count += 1.0;
    covered += within ? 1.0 : 0.0;
  }
};

// The weights know nothing of either prediction: a share's own error, and how the
// shares spread about their median.
void score_patch(const FieldModel& model, const FieldData& all,
                 const std::vector<std::size_t>& patch, const FieldParameters& near,
                 Scores& scores) {
  FieldData others = all;
  for (const std::size_t i : patch) {
    others.used[i] = 0;
  }
  const FieldPosterior posterior = ShareField(model, others, near).posterior;
  const double middle = median(used_values(others));
  const double spread = robust_standard_deviation(used_values(all));
  for (const std::size_t i : patch) {
    const auto row = static_cast<Eigen::Index>(i);
    if (all.used[i] != 0) {
      const double off = posterior.left_out_residual[row];
      scores.add(1.0 / (all.sd[row] * all.sd[row] + spread * spread), off,
                 all.value[row] - middle, std::abs(off) <= kZ * posterior.left_out_sd[row]);
    }
  }
}

void compare(const FieldModel& model, const std::vector<FieldData>& data,
             const FieldParameters& near, RelaxationFieldReport& report) {
  const auto patches =
      patches_of(model, std::min(kPatchesMax, model.point().size() / kPatchPoints));
  Scores all;
  std::vector<double> gains;
  for (const auto& patch : patches) {
    const double before = all.median - all.field;
    for (const FieldData& set : data) {
      score_patch(model, set, patch, near, all);
    }
    gains.push_back(all.median - all.field - before);
  }
  const auto n = static_cast<double>(gains.size());
  const double gain = all.median - all.field;
  double squares = 0.0;
  for (const double one : gains) {
    squares += std::pow(one - gain / n, 2);
  }
  report.patches = gains.size();
  report.field_rms = std::sqrt(all.field / all.weights);
  report.median_rms = std::sqrt(all.median / all.weights);
  report.coverage = all.covered / all.count;
  report.gain_over_error = gain / std::sqrt(n / (n - 1.0) * squares);
  report.taken = report.gain_over_error > kFieldGainMin;
  report.reason = fmt::format(
      "{} patches left out: shares of the force that relax are predicted to {:.3g} by "
      "the field, to {:.3g} by the median; better by {:.2g} standard errors, {} are "
      "wanted",
      report.patches, report.field_rms, report.median_rms, report.gain_over_error,
      kFieldGainMin);
}

// Rows of g and their errors at every node.
void fill_rows(const std::vector<ShareField>& fields,
               const std::vector<double>& repeatability, const Eigen::MatrixXd& of_terms,
               RelaxationFieldReport& report, Viscoelasticity& relaxation) {
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
  double seconds = probes.front()->relaxation->seconds;
  for (const SurfaceProbe* probe : probes) {
    seconds = std::min(seconds, probe->relaxation->seconds);
  }
  report.time_s = share_times_s(common.tau_s, seconds);
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
  const FieldModel model(body, std::move(point));
  const ScreenedField screened = screen_probes(model, held.joined.data);
  const FieldParameters& near = screened.parameters.parameters;
  report.left_out = screened.bad.size();
  report.common_times_error = common_times_error(probes, common.tau_s, seconds);
  compare(model, screened.data, near, report);
  if (report.taken) {
    std::vector<ShareField> fields;
    for (const FieldData& set : screened.data) {
      fields.emplace_back(model, set, near);
      report.parameters.push_back(fields.back().most_probable);
    }
    fill_rows(fields, held.joined.repeatability,
              shares_of_terms(report.time_s, common.tau_s), report, result.relaxation);
    result.relaxation.rule = fmt::format(
        "times of the median over the probes; g a field over the surface through the "
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

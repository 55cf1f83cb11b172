#include "fitting/surface/field_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/surface/field_database.h"
#include "fitting/surface/geodesic_distance.h"
#include "fitting/surface/probe_relaxation.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kErrorMin = 1e-3;  // [-] of log force: no curve is known better
constexpr double kErrorMax = 1.0;   // a worse one says nothing
constexpr double kReach = 0.9;      // share of probes that reach the largest depth
constexpr double kAttachmentShareMax = 0.1;  // of the body's diagonal
constexpr double kScoreZ = 1.959964;         // 95 % of a normal distribution
constexpr int kFirstScored = 2;  // the shallowest depths are a thousandth of the force

std::vector<const SurfaceProbe*> usable(std::span<const SurfaceProbe> probes,
                                        std::vector<LeftOutProbe>& left_out) {
  std::vector<const SurfaceProbe*> kept;
  for (const SurfaceProbe& probe : probes) {
    const std::string reason = reason_unusable(probe);
    if (reason.empty()) {
      kept.push_back(&probe);
    } else {
      left_out.push_back({probe.name, reason});
    }
  }
  if (kept.size() < kProbesMin) {
    throw InputError(fmt::format(
        "{} of {} probes can be used, at least {} are needed{}", kept.size(),
        probes.size(), kProbesMin,
        left_out.empty() ? ""
                         : fmt::format("; the first without use, {}: {}",
                                       left_out[0].name, left_out[0].reason)));
  }
  return kept;
}

Eigen::VectorXd common_depths_m(const std::vector<const SurfaceProbe*>& probes) {
  std::vector<double> deepest;
  for (const SurfaceProbe* probe : probes) {
    deepest.push_back(depth_max_m(*probe));
  }
  std::sort(deepest.begin(), deepest.end());
  const auto rank = static_cast<std::size_t>((1.0 - kReach) *
                                             static_cast<double>(deepest.size() - 1));
  const Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(kCommonDepths, 1, kCommonDepths);
  return deepest[rank] * (k / kCommonDepths).square();
}

std::vector<AttachedPoint> attach(const SurfaceMesh& body,
                                  const std::vector<const SurfaceProbe*>& probes) {
  const double most_m = kAttachmentShareMax * bounding_box(body).diagonal().norm();
  std::vector<AttachedPoint> points;
  for (const SurfaceProbe* probe : probes) {
    points.push_back(closest_surface_point(body, probe->position_m));
    if (!(points.back().distance_m <= most_m)) {
      throw InputError(fmt::format(
          "{}: its position is {:.3g} m away from the body, at most {:.3g} m are "
          "allowed: are body and positions in one frame and unit?",
          probe->name, points.back().distance_m, most_m));
    }
  }
  return points;
}

// Log forces of all probes at each depth.
std::vector<FieldData> field_data(const std::vector<const SurfaceProbe*>& probes,
                                  const Eigen::VectorXd& depth_m) {
  const auto m = std::ssize(probes);
  std::vector<FieldData> data(
      static_cast<std::size_t>(depth_m.size()),
      {Eigen::VectorXd(m), Eigen::VectorXd(m), std::vector<char>(probes.size(), 1)});
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const SurfaceProbe& probe = *probes[i];
    const LogForces at = log_forces(probe, depth_m);
    const auto row = static_cast<Eigen::Index>(i);
    for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
      FieldData& set = data[static_cast<std::size_t>(k)];
      const bool there =
          depth_m[k] <= depth_max_m(probe) * (1.0 + 1e-9) && at.sd[k] < kErrorMax;
      set.value[row] = there ? at.value[k] : std::numeric_limits<double>::quiet_NaN();
      set.sd[row] = there ? std::max(at.sd[k], kErrorMin) : kErrorMax;
      set.used[i] = there ? 1 : 0;
    }
  }
  return data;
}

// Residual of the nearest other probe with a value.
double nearest_residual(const FieldModel& model, const FieldData& set, std::size_t i) {
  const Eigen::Vector3d p = position_m(model.mesh(), model.point()[i]);
  double closest = std::numeric_limits<double>::infinity();
  double residual = 0.0;
  for (std::size_t j = 0; j < set.used.size(); ++j) {
    const double d = (position_m(model.mesh(), model.point()[j]) - p).norm();
    if (j != i && set.used[j] != 0 && d < closest) {
      closest = d;
      residual = set.value[static_cast<Eigen::Index>(i)] -
                 set.value[static_cast<Eigen::Index>(j)];
    }
  }
  return residual;
}

DepthScore score_of(const FieldModel& model, const FieldData& set,
                    const FieldPosterior& posterior, double depth_m) {
  DepthScore score{.depth_m = depth_m};
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    if (set.used[i] == 0) {
      continue;
    }
    const double residual = posterior.left_out_residual[static_cast<Eigen::Index>(i)];
    const double sd = posterior.left_out_sd[static_cast<Eigen::Index>(i)];
    const double nearest = nearest_residual(model, set, i);
    ++score.probes;
    score.rms += residual * residual;
    score.nearest_rms += nearest * nearest;
    score.coverage += std::abs(residual) <= kScoreZ * sd ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(score.probes);
  score.rms = std::sqrt(score.rms / count);
  score.nearest_rms = std::sqrt(score.nearest_rms / count);
  score.coverage /= count;
  return score;
}

// Raw curves of all probes, those left out too.
Measurement raw_of(const SurfaceMesh& body, std::span<const SurfaceProbe> probes) {
  Measurement all;
  all.run_begin = {0};
  for (const SurfaceProbe& probe : probes) {
    const Measurement& m = probe.measurement;
    all.depth_m.insert(all.depth_m.end(), m.depth_m.begin(), m.depth_m.end());
    all.force_n.insert(all.force_n.end(), m.force_n.begin(), m.force_n.end());
    all.run_begin.push_back(std::ssize(all.depth_m));
    all.run_node.push_back(
        main_vertex(body, closest_surface_point(body, probe.position_m)));
    all.run_name.push_back(probe.name);
  }
  all.relaxation = run_relaxation(probes);
  return all;
}

void list_bad(const ScreenedField& screened, const Eigen::VectorXd& depth_m,
              std::span<const int> sets, const std::vector<const SurfaceProbe*>& probes,
              std::vector<LeftOutProbe>& left_out) {
  for (const BadProbe& bad : screened.bad) {
    left_out.push_back(
        {probes[bad.point]->name,
         fmt::format(
             "{:.3g} N at {:.3g} m where the others let expect {:.3g} N: {:.1f} "
             "standard deviations",
             std::exp(bad.value), depth_m[sets[bad.set]], std::exp(bad.expected),
             bad.score)});
  }
}

// Marks each node that has a probe behind the field.
std::vector<char> nodes_with_probe(const FieldModel& model, const FieldData& set) {
  std::vector<char> marks(static_cast<std::size_t>(model.mesh().position_m.rows()), 0);
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    if (set.used[i] != 0) {
      marks[static_cast<std::size_t>(main_vertex(model.mesh(), model.point()[i]))] = 1;
    }
  }
  return marks;
}

std::vector<AttachedPoint> used_points(const FieldModel& model, const FieldData& set) {
  std::vector<AttachedPoint> points;
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    if (set.used[i] != 0) {
      points.push_back(model.point()[i]);
    }
  }
  return points;
}

std::vector<ProbeDirection> turned(const FieldModel& model, const FieldData& set,
                                   const std::vector<const SurfaceProbe*>& probes) {
  std::vector<ProbeDirection> directions;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    if (set.used[i] != 0 && probes[i]->direction.norm() > 0.0) {
      directions.push_back({model.point()[i], probes[i]->direction.normalized()});
    }
  }
  return directions;
}

SurfaceFields fields_of(const FieldModel& model, const FieldParameters& parameters,
                        const std::vector<FieldData>& data,
                        const Eigen::VectorXd& depth_m, SurfaceFitReport& report) {
  SurfaceFields fields{depth_m, {}, {}, {}, {}};
  fields.log_force.resize(model.mesh().position_m.rows(), depth_m.size());
  fields.sd = fields.log_force;
  for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
    const FieldData& set = data[static_cast<std::size_t>(k)];
    const FieldPosterior posterior = model.posterior(parameters, set);
    fields.log_force.col(k) = posterior.at_nodes();
    fields.sd.col(k) = posterior.sd;
    if (k >= kFirstScored) {
      report.depth.push_back(score_of(model, set, posterior, depth_m[k]));
    }
  }
  return fields;
}

}  // namespace

SurfaceFit fit_surface(const SurfaceMesh& body, const ToolShape& tool,
                       std::span<const SurfaceProbe> probes) {
  SurfaceFit result;
  SurfaceFitReport& report = result.report;
  const auto kept = usable(probes, report.left_out);
  const Eigen::VectorXd depth_m = common_depths_m(kept);
  const FieldModel model(body, attach(body, kept));
  for (const AttachedPoint& point : model.point()) {
    report.attachment_max_m = std::max(report.attachment_max_m, point.distance_m);
  }
  std::vector<FieldData> data = field_data(kept, depth_m);
  constexpr int kScreened[] = {5, kCommonDepths - 1};  // a sixth of, and full, depth
  const std::vector<FieldData> two = {data[kScreened[0]], data[kScreened[1]]};
  const ScreenedField screened = screen_probes(model, two);
  report.parameters = screened.parameters;
  list_bad(screened, depth_m, kScreened, kept, report.left_out);
  for (const BadProbe& bad : screened.bad) {
    for (FieldData& set : data) {
      set.used[bad.point] = 0;
    }
  }
  report.probes = kept.size() - screened.bad.size();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    report.laws[law_of(*kept[i])] += data.front().used[i] != 0 ? 1U : 0U;
  }
  const FieldParameters& parameters = screened.parameters.parameters;
  SurfaceFields fields = fields_of(model, parameters, data, depth_m, report);
  const FieldData& shallow = data.front();  // every probe in use says something there
  const Eigen::ArrayXd away_m =
      geodesic_distance_m(body, used_points(model, shallow)).array();
  fields.measured = nodes_with_probe(model, shallow);
  for (const double distance_m : away_m) {
    fields.far.push_back(distance_m > kFarLengths * parameters.length_m ? 1 : 0);
  }
  report.far_nodes = static_cast<std::size_t>(
      std::count(fields.far.begin(), fields.far.end(), char{1}));
  const Points direction =
      node_directions(body, turned(model, shallow, kept), 0.5 * parameters.length_m);
  result.database = surface_database(body, tool, direction, fields);
  report.straightened = straightened(fields);
  report.error_median = median(result.database.tools.front().error_relative);
  result.database.measurement = raw_of(body, probes);
  std::vector<const SurfaceProbe*> behind;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (shallow.used[i] != 0) {
      behind.push_back(kept[i]);
    }
  }
  result.database.tools.front().relaxation = common_relaxation(behind);
  report.relaxation = result.database.tools.front().relaxation;
  return result;
}

std::string describe(const SurfaceFitReport& report) {
  const FieldParameters& p = report.parameters.parameters;
  std::string text = fmt::format(
      "{} probes behind the field, {} left out; farthest from the surface {:.3g} mm\n"
      "length {:.3g} mm, sd {:.3g}, nugget {:.3g} of log force, smoothness {} ({} "
      "likelihoods, {:.2g} "
      "s)\n",
      report.probes, report.left_out.size(), 1e3 * report.attachment_max_m,
      1e3 * p.length_m, p.sd, p.nugget_sd, p.smoothness, report.parameters.evaluations,
      report.parameters.seconds);
  for (const auto& [law, probes] : report.laws) {
    text += fmt::format("law {}: {} probes\n", law, probes);
  }
  for (const std::string& bound : report.parameters.at_bound) {
    text += fmt::format("parameter at bound: {}\n", bound);
  }
  text += fmt::format("{:>12} {:>8} {:>12} {:>10} {:>14}\n", "depth [mm]", "probes",
                      "left-out rms", "coverage", "nearest's rms");
  for (const DepthScore& d : report.depth) {
    text += fmt::format("{:12.4f} {:8} {:12.4f} {:10.3f} {:14.4f}\n", 1e3 * d.depth_m,
                        d.probes, d.rms, d.coverage, d.nearest_rms);
  }
  text += fmt::format(
      "median error of the nodes {:.3g}; {} nodes farther than {} lengths from every "
      "probe; {} nodes whose force would have fallen with depth\n",
      report.error_median, report.far_nodes, kFarLengths, report.straightened);
  text += fmt::format("relaxation: {}\n", report.relaxation.empty()
                                              ? "no probe was held with its time known"
                                              : describe(report.relaxation));
  for (const LeftOutProbe& probe : report.left_out) {
    text += fmt::format("left out {}: {}\n", probe.name, probe.reason);
  }
  return text;
}

}  // namespace palpate

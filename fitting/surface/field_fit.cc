#include "fitting/surface/field_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/surface/field_database.h"
#include "fitting/surface/geodesic_distance.h"
#include "fitting/surface/probe_relaxation.h"
#include "fitting/surface/probe_repeats.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kErrorMin = 1e-3;  // [-] of log force: no curve is known better
constexpr double kErrorMax = 1.0;   // a worse one says nothing
constexpr double kReach = 0.9;      // share of probes that reach the largest depth
constexpr double kAttachmentShareMax = 0.1;          // of the body's diagonal
constexpr int kScreened[] = {5, kCommonDepths - 1};  // a quarter of, and full, depth
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

struct Presses {
  std::vector<const SurfaceProbe*> probe;       // that can be used
  std::vector<std::vector<std::size_t>> place;  // of them, each a point of the model
  JoinedPresses joined;

  [[nodiscard]] std::vector<const SurfaceProbe*> first_of_places() const {
    std::vector<const SurfaceProbe*> first;
    for (const auto& members : place) {
      first.push_back(probe[members.front()]);
    }
    return first;
  }
  // Behind the field, given which places are.
  [[nodiscard]] std::vector<const SurfaceProbe*> behind(
      const std::vector<char>& used) const {
    std::vector<const SurfaceProbe*> found;
    for (std::size_t p = 0; p < place.size(); ++p) {
      for (const std::size_t i : place[p]) {
        if (used[p] != 0 && std::find(joined.left_out.begin(), joined.left_out.end(),
                                      i) == joined.left_out.end()) {
          found.push_back(probe[i]);
        }
      }
    }
    return found;
  }
};

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

Presses joined_presses(const SurfaceMesh& body, std::vector<const SurfaceProbe*> kept,
                       const Eigen::VectorXd& depth_m) {
  Presses presses{std::move(kept), {}, {}};
  std::vector<Eigen::Vector3d> position;
  for (const SurfaceProbe* probe : presses.probe) {
    position.push_back(probe->position_m);
  }
  presses.place =
      places_of(position, kSamePlace * bounding_box(body).diagonal().norm());
  if (presses.place.size() < kProbesMin) {
    throw InputError(
        fmt::format("{} presses that can be used are at {} places, at least {} places "
                    "are needed",
                    presses.probe.size(), presses.place.size(), kProbesMin));
  }
  presses.joined = join_presses(field_data(presses.probe, depth_m), presses.place);
  return presses;
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
    score.coverage += std::abs(residual) <= kNormal95 * sd ? 1.0 : 0.0;
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

// Presses of the bad places, and those far from the others of theirs.
void list_bad(const ScreenedField& screened, const Eigen::VectorXd& depth_m,
              const Presses& presses, std::vector<LeftOutProbe>& left_out) {
  for (const BadProbe& bad : screened.bad) {
    for (const std::size_t i : presses.place[bad.point]) {
      left_out.push_back(
          {presses.probe[i]->name,
           fmt::format(
               "{:.3g} N at {:.3g} m where the others let expect {:.3g} N: {:.1f} "
               "standard deviations",
               std::exp(bad.value), depth_m[kScreened[bad.set]], std::exp(bad.expected),
               bad.score)});
    }
  }
  for (const std::size_t i : presses.joined.left_out) {
    left_out.push_back(
        {presses.probe[i]->name, "far from the other presses at its place"});
  }
}

// Which places say something at a depth or more.
FieldData said_anywhere(const std::vector<FieldData>& data) {
  FieldData any = data.front();
  for (const FieldData& set : data) {
    for (std::size_t i = 0; i < any.used.size(); ++i) {
      any.used[i] = any.used[i] != 0 || set.used[i] != 0 ? 1 : 0;
    }
  }
  return any;
}

// Presses of places that say nothing at any depth, and are not bad.
void list_silent(const ScreenedField& screened, const FieldData& any,
                 const Eigen::VectorXd& depth_m, const Presses& presses,
                 std::vector<LeftOutProbe>& left_out) {
  std::vector<char> told(any.used);
  for (const BadProbe& bad : screened.bad) {
    told[bad.point] = 1;
  }
  const std::vector<std::size_t>& far = presses.joined.left_out;
  for (std::size_t p = 0; p < told.size(); ++p) {
    for (const std::size_t i : presses.place[p]) {
      if (told[p] == 0 && std::find(far.begin(), far.end(), i) == far.end()) {
        left_out.push_back(
            {presses.probe[i]->name,
             fmt::format("its force is not known at any depth of the others, {:.3g} to "
                         "{:.3g} m",
                         depth_m[0], depth_m[kCommonDepths - 1])});
      }
    }
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

double mean_square_nugget(std::span<const ProbableParameters> probable) {
  double sum = 0.0;
  for (const auto& [parameters, weight] : probable) {
    sum += weight * parameters.nugget_sd * parameters.nugget_sd;
  }
  return sum;
}

SurfaceFields fields_of(const FieldModel& model,
                        std::span<const ProbableParameters> probable,
                        const std::vector<FieldData>& data,
                        const std::vector<double>& repeatability,
                        const Eigen::VectorXd& depth_m, SurfaceFitReport& report) {
  SurfaceFields fields{depth_m, {}, {}, {}, {}};
  fields.log_force.resize(model.mesh().position_m.rows(), depth_m.size());
  fields.sd = fields.log_force;
  const double roughness = mean_square_nugget(probable);
  for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const FieldPosterior posterior = mixed_posterior(model, probable, data[at]);
    const double own = std::isnan(repeatability[at]) ? 0.0 : roughness;
    fields.log_force.col(k) = posterior.at_nodes();
    fields.sd.col(k) = (posterior.sd.array().square() + own).sqrt();
    if (k >= kFirstScored) {
      report.depth.push_back(score_of(model, data[at], posterior, depth_m[k]));
    }
  }
  return fields;
}

// Nodes that have a probe, and those too far from every one.
void mark_nodes(const FieldModel& model, const FieldData& set, double length_m,
                SurfaceFields& fields) {
  fields.measured = nodes_with_probe(model, set);
  for (const double distance_m :
       geodesic_distance_m(model.mesh(), used_points(model, set))) {
    fields.far.push_back(distance_m > kFarLengths * length_m ? 1 : 0);
  }
}

}  // namespace

SurfaceFit fit_surface(const SurfaceMesh& body, const ToolShape& tool,
                       std::span<const SurfaceProbe> probes,
                       const SurfaceFitOptions& options) {
  SurfaceFit result;
  SurfaceFitReport& report = result.report;
  auto kept = usable(probes, report.left_out);
  const Eigen::VectorXd depth_m = common_depths_m(kept);
  const Presses presses = joined_presses(body, std::move(kept), depth_m);
  const std::vector<const SurfaceProbe*> places = presses.first_of_places();
  const FieldModel model(body, attach(body, places));
  for (const AttachedPoint& point : model.point()) {
    report.attachment_max_m = std::max(report.attachment_max_m, point.distance_m);
  }
  std::vector<FieldData> data = presses.joined.data;
  const std::vector<FieldData> two = {data[kScreened[0]], data[kScreened[1]]};
  const ScreenedField screened = screen_probes(model, two);
  report.parameters = screened.parameters;
  list_bad(screened, depth_m, presses, report.left_out);
  for (const BadProbe& bad : screened.bad) {
    for (FieldData& set : data) {
      set.used[bad.point] = 0;
    }
  }
  const FieldParameters& parameters = screened.parameters.parameters;
  if (options.patches) {
    report.patches = left_out_patches(model, two, parameters);
  }
  const FieldData any = said_anywhere(data);
  list_silent(screened, any, depth_m, presses, report.left_out);
  const auto behind = presses.behind(any.used);
  report.runs = probes.size();
  report.probes = behind.size();
  report.places = used_points(model, any).size();
  report.repeatability = presses.joined.repeatability.back();
  for (const SurfaceProbe* probe : behind) {
    ++report.laws[law_of(*probe)];
  }
  const auto probable = probable_parameters(model, screened.data, screened.parameters);
  SurfaceFields fields =
      fields_of(model, probable, data, presses.joined.repeatability, depth_m, report);
  mark_nodes(model, any, parameters.length_m, fields);
  report.far_nodes = static_cast<std::size_t>(
      std::count(fields.far.begin(), fields.far.end(), char{1}));
  const Points direction =
      node_directions(body, turned(model, any, places), 0.5 * parameters.length_m);
  result.database = surface_database(body, tool, direction, fields);
  report.straightened = straightened(fields);
  report.error_median = median(result.database.tools.front().error_relative);
  result.database.measurement = raw_of(body, probes);
  report.relaxation_field = keep_relaxation(behind, result.database);
  report.relaxation = common_relaxation(behind);
  report.viscoelasticity = result.database.tools.front().viscoelasticity;
  return result;
}

}  // namespace palpate

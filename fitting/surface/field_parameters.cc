#include "fitting/surface/field_parameters.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "fitting/numerics/axial_design.h"
#include "fitting/numerics/nelder_mead.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

// One of 20 before the data: lengths shorter than this share of the diagonal, standard
// deviations larger than these.
constexpr double kShortLength = 0.05, kLargeSd = 2.0, kLargeNugget = 0.3;
constexpr double kRare = 2.995732273553991;  // -ln 0.05
constexpr double kWeightMin = 0.01;
constexpr double kCurvatureStep = 0.25, kWidest = 1.5;  // of logarithms

struct Bounds {
  Eigen::Vector3d lower, upper;  // logarithms of length, sd, nugget
};

Bounds bounds_of(const SurfaceMesh& mesh) {
  const double diagonal_m = bounding_box(mesh).diagonal().norm();
  return {Eigen::Vector3d(mean_edge_m(mesh), 1e-3, 1e-4).array().log(),
          Eigen::Vector3d(2.0 * diagonal_m, 10.0, 3.0).array().log()};
}

FieldParameters parameters_of(const Eigen::Vector3d& logarithm, int smoothness) {
  return {std::exp(logarithm[0]), std::exp(logarithm[1]), std::exp(logarithm[2]),
          smoothness};
}

// Long waves on fine meshes: the precision's condition goes with (length / edge)^6, and
// what is left of the digits would not do.
bool too_smooth(const FieldParameters& p, double edge_m) {
  return p.smoothness == 2 && std::pow(p.length_m / edge_m, 6) > 1e11;
}

// Minus the log density of the parameters' logarithms before the data.
double cost_before(const FieldParameters& p, double diagonal_m) {
  // Penalised complexity (Fuglstad et al. 2019) of logarithms, but for constants:
  //   length l   a / l + ln l,  a = -ln(0.05) l_0
  //   sd s       b s - ln s,    b = -ln(0.05) / s_0; of the nugget as well
  const double shortest = kRare * kShortLength * diagonal_m;
  const double sd = kRare * p.sd / kLargeSd,
               nugget = kRare * p.nugget_sd / kLargeNugget;
  return shortest / p.length_m + std::log(p.length_m / diagonal_m) + sd - std::log(sd) +
         nugget - std::log(nugget);
}

double spread_of(std::span<const FieldData> data) {
  double sum = 0.0;
  for (const FieldData& set : data) {
    std::vector<double> used;
    for (std::size_t i = 0; i < set.used.size(); ++i) {
      if (set.used[i] != 0) {
        used.push_back(set.value[static_cast<Eigen::Index>(i)]);
      }
    }
    sum += robust_standard_deviation(used);
  }
  return std::clamp(sum / static_cast<double>(data.size()), 0.01, 5.0);
}

std::vector<std::string> names_at_bound(const Eigen::Vector3d& x,
                                        const Bounds& bounds) {
  constexpr std::array<const char*, 3> kNames{"length", "sd", "nugget"};
  std::vector<std::string> names;
  for (int i = 0; i < 3; ++i) {
    const std::string name = kNames[static_cast<std::size_t>(i)];
    if (x[i] - bounds.lower[i] < 0.02) {
      names.push_back(name + " lower bound");
    } else if (bounds.upper[i] - x[i] < 0.02) {
      names.push_back(name + " upper bound");
    }
  }
  return names;
}

}  // namespace

namespace {

class Search {
 public:
  Search(const FieldModel& model, std::span<const FieldData> data)
      : model_(model),
        data_(data),
        bounds_(bounds_of(model.mesh())),
        diagonal_m_(bounding_box(model.mesh()).diagonal().norm()),
        edge_m_(mean_edge_m(model.mesh())) {}

  // Minus the log density after the data, and a penalty outside the bounds.
  double cost(const Eigen::VectorXd& x, int smoothness) {
    const Eigen::Vector3d in = inside(x);
    const FieldParameters parameters = parameters_of(in, smoothness);
    if (too_smooth(parameters, edge_m_)) {
      return std::numeric_limits<double>::infinity();
    }
    ++evaluations_;
    return 100.0 * (x - in).squaredNorm() + cost_before(parameters, diagonal_m_) -
           log_likelihood(parameters);
  }

  [[nodiscard]] double log_likelihood(const FieldParameters& parameters) const {
    double sum = 0.0;
    for (const FieldData& set : data_) {
      sum += model_.log_marginal_likelihood(parameters, set);
    }
    return sum / static_cast<double>(data_.size());
  }

  SimplexReport from(const Eigen::Vector3d& start, int smoothness, double step) {
    return minimise_simplex(
        [&](const Eigen::VectorXd& x) {
          return cost(x, smoothness);
        },
        start,
        {.step = step, .tolerance_x = 0.03, .tolerance_f = 0.01, .evaluations = 150});
  }

  [[nodiscard]] Eigen::Vector3d inside(const Eigen::VectorXd& x) const {
    return x.cwiseMax(bounds_.lower).cwiseMin(bounds_.upper);
  }
  [[nodiscard]] const Bounds& bounds() const { return bounds_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }

  // The best of three lengths; smoother fields have shorter ones.
  Eigen::Vector3d start(int smoothness) {
    const double spread = spread_of(data_);
    Eigen::Vector3d best_x =
        inside(Eigen::Array3d(diagonal_m_, spread, 0.1 * spread).log().matrix());
    double best = std::numeric_limits<double>::infinity();
    for (const double share :
         {0.08 / smoothness, 0.25 / smoothness, 0.8 / smoothness}) {
      const Eigen::Vector3d x(std::log(share * diagonal_m_), std::log(spread),
                              std::log(0.1 * spread));
      const double value = cost(x, smoothness);
      if (value < best) {
        best = value;
        best_x = x;
      }
    }
    return best_x;
  }

 private:
  const FieldModel& model_;
  std::span<const FieldData> data_;
  Bounds bounds_;
  double diagonal_m_;
  double edge_m_;
  int evaluations_ = 0;
};

}  // namespace

FieldParametersReport fit_field_parameters(const FieldModel& model,
                                           std::span<const FieldData> data,
                                           const FieldParameters* near) {
  if (data.empty()) {
    throw InputError("field parameters: no data");
  }
  const auto begin = std::chrono::steady_clock::now();
  Search search(model, data);
  SimplexReport found;
  FieldParametersReport report;
  int smoothness = 0;
  // Each smoothness has its own optimum; the better one is reported, and both are kept.
  for (const int nu : {1, 2}) {
    const bool near_fits = near != nullptr && near->smoothness == nu;
    const Eigen::Vector3d start =
        near_fits ? search.inside(Eigen::Array3d(near->length_m, near->sd,
                                                 std::max(near->nugget_sd, 1e-4))
                                      .log()
                                      .matrix())
                  : search.start(nu);
    const SimplexReport best = search.from(start, nu, near_fits ? 0.15 : 0.4);
    report.of_smoothness[static_cast<std::size_t>(nu - 1)] =
        parameters_of(search.inside(best.x), nu);
    if (smoothness == 0 || best.value < found.value) {
      found = best;
      smoothness = nu;
    }
  }
  const Eigen::Vector3d x = search.inside(found.x);
  report.parameters = parameters_of(x, smoothness);
  report.log_likelihood = search.log_likelihood(report.parameters);
  report.evaluations = search.evaluations();
  report.converged = found.converged;
  report.at_bound = names_at_bound(x, search.bounds());
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

std::vector<ProbableParameters> probable_parameters(
    const FieldModel& model, std::span<const FieldData> data,
    const FieldParametersReport& report) {
  // Points along the axes of the curvature at each smoothness' optimum (Rue, Martino,
  // Chopin 2009). Smoothnesses share the weight by their evidence.
  Search search(model, data);
  std::array<AxialDesign, 2> designs;
  for (const FieldParameters& p : report.of_smoothness) {
    const Eigen::Vector3d centre =
        Eigen::Array3d(p.length_m, p.sd, p.nugget_sd).log().matrix();
    designs[static_cast<std::size_t>(p.smoothness - 1)] = axial_design(
        [&](const Eigen::VectorXd& x) {
          return search.cost(x, p.smoothness);
        },
        centre, kCurvatureStep, kWidest);
  }
  const double most = std::max(designs[0].log_evidence, designs[1].log_evidence);
  std::vector<ProbableParameters> probable;
  double sum = 0.0;
  const double all = std::exp(designs[0].log_evidence - most) +
                     std::exp(designs[1].log_evidence - most);
  for (const FieldParameters& p : report.of_smoothness) {
    const AxialDesign& design = designs[static_cast<std::size_t>(p.smoothness - 1)];
    for (const WeighedPoint& point : design.points) {
      const double weight = point.weight * std::exp(design.log_evidence - most) / all;
      // Improbable points cost a posterior each and change nothing.
      if (weight >= kWeightMin) {
        probable.push_back(
            {parameters_of(search.inside(point.x), p.smoothness), weight});
        sum += weight;
      }
    }
  }
  for (ProbableParameters& p : probable) {
    p.weight /= sum;
  }
  return probable;
}

FieldPosterior mixed_posterior(const FieldModel& model,
                               std::span<const ProbableParameters> probable,
                               const FieldData& data) {
  // Mean sum_i w_i m_i, variance sum_i w_i (s_i^2 + m_i^2) - mean^2, at nodes and left
  // out.
  FieldPosterior mixed;
  Eigen::ArrayXd squares, left_out_squares;
  for (std::size_t i = 0; i < probable.size(); ++i) {
    const FieldPosterior one = model.posterior(probable[i].parameters, data);
    const double w = probable[i].weight;
    if (i == 0) {
      mixed = one;
      mixed.mean_level = mixed.log_likelihood = 0.0;
      mixed.mean.setZero();
      mixed.sag.setZero();
      mixed.left_out_residual.setZero();
      squares = Eigen::ArrayXd::Zero(one.mean.size());
      left_out_squares = Eigen::ArrayXd::Zero(one.left_out_residual.size());
    }
    mixed.mean_level += w * one.mean_level;
    mixed.log_likelihood += w * one.log_likelihood;
    mixed.mean += w * one.mean;
    mixed.sag += w * one.sag;
    mixed.left_out_residual += w * one.left_out_residual;
    squares += w * (one.sd.array().square() + one.at_nodes().array().square());
    left_out_squares +=
        w * (one.left_out_sd.array().square() + one.left_out_residual.array().square());
  }
  mixed.sd = (squares - mixed.at_nodes().array().square()).max(0.0).sqrt();
  mixed.left_out_sd =
      (left_out_squares - mixed.left_out_residual.array().square()).max(0.0).sqrt();
  return mixed;
}

}  // namespace palpate

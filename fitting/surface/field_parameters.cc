#include "fitting/surface/field_parameters.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "fitting/numerics/nelder_mead.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

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
        edge_m_(mean_edge_m(model.mesh())) {}

  // Minus the log likelihood, and a penalty outside the bounds.
  double cost(const Eigen::VectorXd& x, int smoothness) {
    const Eigen::Vector3d in = inside(x);
    const FieldParameters parameters = parameters_of(in, smoothness);
    if (too_smooth(parameters, edge_m_)) {
      return std::numeric_limits<double>::infinity();
    }
    ++evaluations_;
    double sum = 100.0 * (x - in).squaredNorm();
    for (const FieldData& set : data_) {
      sum -= model_.log_marginal_likelihood(parameters, set);
    }
    return sum;
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
    const double diagonal_m = bounding_box(model_.mesh()).diagonal().norm();
    const double spread = spread_of(data_);
    Eigen::Vector3d best_x =
        inside(Eigen::Array3d(diagonal_m, spread, 0.1 * spread).log().matrix());
    double best = std::numeric_limits<double>::infinity();
    for (const double share :
         {0.08 / smoothness, 0.25 / smoothness, 0.8 / smoothness}) {
      const Eigen::Vector3d x(std::log(share * diagonal_m), std::log(spread),
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
  int smoothness = 0;
  for (const int nu : {1, 2}) {
    const bool near_fits = near != nullptr && near->smoothness == nu;
    const Eigen::Vector3d start =
        near_fits ? search.inside(Eigen::Array3d(near->length_m, near->sd,
                                                 std::max(near->nugget_sd, 1e-4))
                                      .log()
                                      .matrix())
                  : search.start(nu);
    const SimplexReport report = search.from(start, nu, near_fits ? 0.15 : 0.4);
    if (smoothness == 0 || report.value < found.value) {
      found = report;
      smoothness = nu;
    }
  }
  FieldParametersReport report;
  const Eigen::Vector3d x = search.inside(found.x);
  report.parameters = parameters_of(x, smoothness);
  report.log_likelihood = -found.value;
  report.evaluations = search.evaluations();
  report.converged = found.converged;
  report.at_bound = names_at_bound(x, search.bounds());
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

}  // namespace palpate

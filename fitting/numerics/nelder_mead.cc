#include "fitting/numerics/nelder_mead.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpate {
namespace {

struct Corner {
  Eigen::VectorXd x;
  double value;
};

}  // namespace

SimplexReport minimise_simplex(const std::function<double(const Eigen::VectorXd&)>& f,
                               const Eigen::VectorXd& start,
                               const SimplexOptions& options) {
  SimplexReport report;
  const auto evaluate = [&](const Eigen::VectorXd& x) {
    ++report.evaluations;
    const double value = f(x);
    return Corner{x,
                  std::isnan(value) ? std::numeric_limits<double>::infinity() : value};
  };
  const Eigen::Index n = start.size();
  std::vector<Corner> simplex{evaluate(start)};
  for (Eigen::Index i = 0; i < n; ++i) {
    simplex.push_back(evaluate(start + options.step * Eigen::VectorXd::Unit(n, i)));
  }
  const auto by_value = [](const Corner& a, const Corner& b) {
    return a.value < b.value;
  };
  while (true) {
    std::stable_sort(simplex.begin(), simplex.end(), by_value);
    double size = 0.0;
    Eigen::VectorXd centre = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < simplex.size(); ++i) {
      size = std::max(size, (simplex[i].x - simplex[0].x).cwiseAbs().maxCoeff());
      centre += i + 1 < simplex.size() ? simplex[i].x : Eigen::VectorXd::Zero(n);
    }
    centre /= static_cast<double>(n);
    report.converged = size < options.tolerance_x &&
                       simplex.back().value - simplex[0].value < options.tolerance_f;
    if (report.converged || report.evaluations >= options.evaluations) {
      break;
    }
    Corner& worst = simplex.back();
    // The worst corner is reflected at the centre of the others. The step is doubled
    // where that is the best, and halved on the better side where that is the worst.
    // If nothing helps, all corners halve their way to the best.
    const Eigen::VectorXd outward = centre - worst.x;
    const Corner reflected = evaluate(centre + outward);
    if (reflected.value < simplex[0].value) {
      const Corner further = evaluate(centre + 2.0 * outward);
      worst = further.value < reflected.value ? further : reflected;
    } else if (reflected.value < simplex[simplex.size() - 2].value) {
      worst = reflected;
    } else {
      const bool outside = reflected.value < worst.value;
      const Corner nearer = evaluate(centre + (outside ? 0.5 : -0.5) * outward);
      if (nearer.value < std::min(reflected.value, worst.value)) {
        worst = nearer;
      } else {
        for (std::size_t i = 1; i < simplex.size(); ++i) {
          simplex[i] = evaluate(0.5 * (simplex[i].x + simplex[0].x));
        }
      }
    }
  }
  report.x = simplex[0].x;
  report.value = simplex[0].value;
  return report;
}

}  // namespace palpate

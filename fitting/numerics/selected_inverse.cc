#include "fitting/numerics/selected_inverse.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace palpate {

SelectedInverse::SelectedInverse(const SparseFactor& factor)
    : entry_(factor.matrixL().nestedExpression()),
      place_(factor.permutationP().indices()) {
  entry_.makeCompressed();
  const int n = static_cast<int>(entry_.cols());
  if (place_.size() == 0) {
    place_ = Eigen::VectorXi::LinSpaced(n, 0, n - 1);
  }
  const int* begin = entry_.outerIndexPtr();
  const int* row = entry_.innerIndexPtr();
  double* value = entry_.valuePtr();  // L, overwritten by S from the last column on
  // Columns i from the last, over rows j, k > i of L's pattern:
  //   S_ji = -sum_k S_jk L_ki / L_ii,  S_ii = (1 / L_ii - sum_k L_ki S_ki) / L_ii
  // (Takahashi, Fagan, Chin 1973).
  std::vector<int> slot(static_cast<std::size_t>(n), -1);
  Eigen::VectorXd sum;
  for (int i = n - 1; i >= 0; --i) {
    const int first = begin[i] + 1;  // below the diagonal, rows ascending
    const int below = begin[i + 1] - first;
    const Eigen::Map<const Eigen::VectorXd> column(value + first, below);
    for (int a = 0; a < below; ++a) {
      slot[static_cast<std::size_t>(row[first + a])] = a;
    }
    sum.setZero(below);
    for (int a = 0; a < below; ++a) {
      const int j = row[first + a];
      sum[a] += value[begin[j]] * column[a];
      for (int p = begin[j] + 1; p < begin[j + 1]; ++p) {
        const int b = slot[static_cast<std::size_t>(row[p])];
        if (b >= 0) {
          sum[b] += value[p] * column[a];
          sum[a] += value[p] * column[b];
        }
      }
    }
    for (int a = 0; a < below; ++a) {
      slot[static_cast<std::size_t>(row[first + a])] = -1;
    }
    const double pivot = value[begin[i]];
    sum /= -pivot;
    value[begin[i]] = (1.0 / pivot - column.dot(sum)) / pivot;
    Eigen::Map<Eigen::VectorXd>(value + first, below) = sum;
  }
}

double SelectedInverse::at(Eigen::Index i, Eigen::Index j) const {
  const auto [column, wanted] = std::minmax(place_[i], place_[j]);
  const int* row = entry_.innerIndexPtr();
  const int* end = row + entry_.outerIndexPtr()[column + 1];
  const int* found =
      std::lower_bound(row + entry_.outerIndexPtr()[column], end, wanted);
  return found != end && *found == wanted ? entry_.valuePtr()[found - row]
                                          : std::numeric_limits<double>::quiet_NaN();
}

Eigen::VectorXd SelectedInverse::diagonal() const {
  Eigen::VectorXd result(place_.size());
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result[i] = at(i, i);
  }
  return result;
}

}  // namespace palpate

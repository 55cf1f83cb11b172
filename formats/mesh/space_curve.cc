#include "formats/mesh/space_curve.h"

#include <algorithm>
#include <numeric>

namespace palpate {
namespace {

using Cell = Eigen::Matrix<std::uint32_t, 3, 1>;

// Skilling's transform: from coordinates to the curve's place with its bits spread over
// the three, undoing the turns and mirrors of each level from the coarsest on.
Cell transposed_place(Cell x) {
  constexpr std::uint32_t kTop = 1u << (kCurveBits - 1);
  for (std::uint32_t bit = kTop; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if ((x[i] & bit) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t swapped = (x[0] ^ x[i]) & below;
        x[0] ^= swapped;
        x[i] ^= swapped;
      }
    }
  }
  x[1] ^= x[0];  // Gray code
  x[2] ^= x[1];
  std::uint32_t turn = 0;
  for (std::uint32_t bit = kTop; bit > 1; bit >>= 1) {
    if ((x[2] & bit) != 0) {
      turn ^= bit - 1;
    }
  }
  return {x[0] ^ turn, x[1] ^ turn, x[2] ^ turn};
}

}  // namespace

std::uint64_t hilbert_place(const Cell& cell) {
  const Cell place = transposed_place(cell);
  std::uint64_t key = 0;
  for (int bit = kCurveBits - 1; bit >= 0; --bit) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      key = key << 1 | (place[i] >> bit & 1u);
    }
  }
  return key;
}

std::vector<std::int32_t> curve_order(const Points& points) {
  const auto n = static_cast<std::size_t>(points.rows());
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  if (n == 0) {
    return order;
  }
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  const double size = (points.colwise().maxCoeff() - low).maxCoeff();
  const double cells = static_cast<double>((1u << kCurveBits) - 1);
  const double scale = size > 0.0 ? cells / size : 0.0;
  std::vector<std::uint64_t> key(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::RowVector3d at =
        (points.row(static_cast<Eigen::Index>(i)) - low) * scale;
    key[i] = hilbert_place(at.transpose().unaryExpr([cells](double x) {
      return static_cast<std::uint32_t>(x > 0.0 ? std::min(x, cells) : 0.0);
    }));
  }
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
  });
  return order;
}

}  // namespace palpate

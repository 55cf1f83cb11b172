#include "precompute/fem/block_matrix.h"

#include <algorithm>
#include <functional>

namespace palpate {

BlockMatrix::BlockMatrix(std::int32_t nodes, const NodeGroups& groups)
    : groups_(groups) {
  // Compressed rows: blocks (a, b), b <= a, of nodes that share a group, without
  // repeats.
  std::vector<std::vector<std::int32_t>> row(static_cast<std::size_t>(nodes));
  for (Eigen::Index g = 0; g < groups.rows(); ++g) {
    for (Eigen::Index i = 0; i < groups.cols(); ++i) {
      for (Eigen::Index j = 0; j < groups.cols(); ++j) {
        if (groups(g, j) <= groups(g, i)) {
          row[static_cast<std::size_t>(groups(g, i))].push_back(groups(g, j));
        }
      }
    }
  }
  for (auto& list : row) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    column_.insert(column_.end(), list.begin(), list.end());
    begin_.push_back(static_cast<std::int64_t>(column_.size()));
  }
  // slot_ holds where each pair (i, j) of each group adds. Its mirror image adds the
  // pairs above the diagonal.
  value_.assign(9 * column_.size(), 0.0);
  for (Eigen::Index g = 0; g < groups_.rows(); ++g) {
    for (Eigen::Index i = 0; i < groups_.cols(); ++i) {
      for (Eigen::Index j = 0; j < groups_.cols(); ++j) {
        const bool lower = groups_(g, j) <= groups_(g, i);
        slot_.push_back(lower ? slot(groups_(g, i), groups_(g, j)) : -1);
      }
    }
  }
}

void BlockMatrix::set_zero() {
  std::fill(value_.begin(), value_.end(), 0.0);
}

void BlockMatrix::set_negative(const BlockMatrix& other) {
  std::transform(other.value_.begin(), other.value_.end(), value_.begin(),
                 std::negate<>());
}

std::int64_t BlockMatrix::slot(std::int32_t a, std::int32_t b) const {
  const auto first = column_.begin() + begin_[static_cast<std::size_t>(a)];
  const auto last = column_.begin() + begin_[static_cast<std::size_t>(a) + 1];
  return std::lower_bound(first, last, b) - column_.begin();
}

void BlockMatrix::add(Eigen::Index group, const Eigen::Ref<const Eigen::MatrixXd>& K) {
  const Eigen::Index n = groups_.cols();
  auto at = slot_.begin() + group * n * n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j, ++at) {
      if (*at >= 0) {
        Eigen::Map<Eigen::Matrix3d>(value_.data() + 9 * *at) +=
            K.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

void BlockMatrix::add(std::span<const Eigen::Index> groups,
                      const double (*blocks)[9][kBatch]) {
  for (std::size_t a = 0, block = 0; a < kElementNodes; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++block) {
      const auto& from = blocks[block];
      for (std::size_t lane = 0; lane < groups.size(); ++lane) {
        const std::int64_t* slots =
            slot_.data() +
            static_cast<std::size_t>(groups[lane]) * kElementNodes * kElementNodes;
        if (const std::int64_t lower = slots[a * kElementNodes + b]; lower >= 0) {
          double* to = value_.data() + 9 * lower;
          for (std::size_t k = 0; k < 9; ++k) {
            to[k] += from[k][lane];
          }
        } else {
          // The mesh numbers the pair the other way round: the block is added
          // transposed.
          double* to = value_.data() + 9 * slots[b * kElementNodes + a];
          for (std::size_t k = 0; k < 9; ++k) {
            to[k] += from[3 * (k % 3) + k / 3][lane];
          }
        }
      }
    }
  }
}

void BlockMatrix::multiply_add(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  // y_a += A_ab x_b and, for the half that is not stored, y_b += A_ab^T x_a.
  for (std::int32_t a = 0; a < nodes(); ++a) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3d x_a = x.segment<3>(3 * Eigen::Index{a});
    for (auto at = begin_[static_cast<std::size_t>(a)];
         at < begin_[static_cast<std::size_t>(a) + 1]; ++at) {
      const Eigen::Index b = column_[static_cast<std::size_t>(at)];
      const Block A = block(at);
      sum += A * x.segment<3>(3 * b);
      if (b != a) {
        y.segment<3>(3 * b) += A.transpose() * x_a;
      }
    }
    y.segment<3>(3 * Eigen::Index{a}) += sum;
  }
}

double BlockMatrix::quadratic_form(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  multiply_add(x, y);
  return x.dot(y);
}

}  // namespace palpate

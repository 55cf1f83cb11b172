#include "precompute/fem/permuted_stiffness.h"

#include "formats/base/at.h"

namespace palpate {
namespace {

constexpr std::ptrdiff_t kAxes = 3;

bool has_blocks(const Stiffness& lower) {
  const std::int64_t* begin = lower.outerIndexPtr();
  const std::int64_t* row = lower.innerIndexPtr();
  if (lower.cols() % kAxes != 0) {
    return false;
  }
  // Columns c to c + 2 of a block hold the same rows, each less those above its
  // diagonal. Rows come in threes, from a multiple of three on.
  for (std::int64_t c = 0; c < lower.cols(); c += kAxes) {
    const std::int64_t rows = begin[c + 1] - begin[c];
    if (rows % kAxes != 0 || begin[c + 2] - begin[c + 1] != rows - 1 ||
        begin[c + 3] - begin[c + 2] != rows - 2) {
      return false;
    }
    for (std::int64_t i = begin[c]; i < begin[c + 1]; i += kAxes) {
      if (row[i] % kAxes != 0 || row[i + 1] != row[i] + 1 || row[i + 2] != row[i] + 2) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::ptrdiff_t block_size(const Stiffness& lower) {
  return has_blocks(lower) ? kAxes : 1;
}

LowerPattern pattern_of(const Stiffness& lower, std::ptrdiff_t block) {
  LowerPattern pattern;
  pattern.begin.push_back(0);
  for (std::int64_t c = 0; c < lower.cols(); c += block) {
    for (std::int64_t i = lower.outerIndexPtr()[c]; i < lower.outerIndexPtr()[c + 1];
         i += block) {
      pattern.row.push_back(lower.innerIndexPtr()[i] / block);
    }
    pattern.begin.push_back(static_cast<std::int64_t>(pattern.row.size()));
  }
  return pattern;
}

template <typename Visit>
void PermutedStiffness::for_each_below(const Visit& visit) const {
  for (std::int64_t c = 0; c < lower_.cols() / block_; ++c) {
    for (std::int64_t slot = 1; slot < blocks_in(c); ++slot) {
      visit(c, row_of(c, slot), slot);
    }
  }
}

PermutedStiffness::PermutedStiffness(const Stiffness& lower, std::ptrdiff_t block,
                                     const std::vector<std::int32_t>& order)
    : lower_(lower), block_(block), order_(order), place_(order.size()) {
  for (std::size_t k = 0; k < order.size(); ++k) {
    place_[at(order[k])] = static_cast<std::int32_t>(k);
  }
  above_begin_.assign(order.size() + 1, 0);
  for_each_below([&](std::int64_t, std::int64_t row, std::int64_t) {
    ++above_begin_[at(row) + 1];
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    above_begin_[i + 1] += above_begin_[i];
  }
  above_.resize(at(above_begin_.back()));
  std::vector<std::int64_t> next = above_begin_;
  for_each_below([&](std::int64_t column, std::int64_t row, std::int64_t slot) {
    above_[at(next[at(row)]++)] = {column, slot};
  });
}

void PermutedStiffness::add_to(std::int32_t first, std::int32_t last,
                               const std::vector<std::int32_t>& local, double* numbers,
                               std::ptrdiff_t ld) const {
  for (std::int32_t k = first; k < last; ++k) {
    const std::int64_t c = order_[at(k)];
    double* const column = numbers + std::ptrdiff_t{k - first} * block_ * ld;
    // Column k of the permuted matrix takes rows >= k: of column c of the lower
    // triangle, and, transposed, of row c of it.
    for (std::int64_t slot = 0; slot < blocks_in(c); ++slot) {
      const std::int32_t row = place_[at(row_of(c, slot))];
      if (row >= k) {
        add_block(c, slot, false, column + std::ptrdiff_t{local[at(row)]} * block_, ld);
      }
    }
    for (auto i = above_begin_[at(c)]; i < above_begin_[at(c) + 1]; ++i) {
      const Above& entry = above_[at(i)];
      const std::int32_t row = place_[at(entry.column)];
      if (row > k) {
        add_block(entry.column, entry.slot, true,
                  column + std::ptrdiff_t{local[at(row)]} * block_, ld);
      }
    }
  }
}

std::int64_t PermutedStiffness::blocks_in(std::int64_t column) const {
  const std::int64_t* begin = lower_.outerIndexPtr() + column * block_;
  return (begin[1] - begin[0]) / block_;
}

std::int64_t PermutedStiffness::row_of(std::int64_t column, std::int64_t slot) const {
  return lower_
             .innerIndexPtr()[lower_.outerIndexPtr()[column * block_] + slot * block_] /
         block_;
}

// The block of that place in K's column of blocks, or its transposed.
void PermutedStiffness::add_block(std::int64_t column, std::int64_t slot,
                                  bool transposed, double* to,
                                  std::ptrdiff_t ld) const {
  for (std::ptrdiff_t b = 0; b < block_; ++b) {
    // The first block of column b of three begins at its diagonal.
    const std::int64_t begin = lower_.outerIndexPtr()[column * block_ + b];
    const double* value = lower_.valuePtr() + begin + slot * block_ - b;
    for (std::ptrdiff_t a = slot == 0 ? b : 0; a < block_; ++a) {
      to[transposed ? b + a * ld : a + b * ld] += value[a];
    }
  }
}

}  // namespace palpate

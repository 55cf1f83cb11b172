#include "precompute/fem/load_compliance.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "formats/base/at.h"
#include "precompute/lanes/factor_kernels.h"
#include "precompute/process/reused_memory.h"

namespace palpate {
namespace {

// Columns of a supernode that are eliminated at a time: loads that begin after them are
// not touched.
constexpr std::ptrdiff_t kColumnBlock = 64;
// Columns of Y'Y that are summed up at a time.
constexpr std::ptrdiff_t kStrip = 128;

struct Entry {
  std::int32_t row, load;
  double value;
};

// The loads in the order in which their first unknowns are eliminated.
struct SortedLoads {
  std::vector<Eigen::Index> column;  // of A
  std::vector<std::int32_t> first;   // row
  std::vector<Entry> entry;          // by rows, then by loads

  explicit SortedLoads(const LoadColumns& A) {
    // Loads are numbered by their first rows, so that those which have begun come
    // first.
    std::vector<std::pair<std::int32_t, Eigen::Index>> order;
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      auto row = std::numeric_limits<std::int32_t>::max();
      for (LoadColumns::InnerIterator of(A, j); of; ++of) {
        row = std::min(row, static_cast<std::int32_t>(of.row()));
      }
      order.emplace_back(row, j);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [row, j] : order) {
      for (LoadColumns::InnerIterator of(A, j); of; ++of) {
        entry.push_back({static_cast<std::int32_t>(of.row()),
                         static_cast<std::int32_t>(column.size()), of.value()});
      }
      column.push_back(j);
      first.push_back(row);
    }
    std::stable_sort(entry.begin(), entry.end(), [](const Entry& a, const Entry& b) {
      return a.row < b.row;
    });
  }
};

// What loads that have begun leave at unknowns that are still to be eliminated.
struct Front {
  std::vector<std::int32_t> load;  // ascending
  std::vector<std::int32_t> row;   // ascending
  std::vector<double> number;      // (load x row)
};

class Elimination {
 public:
  Elimination(const SupernodeView& part, const LoadColumns& A)
      : part_(part),
        all_(A),
        handed_on_(at(part.count)),
        local_(at(part.count > 0 ? part.begin[part.count] : 0)),
        place_(at(A.cols())),
        front_(reused_doubles(at(kernels_.product_rows(A.cols()) * part.rows_max))),
        C_(Eigen::MatrixXd::Zero(A.cols(), A.cols())) {}

  Eigen::MatrixXd run() {
    // Children come before their parent. A supernode's front (loads x rows) is summed
    // up and its columns are eliminated to Y'. Their products add to C = Y'Y; the rest
    // of the front goes to the parent.
    for (std::ptrdiff_t s = 0; s < part_.count; ++s) {
      choose_loads(s);
      if (!load_.empty()) {
        assemble(s);
        eliminate(s);
        add_products(s);
        hand_on(s);
      }
    }
    // Loads are sorted, columns of A are not. Each pair was added on one side of the
    // diagonal.
    for (Eigen::Index j = 0; j < C_.cols(); ++j) {
      for (Eigen::Index i = 0; i < j; ++i) {
        C_(i, j) += C_(j, i);
        C_(j, i) = C_(i, j);
      }
    }
    return std::move(C_);
  }

 private:
  [[nodiscard]] const std::int32_t* rows(std::ptrdiff_t s) const {
    return part_.row + part_.row_begin[s];
  }
  [[nodiscard]] std::ptrdiff_t row_count(std::ptrdiff_t s) const {
    return part_.row_begin[s + 1] - part_.row_begin[s];
  }
  [[nodiscard]] std::ptrdiff_t columns(std::ptrdiff_t s) const {
    return part_.begin[s + 1] - part_.begin[s];
  }
  [[nodiscard]] std::ptrdiff_t loads() const {
    return static_cast<std::ptrdiff_t>(load_.size());
  }

  // Those that act on the supernode's own unknowns, and those that its children hand
  // on.
  void choose_loads(std::ptrdiff_t s) {
    load_.clear();
    own_begin_ = own_end_;
    while (own_end_ < all_.entry.size() &&
           all_.entry[own_end_].row < part_.begin[s + 1]) {
      load_.push_back(all_.entry[own_end_++].load);
    }
    std::sort(load_.begin(), load_.end());
    load_.erase(std::unique(load_.begin(), load_.end()), load_.end());
    std::vector<std::int32_t> both;
    for (const Front& front : handed_on_[at(s)]) {
      both.clear();
      std::set_union(load_.begin(), load_.end(), front.load.begin(), front.load.end(),
                     std::back_inserter(both));
      load_.swap(both);
    }
    column_.clear();
    for (std::size_t i = 0; i < load_.size(); ++i) {
      place_[at(load_[i])] = static_cast<std::int32_t>(i);
      column_.push_back(all_.column[at(load_[i])]);
    }
    ld_ = kernels_.product_rows(loads());
  }

  void assemble(std::ptrdiff_t s) {
    // The front holds loads by rows of the supernode: the loads' own entries, and what
    // the children's fronts have left.
    std::fill_n(front_.get(), ld_ * row_count(s), 0.0);
    for (std::size_t e = own_begin_; e < own_end_; ++e) {
      const Entry& entry = all_.entry[e];
      front_[at(place_[at(entry.load)] + (entry.row - part_.begin[s]) * ld_)] =
          entry.value;
    }
    for (std::ptrdiff_t i = 0; i < row_count(s); ++i) {
      local_[at(rows(s)[i])] = static_cast<std::int32_t>(i);
    }
    for (const Front& from : handed_on_[at(s)]) {
      const double* number = from.number.data();
      for (const std::int32_t row : from.row) {
        double* const to = front_.get() + local_[at(row)] * ld_;
        for (const std::int32_t load : from.load) {
          to[place_[at(load)]] += *number++;
        }
      }
    }
    handed_on_[at(s)] = {};
  }

  [[nodiscard]] std::ptrdiff_t begun_before(std::ptrdiff_t row) const {
    return std::partition_point(load_.begin(), load_.end(),
                                [&](std::int32_t load) {
                                  return all_.first[at(load)] < row;
                                }) -
           load_.begin();
  }

  [[nodiscard]] double* work(std::ptrdiff_t doubles) {
    work_.resize(std::max(work_.size(), at(doubles)));
    return work_.data();
  }

  // The front's own columns become Y'; those below lose what is eliminated.
  void eliminate(std::ptrdiff_t s) {
    const std::ptrdiff_t m = row_count(s);
    double* const space = work(kernels_.product_work(loads(), m, kColumnBlock));
    for (std::ptrdiff_t first = 0; first < columns(s); first += kColumnBlock) {
      const std::ptrdiff_t k = std::min(kColumnBlock, columns(s) - first);
      kernels_.eliminate(begun_before(part_.begin[s] + first + k), m - first, k,
                         part_.number[s] + first * (m + 1), m,
                         front_.get() + first * ld_, ld_, space);
    }
  }

  void add_products(std::ptrdiff_t s) {
    strip_.resize(std::max(strip_.size(), at(ld_ * kStrip)));
    double* const space = work(kernels_.product_work(loads(), kStrip, columns(s)));
    for (std::ptrdiff_t j = 0; j < loads(); j += kStrip) {
      const std::ptrdiff_t n = std::min(kStrip, loads() - j);
      // What a load adds to those before it begins where it does.
      const std::ptrdiff_t zeros = std::clamp<std::ptrdiff_t>(
          all_.first[at(load_[at(j)])] - part_.begin[s], 0, columns(s));
      const double* const Y = front_.get() + zeros * ld_;
      kernels_.product(j + n, n, columns(s) - zeros, Y, ld_, Y + j, ld_, strip_.data(),
                       ld_, false, space);
      for (std::ptrdiff_t c = j; c < j + n; ++c) {
        double* const to = C_.col(column_[at(c)]).data();
        const double* const from = strip_.data() + (c - j) * ld_;
        for (std::ptrdiff_t i = 0; i <= c; ++i) {
          to[column_[at(i)]] += from[i];
        }
      }
    }
  }

  void hand_on(std::ptrdiff_t s) {
    const std::ptrdiff_t k = columns(s);
    if (k == row_count(s)) {
      return;
    }
    Front front{
        .load = load_, .row = {rows(s) + k, rows(s) + row_count(s)}, .number = {}};
    front.number.reserve(front.load.size() * front.row.size());
    for (std::ptrdiff_t i = k; i < row_count(s); ++i) {
      const double* const from = front_.get() + i * ld_;
      front.number.insert(front.number.end(), from, from + loads());
    }
    const auto parent =
        std::upper_bound(part_.begin, part_.begin + part_.count, front.row.front()) -
        part_.begin - 1;
    handed_on_[at(parent)].push_back(std::move(front));
  }

  const FactorKernels& kernels_ = factor_kernels();
  SupernodeView part_;
  SortedLoads all_;
  std::vector<std::vector<Front>> handed_on_;  // to each supernode, by its children
  std::vector<std::int32_t> local_;            // rows within a supernode
  std::vector<std::int32_t> place_;            // loads within it

  // Of the supernode that is eliminated.
  std::vector<std::int32_t> load_;    // ascending
  std::vector<Eigen::Index> column_;  // of A, of each
  std::size_t own_begin_ = 0;         // its entries
  std::size_t own_end_ = 0;
  std::ptrdiff_t ld_ = 0;
  ReusedDoubles front_;  // (loads x rows)
  std::vector<double> strip_, work_;

  Eigen::MatrixXd C_;  // Y'Y, each pair on one side of the diagonal
};

}  // namespace

Eigen::MatrixXd load_compliance(const FactorPart& part, const LoadColumns& A) {
  return Elimination(part.supernodes(), A).run();
}

}  // namespace palpate

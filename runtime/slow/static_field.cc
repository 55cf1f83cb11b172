#include "runtime/slow/static_field.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/on_threads.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"

namespace palpate {
namespace {

// A thread of its own is worth while for so many positions.
constexpr Eigen::Index kRowsAThread = 1024;
constexpr std::size_t kRowsAtOnce = 4096;  // that a thread takes next

using Row = std::size_t;

void store_or_throw(ElementCache& cache, const ElementStream& stream,
                    std::int32_t triangle) {
  if (!store(cache, stream.element(triangle))) {
    throw FormatError(fmt::format("triangle {}: response is malformed", triangle));
  }
}

void check_finite(const Eigen::Ref<const Points>& position_m) {
  for (Eigen::Index i = 0; i < position_m.rows(); ++i) {
    const Eigen::Vector3d x = position_m.row(i);
    if (!x.allFinite()) {
      throw InputError(fmt::format("position {} is ({}, {}, {}), must be finite", i,
                                   x.x(), x.y(), x.z()));
    }
  }
}

// Calls body(begin, end) for parts of [0, count).
template <typename Body>
void in_parts(unsigned threads, std::size_t count, const Body& body) {
  on_threads(threads, (count + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::size_t part) {
    body(part * kRowsAtOnce, std::min(count, (part + 1) * kRowsAtOnce));
  });
}

// Rows in the order of their keys, each in [-1, keys); those of -1 are left out.
std::vector<Row> by_key(const std::vector<std::int32_t>& key, std::size_t keys,
                        const std::vector<Row>& rows) {
  std::vector<Row> begin(keys + 1, 0);
  for (const std::int32_t k : key) {
    begin[static_cast<std::size_t>(k) + 1] += k >= 0 ? 1 : 0;  // of -1: the first
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Row> sorted(begin.back());
  for (const Row row : rows) {
    if (key[row] >= 0) {
      sorted[begin[static_cast<std::size_t>(key[row])]++] = row;
    }
  }
  return sorted;
}

// Rows by the cells of a grid: neighbours ask the search nearly the same, which a
// processor answers sooner.
std::vector<Row> by_cell(const Eigen::Ref<const Points>& position_m) {
  std::vector<Row> rows(static_cast<std::size_t>(position_m.rows()));
  std::iota(rows.begin(), rows.end(), Row{0});
  if (rows.empty()) {
    return rows;
  }
  const int cells = static_cast<int>(
      std::clamp(std::cbrt(static_cast<double>(rows.size()) / 8.0), 1.0, 32.0));
  const Eigen::RowVector3d low = position_m.colwise().minCoeff();
  const double size = (position_m.colwise().maxCoeff() - low).maxCoeff();
  const double scale = size > 0.0 ? cells / size : 0.0;
  std::vector<std::int32_t> key(rows.size());
  for (const Row row : rows) {
    const Eigen::RowVector3d at =
        (position_m.row(static_cast<Eigen::Index>(row)) - low) * scale;
    std::int32_t place = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      place = place * cells + std::min(static_cast<int>(at(axis)), cells - 1);
    }
    key[row] = place;
  }
  const auto side = static_cast<std::size_t>(cells);
  return by_key(key, side * side * side, rows);
}

const ResponseTable& not_yielding(const ResponseTable& table) {
  if (!table.viscoelasticity.yielding.empty()) {
    throw InputError(
        fmt::format("tool '{}': the body yields, so that its force depends on what was "
                    "pressed before; render it instead",
                    table.tool.name));
  }
  return table;
}

}  // namespace

StaticField::StaticField(const ResponseDatabase& database, const ResponseTable& table,
                         FieldKind kind)
    : stream_(database, not_yielding(table)),
      radius_m_(nominal_height_m(table.tool)),
      kind_(kind) {}

// The field at places that have a nearest triangle in common: its neighbourhood is
// collected once, and where a place is over the triangle itself not at all.
class StaticField::Place {
 public:
  explicit Place(const StaticField& field)
      : field_(field), cache_(std::make_unique<ElementCache>()) {}

  [[nodiscard]] Eigen::Vector3d force_n(std::int32_t triangle,
                                        const Eigen::Vector3d& x) {
    if (triangle != active_) {
      enter(triangle, x);
    }
    // Over the triangle itself adopt() ends where it begins.
    if (field_.kind_ == FieldKind::kSmooth && follow_within(over_, x) &&
        !over_.outside) {
      return response_n(over_);
    }
    if (!whole_) {
      collect_neighbours();
    }
    FieldPlace place;
    adopt(place, *cache_, slot_, x, field_.kind_);
    return response_n(place);
  }

 private:
  void enter(std::int32_t triangle, const Eigen::Vector3d& x) {
    active_ = triangle;
    whole_ = false;
    pieces_ = {};
    cache_->received = 0;
    cache_->stored_at.fill(0);
    store_or_throw(*cache_, field_.stream_, triangle);
    slot_ = find(*cache_, triangle);
    adopt(over_, *cache_, slot_, x, field_.kind_);
  }

  // The elements that the slow process sends with the active one.
  void collect_neighbours() {
    const WantedTriangles wanted =
        wanted_triangles(field_.stream_.search(), active_, -1);
    for (std::size_t i = 1; i < wanted.count; ++i) {
      store_or_throw(*cache_, field_.stream_, wanted.triangle[i]);
    }
    whole_ = true;
  }

  [[nodiscard]] Eigen::Vector3d response_n(const FieldPlace& place) {
    return respond(place, *cache_, field_.radius_m_, 0.0, pieces_).force_n;
  }

  const StaticField& field_;
  std::unique_ptr<ElementCache> cache_;
  std::int32_t active_ = -1;
  int slot_ = -1;
  bool whole_ = false;  // the neighbours are there, too
  FieldPlace over_;     // within the active triangle
  CurvePieces pieces_;
};

Points StaticField::force_n(const Eigen::Ref<const Points>& position_m) const {
  Points force(position_m.rows(), 3);
  force_n(position_m, force, 1);
  return force;
}

void StaticField::force_n(const Eigen::Ref<const Points>& position_m,
                          Eigen::Ref<Points> into_n, unsigned threads) const {
  check_finite(position_m);
  const Eigen::Index most = 1 + position_m.rows() / kRowsAThread;
  threads = static_cast<unsigned>(
      std::min(static_cast<Eigen::Index>(thread_count(threads)), most));
  const std::vector<Row> near = by_cell(position_m);
  std::vector<std::int32_t> triangle(near.size());
  in_parts(threads, near.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<Eigen::Index>(near[i]);
      triangle[near[i]] = stream_.search().nearest(position_m.row(row)).triangle;
    }
  });
  const std::vector<Row> order = by_key(
      triangle, static_cast<std::size_t>(stream_.search().neighbours().rows()), near);
  if (order.size() < triangle.size()) {
    into_n.setZero();  // a body without triangles
  }
  in_parts(threads, order.size(), [&](std::size_t begin, std::size_t end) {
    Place place(*this);
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<Eigen::Index>(order[i]);
      into_n.row(row) =
          place.force_n(triangle[order[i]], position_m.row(row)).transpose();
    }
  });
}

Points stored_forces(const ResponseDatabase& database, std::size_t tool,
                     const Points& position_m) {
  return StaticField(database, database.tools.at(tool)).force_n(position_m);
}

}  // namespace palpate

#include "runtime/slow/field_stiffness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/slow/over_element.h"

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kApartM = 2e-7;  // of two forces whose difference is taken
constexpr std::int32_t kFirstElements = 16'384;  // that are looked at, evenly
constexpr std::size_t kClosely = 128;            // elements that are looked at closely
constexpr int kPlaces = 48;                      // in each of them
constexpr std::size_t kClimbs = 16;  // places from which the way up is followed

// Shares of two corners where every element is looked at.
constexpr std::array<std::pair<double, double>, 4> kFirst{
    {{1.0 / 3.0, 1.0 / 3.0}, {0.7, 0.15}, {0.15, 0.7}, {0.15, 0.15}}};

// A place over an element: shares of two corners, of the normal, and the depth over the
// largest one.
using Spot = Vector3d;

struct Found {
  double n_per_m = 0.0;
  std::int32_t triangle = -1;
  Spot spot = Spot::Zero();

  [[nodiscard]] bool operator<(const Found& other) const {
    return n_per_m > other.n_per_m;
  }
};

std::ptrdiff_t responding(const Element& element) {
  return std::count_if(element.node.begin(), element.node.end(),
                       [](const ElementNode& node) {
                         return node.samples > 0;
                       });
}

class Curvature {
 public:
  Curvature(const ResponseDatabase& database, const ResponseTable& table)
      : stream_(database, table),
        radius_m_(nominal_height_m(table.tool)),
        depth_max_m_(table.depth_max_m()),
        cache_(std::make_unique<ElementCache>()) {}

  // @returns how many of its nodes respond.
  std::ptrdiff_t take(std::int32_t triangle) {
    element_ = stream_.element(triangle);
    const std::ptrdiff_t nodes = responding(element_);
    if (nodes > 0) {
      *cache_ = {};
      store(*cache_, element_);
      slot_ = find(*cache_, triangle);
      pieces_ = {};
    }
    return nodes;
  }

  // The largest eigenvalue at a spot; 0 where the field is not sound.
  [[nodiscard]] double at(const Spot& spot) {
    const Vector3d share(spot(0), spot(1), 1.0 - spot(0) - spot(1));
    if (!(share.minCoeff() > 0.0 && spot(2) > 0.0 && spot(2) <= 1.0)) {
      return 0.0;
    }
    const OverElement over = over_element(element_, share);
    if (over.normal.isZero()) {
      return 0.0;
    }
    const Vector3d x = over.at(radius_m_ - spot(2) * depth_max_m_);
    adopt(place_, *cache_, slot_, x);
    Matrix3d hessian;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d half = 0.5 * kApartM * Vector3d::Unit(axis);
      Vector3d before;
      Vector3d after;
      if (!force(x - half, before) || !force(x + half, after)) {
        return 0.0;
      }
      hessian.col(axis) = (before - after) / kApartM;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(
        0.5 * (hessian + hessian.transpose()), Eigen::EigenvaluesOnly);
    return solver.eigenvalues()(2);
  }

 private:
  bool force(const Vector3d& x, Vector3d& force_n) {
    if (!follow_within(place_, x) || place_.folded || place_.outside) {
      return false;
    }
    force_n = respond(place_, *cache_, radius_m_, 0.0, pieces_).force_n;
    return true;
  }

  ElementStream stream_;
  double radius_m_;
  double depth_max_m_;
  std::unique_ptr<ElementCache> cache_;
  Element element_;
  int slot_ = -1;
  FieldPlace place_;
  CurvePieces pieces_;
};

// The i-th of places that fill an element and its depths evenly (Roberts' sequence in
// three dimensions).
Spot spot_of(int i) {
  constexpr double kRatio = 1.2207440846057596;  // x^4 = x + 1
  const auto fraction = [](double x) {
    return x - std::floor(x);
  };
  const double a = fraction(0.5 + i / kRatio);
  const double b = fraction(0.5 + i / (kRatio * kRatio));
  const double depth = fraction(0.5 + i / (kRatio * kRatio * kRatio));
  return {a + b > 1.0 ? 1.0 - a : a, a + b > 1.0 ? 1.0 - b : b, 1.0 - 0.7 * depth};
}

// Keeps the `count` largest.
void keep_largest(std::vector<Found>& found, std::size_t count) {
  const std::size_t kept = std::min(count, found.size());
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept),
                    found.end());
  found.resize(kept);
}

// Up by steps along the coordinates, halved where none leads up.
double climbed(Curvature& curvature, Found from) {
  for (double step = 0.1; step > 1e-3;) {
    Found best = from;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {-step, step}) {
        Spot spot = from.spot + way * Spot::Unit(axis);
        spot(2) = std::min(spot(2), 1.0);
        const double n_per_m = curvature.at(spot);
        if (n_per_m > best.n_per_m) {
          best.n_per_m = n_per_m;
          best.spot = spot;
        }
      }
    }
    step *= best.n_per_m > from.n_per_m ? 1.0 : 0.5;
    from = best;
  }
  return from.n_per_m;
}

// The most that is found from here on. @param found of every element the most.
double largest_from(Curvature& curvature, std::vector<Found> found) {
  keep_largest(found, kClosely);
  std::vector<Found> closer = found;
  for (const Found& element : found) {
    (void)curvature.take(element.triangle);
    for (int i = 0; i < kPlaces; ++i) {
      const Spot spot = spot_of(i);
      closer.push_back({curvature.at(spot), element.triangle, spot});
    }
  }
  keep_largest(closer, kClimbs);
  double largest = 0.0;
  for (const Found& start : closer) {
    (void)curvature.take(start.triangle);
    largest = std::max(largest, climbed(curvature, start));
  }
  return largest;
}

}  // namespace

FieldStiffening field_stiffening(const ResponseDatabase& database,
                                 const ResponseTable& table) {
  const auto steepest = std::max_element(table.stiffness_max_n_per_m.begin(),
                                         table.stiffness_max_n_per_m.end());
  if (steepest == table.stiffness_max_n_per_m.end() || !(*steepest > 0.0)) {
    return {};
  }
  Curvature curvature(database, table);
  std::vector<Found> inside;
  std::vector<Found> border;
  const auto triangles = static_cast<std::int32_t>(database.body.triangle.rows());
  // Every element, or every so many, at four places at the largest depth.
  for (std::int32_t t = 0; t < triangles; t += 1 + triangles / kFirstElements) {
    const std::ptrdiff_t nodes = curvature.take(t);
    if (nodes > 0) {
      Found most{0.0, t, Spot::Zero()};
      for (const auto& [a, b] : kFirst) {
        const Spot spot(a, b, 1.0);
        const double n_per_m = curvature.at(spot);
        most = n_per_m > most.n_per_m ? Found{n_per_m, t, spot} : most;
      }
      // An element with a silent node lies at the border of the reach.
      (nodes == 3 ? inside : border).push_back(most);
    }
  }
  return {std::max(1.0, largest_from(curvature, std::move(inside)) / *steepest),
          std::max(1.0, largest_from(curvature, std::move(border)) / *steepest)};
}

RenderedStiffness model_stiffness(const ResponseDatabase& database,
                                  const ResponseTable& table, LocalModel model,
                                  double force_max_n) {
  RenderedStiffness stiffness = rendered_stiffness(table, force_max_n);
  if (model == LocalModel::kPotential) {
    const FieldStiffening field = field_stiffening(database, table);
    stiffness.border_n_per_m = field.border * stiffness.normal_n_per_m;
    stiffness.normal_n_per_m *= field.inside;
  }
  return stiffness;
}

}  // namespace palpate

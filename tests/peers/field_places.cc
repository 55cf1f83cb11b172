#include "tests/peers/field_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/response/force_difference.h"
#include "formats/response/tool_support.h"
#include "runtime/slow/static_field.h"

namespace palpate::peers {
namespace {

using Eigen::Vector3d;

constexpr std::array<double, 5> kShares{0.2, 0.4, 0.6, 0.8, 1.0};
constexpr int kCoverageDepths = 19;  // from a tenth of the depth to all

struct Spot {
  std::array<std::int32_t, 3> node{};
  Vector3d share;
  PlacedDepth press;
};

std::vector<Spot> drawn(const ResponseDatabase& database, const ResponseTable& table,
                        double depth_m, const PlacesOptions& options) {
  const Points& position = database.body.position_m;
  std::vector<std::int32_t> open;
  std::vector<double> area;
  for (std::int32_t t = 0; t < database.body.triangle.rows(); ++t) {
    const auto corner = database.body.triangle.row(t);
    bool all = true;
    for (int j = 0; j < 3; ++j) {
      all = all && !table.curve(corner(j)).depth_m.empty();
    }
    if (all) {
      const Vector3d a = position.row(corner(1)) - position.row(corner(0));
      const Vector3d b = position.row(corner(2)) - position.row(corner(0));
      open.push_back(t);
      area.push_back(a.cross(b).norm());
    }
  }
  if (open.empty()) {
    throw InputError("no element responds at all of its nodes");
  }
  std::mt19937_64 random(options.seed);
  std::discrete_distribution<std::size_t> any(area.begin(), area.end());
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::vector<Spot> spots;
  for (int i = 0; i < options.places; ++i) {
    const auto corner = database.body.triangle.row(open[any(random)]);
    const double a = std::sqrt(part(random));
    const double b = part(random);
    Spot spot{.node = {corner(0), corner(1), corner(2)},
              .share = {1.0 - a, a * (1.0 - b), a * b},
              .press = {.depth_m = depth_m}};
    Vector3d normal = Vector3d::Zero();
    for (int j = 0; j < 3; ++j) {
      spot.press.at_m += spot.share(j) * position.row(corner(j)).transpose();
      normal += spot.share(j) * database.normal.row(corner(j)).transpose();
    }
    spot.press.outward = normal.normalized();
    spots.push_back(spot);
  }
  return spots;
}

double at_share(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0
                        : values[static_cast<std::size_t>(
                              share * static_cast<double>(values.size() - 1))];
}

// What was pressed, to judge fields by.
struct Truth {
  double depth_m = 0.0;
  std::vector<Spot> spot;
  std::vector<TrueCurve> curve;
};

Truth pressed(const Scene& scene, const ResponseDatabase& database,
              const PlacesOptions& options) {
  const ResponseTable& table = find_tool(database, scene.tool.front().name);
  Truth truth{.depth_m = scene.reach.depth_max_m,
              .spot = drawn(database, table, scene.reach.depth_max_m, options),
              .curve = {}};
  std::vector<PlacedDepth> presses;
  for (const Spot& spot : truth.spot) {
    presses.push_back(spot.press);
  }
  truth.curve = true_curves(scene, read_body(scene), presses, options.times_finer);
  return truth;
}

class Places {
 public:
  Places(const Truth& truth, const ResponseDatabase& database,
         const ResponseTable& table, std::string rows)
      : database_(database),
        table_(table),
        rows_(std::move(rows)),
        depth_m_(truth.depth_m),
        spots_(truth.spot),
        truth_(truth.curve) {}

  PlacesReport report() {
    PlacesReport report;
    for (const TrueCurve& curve : truth_) {
      curve.failure.empty() ? ++report.places : ++report.failed;
    }
    for (const FieldKind kind : {FieldKind::kFacets, FieldKind::kSmooth}) {
      const StaticField field(database_, table_, kind);
      for (const double share : kShares) {
        report.row.push_back(row_at(field, kind, share));
      }
      report.coverage.push_back(coverage_of(field, kind));
    }
    return report;
  }

 private:
  [[nodiscard]] Points forces(const StaticField& field, double depth_m) const {
    Points x(static_cast<Eigen::Index>(spots_.size()), 3);
    const double radius_m = nominal_height_m(table_.tool);
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      const PlacedDepth& press = spots_[i].press;
      x.row(static_cast<Eigen::Index>(i)) =
          (press.at_m + (radius_m - depth_m) * press.outward).transpose();
    }
    return field.force_n(x);
  }

  [[nodiscard]] PlacesRow row_at(const StaticField& field, FieldKind kind,
                                 double share) const {
    const double depth_m = share * depth_m_;
    const Points force = forces(field, depth_m);
    PlacesRow row{.kind = kind, .depth_share = share};
    std::vector<double> off;
    double mean_n = 0.0;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      if (!truth_[i].failure.empty()) {
        continue;
      }
      const Vector3d& n = spots_[i].press.outward;
      const Vector3d truth = truth_[i].at(depth_m);
      const Vector3d d = force.row(static_cast<Eigen::Index>(i)).transpose() - truth;
      off.push_back(d.norm());
      mean_n += truth.norm();
      row.mean += d.norm();
      row.normal += std::abs(d.dot(n));
      row.bias += d.dot(n);
      row.sideways += (d - d.dot(n) * n).norm();
    }
    for (double* sum : {&row.mean, &row.normal, &row.bias, &row.sideways}) {
      *sum /= mean_n;
    }
    const double per = static_cast<double>(off.size()) / mean_n;
    row.p95 = per * at_share(off, 0.95);
    row.largest = per * at_share(off, 1.0);
    return row;
  }

  [[nodiscard]] PlacesCoverage coverage_of(const StaticField& field,
                                           FieldKind kind) const {
    std::vector<double> found(spots_.size(), 0.0);
    Eigen::MatrixXd by_depth =
        Eigen::MatrixXd::Zero(std::ssize(spots_), kCoverageDepths);
    for (int k = 0; k < kCoverageDepths; ++k) {
      const double share =
          kErrorCountsFrom + (1.0 - kErrorCountsFrom) * k / (kCoverageDepths - 1);
      const Points force = forces(field, share * depth_m_);
      for (std::size_t i = 0; i < spots_.size(); ++i) {
        if (truth_[i].failure.empty()) {
          const Vector3d truth = truth_[i].at(share * depth_m_);
          const double least_n = kErrorCountsFrom * truth_[i].at(depth_m_).norm();
          const double off_n =
              (force.row(static_cast<Eigen::Index>(i)).transpose() - truth).norm();
          by_depth(static_cast<Eigen::Index>(i), k) =
              off_n / std::max(truth.norm(), least_n);
          found[i] = by_depth.row(static_cast<Eigen::Index>(i)).maxCoeff();
        }
      }
    }
    PlacesCoverage coverage{.kind = kind};
    std::vector<double> stated;
    std::vector<double> pressed;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      if (!truth_[i].failure.empty()) {
        continue;
      }
      double blended = 0.0;
      double largest = 0.0;
      for (std::size_t j = 0; j < 3; ++j) {
        const double e =
            table_.error_relative[static_cast<std::size_t>(spots_[i].node[j])];
        blended += spots_[i].share(static_cast<Eigen::Index>(j)) * e;
        largest = std::max(largest, e);
      }
      stated.push_back(blended);
      pressed.push_back(found[i]);
      if (kind == FieldKind::kSmooth && !rows_.empty()) {
        write_row(i, found[i], blended, by_depth.row(static_cast<Eigen::Index>(i)));
      }
      coverage.within_blended += found[i] <= blended ? 1.0 : 0.0;
      coverage.within_largest += found[i] <= largest ? 1.0 : 0.0;
    }
    coverage.within_from = within_from(by_depth);
    coverage.within_blended /= static_cast<double>(stated.size());
    coverage.within_largest /= static_cast<double>(stated.size());
    coverage.stated_median = at_share(stated, 0.5);
    coverage.found_median = at_share(pressed, 0.5);
    coverage.found_p95 = at_share(pressed, 0.95);
    return coverage;
  }

  [[nodiscard]] std::vector<double> within_from(const Eigen::MatrixXd& by_depth) const {
    const AccuracyRecord& accuracy = table_.accuracy;
    std::vector<double> within;
    for (std::size_t k = 0; k < accuracy.depth_share.size(); ++k) {
      const auto first = static_cast<Eigen::Index>(
          std::ceil((accuracy.depth_share[k] - kErrorCountsFrom) /
                        (1.0 - kErrorCountsFrom) * (kCoverageDepths - 1) -
                    1e-9));
      double count = 0.0;
      double all = 0.0;
      for (std::size_t i = 0; i < spots_.size(); ++i) {
        if (truth_[i].failure.empty()) {
          const double found = by_depth.row(static_cast<Eigen::Index>(i))
                                   .tail(kCoverageDepths - first)
                                   .maxCoeff();
          count += found <= accuracy.covering_relative[k] ? 1.0 : 0.0;
          all += 1.0;
        }
      }
      within.push_back(count / all);
    }
    return within;
  }

  void write_row(std::size_t i, double found, double stated,
                 const Eigen::RowVectorXd& by_depth) const {
    const Vector3d& at_m = spots_[i].press.at_m;
    std::ofstream(rows_, i == 0 ? std::ios::trunc : std::ios::app)
        << at_m.transpose() << ' ' << found << ' ' << stated << ' ' << by_depth << '\n';
  }

  const ResponseDatabase& database_;
  const ResponseTable& table_;
  const std::string rows_;
  const double depth_m_;
  const std::vector<Spot>& spots_;
  const std::vector<TrueCurve>& truth_;
};

const char* name(FieldKind kind) {
  return kind == FieldKind::kFacets ? "facets" : "potential";
}

}  // namespace

std::vector<PlacesReport> measure_places(const Scene& scene,
                                         std::span<const ResponseDatabase> databases,
                                         const PlacesOptions& options) {
  const Points& body_m = databases.front().body.position_m;
  for (const ResponseDatabase& database : databases) {
    if (database.body.position_m.rows() != body_m.rows() ||
        database.body.position_m != body_m) {
      throw InputError("the databases are of different bodies, must be of one");
    }
  }
  const Truth truth = pressed(scene, databases.front(), options);
  std::vector<PlacesReport> reports;
  for (const ResponseDatabase& database : databases) {
    reports.push_back(Places(truth, database,
                             find_tool(database, scene.tool.front().name),
                             reports.empty() ? options.rows : "")
                          .report());
  }
  return reports;
}

std::string table_text(const PlacesReport& report) {
  std::string text = fmt::format(
      "{} places, {} could not be pressed; |dF| over the mean true force [%]\n"
      "{:<10} {:>6} {:>7} {:>7} {:>8} {:>7} {:>7} {:>9}\n",
      report.places, report.failed, "model", "depth", "mean", "p95", "largest",
      "normal", "bias", "sideways");
  for (const PlacesRow& r : report.row) {
    text += fmt::format(
        "{:<10} {:>6.1f} {:>7.2f} {:>7.2f} {:>8.2f} {:>7.2f} {:>+7.2f} {:>9.2f}\n",
        name(r.kind), r.depth_share, 100.0 * r.mean, 100.0 * r.p95, 100.0 * r.largest,
        100.0 * r.normal, 100.0 * r.bias, 100.0 * r.sideways);
  }
  for (const PlacesCoverage& c : report.coverage) {
    text += fmt::format(
        "{}: stated {:.2f} % in the median, found {:.2f} %, at the 95th percentile "
        "{:.2f} %; within the nodes' blended {:.3f} of places, within their largest "
        "{:.3f}\n",
        name(c.kind), 100.0 * c.stated_median, 100.0 * c.found_median,
        100.0 * c.found_p95, c.within_blended, c.within_largest);
    if (!c.within_from.empty()) {
      text += fmt::format("  within what the file says by depth: {:.3f}\n",
                          fmt::join(c.within_from, ", "));
    }
  }
  return text;
}

}  // namespace palpate::peers

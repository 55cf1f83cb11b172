#include "tests/bench/runtime/bench_signs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tilt_line.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/slow/over_element.h"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Uniform = std::uniform_real_distribution<double>;

constexpr double kPull = 1e-6;  // of the largest force

class SignsHunt {
 public:
  SignsHunt(const ResponseDatabase& database, const ResponseTable& table, unsigned seed)
      : stream_(database, table),
        radius_m_(nominal_height_m(table.tool)),
        depth_max_m_(table.depth_max_m()),
        random_(seed) {
    for (std::size_t k = 0; k < table.force_n.size(); ++k) {
      force_max_n_ = std::max(force_max_n_, std::abs(table.force_n[k]));
    }
  }

  void hunt(std::int32_t triangle, std::int64_t places) {
    const Element element = stream_.element(triangle);
    if (std::none_of(element.node.begin(), element.node.end(),
                     [](const ElementNode& node) {
                       return node.samples > 0;
                     })) {
      return;
    }
    *cache_ = {};
    store(*cache_, element);
    const int slot = find(*cache_, triangle);
    FieldPlace place;
    pieces_ = {};
    for (std::int64_t i = 0; i < places; ++i) {
      look(element, slot, place);
    }
  }

  SignsBenchReport report;

 private:
  void look(const Element& element, int slot, FieldPlace& place) {
    const OverElement over = over_element(element, shares());
    const Vector3d x = over.at(radius_m_ - depth_max_m_ * part_(random_));
    if (place.slot != slot) {
      adopt(place, *cache_, slot, x);
    }
    if (!follow_within(place, x) || place.folded || place.outside) {
      ++report.unsound;
      place.slot = -1;
      return;
    }
    const FieldResponse at = respond(place, *cache_, radius_m_, 0.0, pieces_);
    if (!at.touching) {
      return;
    }
    ++report.places;
    report.negative += at.energy_j < 0.0 ? 1 : 0;
    report.lowest_j = std::min(report.lowest_j, at.energy_j);
    const double pull_n = -at.force_n.dot(over.normal);
    report.pulls += pull_n > kPull * force_max_n_ ? 1 : 0;
    report.worst_pull_n = std::max(report.worst_pull_n, pull_n);
  }

  Vector3d shares() {
    const double a = std::sqrt(part_(random_));
    const double c = part_(random_);
    Vector3d b(1.0 - a, a * (1.0 - c), a * c);
    const double where = part_(random_);
    const auto corner = static_cast<Eigen::Index>(3.0 * part_(random_)) % 3;
    if (where < 0.25) {  // near an edge
      b(corner) *= 0.01;
    } else if (where < 0.5) {  // near a corner
      b((corner + 1) % 3) *= 0.01;
      b((corner + 2) % 3) *= 0.01;
    }
    return b / b.sum();
  }

  ElementStream stream_;
  double radius_m_;
  double depth_max_m_;
  double force_max_n_ = 0.0;
  std::unique_ptr<ElementCache> cache_ = std::make_unique<ElementCache>();
  CurvePieces pieces_;
  std::mt19937_64 random_;
  Uniform part_{0.0, 1.0};
};

}  // namespace

namespace {

// Forces that rise by steps as they like, a first touch up to a tenth of the
// depth early or late, a tilt that turns with depth; within a database's rules.
void give_own_curve(NodeResponse& response, const Vector3d& normal, double edge_m,
                    std::mt19937_64& random) {
  Uniform part(-1.0, 1.0);
  const double mean_n = response.force_n.back();
  for (std::size_t k = 1; k < response.force_n.size(); ++k) {
    response.force_n[k] =
        response.force_n[k - 1] + mean_n * std::max(0.0, 0.1 + part(random));
  }
  const double depth_m = response.depth_m.back();
  response.touch_offset_m = 0.1 * depth_m * part(random);
  const auto across = [&](double length) -> Vector3d {
    const Vector3d any(part(random), part(random), part(random));
    return length * (any - any.dot(normal) * normal);
  };
  response.tilt = TiltLine{.tilt = across(1.0), .by_depth_per_m = across(1.0 / edge_m)};
  limit_tilt(response, normal, edge_m);
}

}  // namespace

void make_discordant(ResponseDatabase& database, ResponseTable& table,
                     double log_factor, double lean_rad, double silent_share,
                     std::uint64_t seed, bool own_curves) {
  std::mt19937_64 random(seed);
  Uniform part(-1.0, 1.0);
  std::vector<NodeResponse> responses;
  const std::vector<double> longest_m = longest_edges_m(database.body);
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    NodeResponse response;
    const CurveView curve = table.curve(i);
    const double factor = std::exp(log_factor * part(random));
    const Vector3d normal = database.normal.row(i).transpose();
    const Vector3d across =
        normal.cross(Vector3d(part(random), part(random), part(random))).normalized();
    const double lean = lean_rad * std::abs(part(random));
    if (!curve.depth_m.empty() && std::abs(part(random)) >= silent_share) {
      response.origin = ResponseOrigin::kSimulated;
      response.direction = std::cos(lean) * normal + std::sin(lean) * across;
      response.touch_offset_m = table.touch_offset_m[static_cast<std::size_t>(i)];
      response.depth_m.assign(curve.depth_m.begin(), curve.depth_m.end());
      for (const double force_n : curve.force_n) {
        response.force_n.push_back(factor * force_n);
      }
      if (own_curves) {
        give_own_curve(response, normal, longest_m[static_cast<std::size_t>(i)],
                       random);
      }
    }
    responses.push_back(std::move(response));
  }
  table = make_table(table.tool, responses);
}

namespace {

// Bodies of one surface, each with data of its own.
SignsBenchReport hunt_many(const ResponseDatabase& database, const std::string& tool,
                           const SignsBenchOptions& options) {
  constexpr double kLeanRad = 0.7;
  SignsBenchReport all;
  for (std::int64_t i = 0; i < options.databases; ++i) {
    ResponseDatabase own = database;
    const std::string name = find_tool(own, tool).tool.name;
    for (ResponseTable& table : own.tools) {
      if (table.tool.name == name) {
        make_discordant(own, table, options.discord, kLeanRad, 0.1,
                        options.seed + static_cast<std::uint64_t>(i), true);
      }
    }
    check(own);
    const SignsBenchReport one =
        run_signs_bench(std::move(own), tool,
                        {.places = options.places / options.databases,
                         .seed = options.seed + static_cast<unsigned>(i)});
    all.places += one.places;
    all.unsound += one.unsound;
    all.negative += one.negative;
    all.pulls += one.pulls;
    all.lowest_j = std::min(all.lowest_j, one.lowest_j);
    all.worst_pull_n = std::max(all.worst_pull_n, one.worst_pull_n);
  }
  return all;
}

}  // namespace

SignsBenchReport run_signs_bench(ResponseDatabase database, const std::string& tool,
                                 const SignsBenchOptions& options) {
  if (options.places < 1 || !(options.discord >= 0.0) || options.databases < 1 ||
      options.databases > options.places) {
    throw InputError(
        "bench signs: places from 1, discord from 0, databases from 1 to places");
  }
  if (options.databases > 1) {
    return hunt_many(database, tool, options);
  }
  const std::string name = find_tool(database, tool).tool.name;
  const auto table = std::find_if(database.tools.begin(), database.tools.end(),
                                  [&](const ResponseTable& each) {
                                    return each.tool.name == name;
                                  });
  if (options.discord > 0.0) {
    constexpr double kLeanRad = 0.7853981633974483;
    make_discordant(database, *table, options.discord, kLeanRad, 0.1, options.seed);
  }
  std::vector<std::int32_t> open;
  for (std::int32_t t = 0; t < database.body.triangle.rows(); ++t) {
    const auto corner = database.body.triangle.row(t);
    const bool responds = !table->curve(corner(0)).depth_m.empty() ||
                          !table->curve(corner(1)).depth_m.empty() ||
                          !table->curve(corner(2)).depth_m.empty();
    if (responds) {
      open.push_back(t);
    }
  }
  SignsHunt hunt(database, *table, options.seed);
  const auto count = static_cast<std::int64_t>(open.size());
  for (std::int64_t i = 0; i < count; ++i) {
    hunt.hunt(open[static_cast<std::size_t>(i)],
              options.places * (i + 1) / count - options.places * i / count);
  }
  return hunt.report;
}

std::string table_text(const SignsBenchReport& report) {
  return fmt::format(
      "{} places in contact, {} without coordinates: {} with energy below zero (lowest "
      "{:.3g} J), {} that pull (most {:.3g} N)\n",
      report.places, report.unsound, report.negative, report.lowest_j, report.pulls,
      report.worst_pull_n);
}

}  // namespace palpate

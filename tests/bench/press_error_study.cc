// What the mesh adds to the error of a press: single vertices of a scene, pressed on
// the shared mesh and on meshes of their own that are finer and finer.
//
// press_error_study SCENE.toml [VERTICES] [FINEST]   (default: 8 vertices, 4 times)
//
// Forces are compared at equal tool position with those of the finest mesh, in percent
// of the larger of the force there and a tenth of the vertex' largest; "error" is the
// largest from a tenth of the depth on, "estimate" what a build calibrates.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/quantile.h"
#include "formats/base/stopwatch.h"
#include "formats/database/place_check.h"
#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/compliance_sample.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/scene_solver.h"
#include "precompute/press/work_unit_solver.h"

namespace palpate {
namespace {

// |F| at a penetration, between samples along a straight line of the secant's
// stiffness.
double force_at(const Indentation& path, double penetration_m) {
  const auto& sample = path.sample;
  if (sample.size() < 2 || penetration_m <= sample.front().penetration_m) {
    return 0.0;
  }
  for (std::size_t k = 1; k < sample.size(); ++k) {
    if (penetration_m <= sample[k].penetration_m) {
      const double low = sample[k - 1].penetration_m;
      const double t = (penetration_m - low) / (sample[k].penetration_m - low);
      return (1.0 - t) * sample[k - 1].force_n.norm() + t * sample[k].force_n.norm();
    }
  }
  return sample.back().force_n.norm();
}

struct Row {
  std::string name;
  PressedNode node;
  double seconds = 0.0;
};

// What presses on a mesh so many times finer tell of the error of those on a build's.
class CheckRatios {
 public:
  explicit CheckRatios(double times) : times_(times) {}

  void add(const Row& finer, double error, double estimate, double found) {
    seconds_ += finer.seconds;
    error_per_found_.push_back(error / found);
    error_.push_back(error / estimate);
    found_.push_back(found / estimate);
  }

  void say() {
    for (auto* values : {&error_per_found_, &error_, &found_}) {
      std::sort(values->begin(), values->end());
    }
    fmt::print(
        "on meshes {:g} times as fine, {:.1f} s: error over what is found {:.2f} "
        "median, {:.2f} and {:.2f} quartiles; over the estimate, error {:.2f} median, "
        "{:.2f} at the 95th percentile, found {:.2f} and {:.2f}\n",
        times_, seconds_, quantile(error_per_found_, 0.5),
        quantile(error_per_found_, 0.25), quantile(error_per_found_, 0.75),
        quantile(error_, 0.5), quantile(error_, 0.95), quantile(found_, 0.5),
        quantile(found_, 0.95));
  }

 private:
  double times_;
  double seconds_ = 0.0;
  std::vector<double> error_per_found_;
  std::vector<double> error_;
  std::vector<double> found_;
};

int run(const std::string& file, std::size_t count, double finest) {
  const Scene scene = read_scene(file);
  const BodySource body = read_body(scene);
  const auto reachable = reachable_vertices(scene, body);
  const auto vertices = spread_over(reachable, count);
  const PressStrategy strategy = choose_strategy(scene, body, reachable);
  constexpr std::array kAt{0.1, 0.2, 0.33, 0.5, 0.75, 1.0};
  fmt::print(
      "{} reachable, shared mesh {} ({:.3g} mm), growth {:.3g}, finest {:.3g} mm\n",
      reachable.size(), strategy.shared_mesh, 1e3 * strategy.spacing_m,
      strategy.focus.growth, 1e3 * strategy.focus.finest_m);
  Progress quiet(nullptr);
  const SceneSolver solver(scene, body, strategy, reachable, vertices, quiet);
  CheckRatios check{kNonlinearCheckTimesFiner};
  CheckRatios twice{kLinearCheckTimesFiner};
  for (const std::int32_t vertex : vertices) {
    std::vector<Row> rows;
    const auto add = [&](const std::string& name, const auto& press) {
      rows.push_back({name, {}, 0.0});
      rows.back().seconds = seconds_of([&] {
        rows.back().node = press();
      });
    };
    add("shared", [&] {
      return solver.linear(body.tool[0], {&vertex, 1}).front();
    });
    for (const double times :
         {0.5, 1.0, kNonlinearCheckTimesFiner, kLinearCheckTimesFiner, finest}) {
      add(fmt::format("own x{:g}", times), [&] {
        return solver.reference(body.tool[0], vertex, {}, times);
      });
    }
    const Indentation& reference = rows.back().node.indentation;
    const double depth = scene.reach.depth_max_m;
    const double largest = force_at(reference, depth);
    fmt::print("vertex {}: {:.4g} N, touch {:.3f} mm\n", vertex, largest,
               1e3 * reference.sample.front().penetration_m);
    const auto response_of = [&](const Row& row) {
      return to_response(row.node.indentation, row.node.path, scene.force_relative);
    };
    const NodeResponse best =
        to_response(reference, rows.back().node.path, scene.force_relative);
    const Eigen::Vector3d outward = rows.back().node.path.outward;
    for (const Row& row : rows) {
      const auto& path = row.node.indentation;
      fmt::print("  {:<9} {:6.2f} s touch {:+.3f} mm", row.name, row.seconds,
                 path.sample.empty() ? 0.0
                                     : 1e3 * (path.sample.front().penetration_m -
                                              reference.sample.front().penetration_m));
      for (const double at : kAt) {
        const double truth = force_at(reference, at * depth);
        fmt::print(" {:+6.2f}", 100.0 * (force_at(path, at * depth) - truth) /
                                    std::max(truth, 0.1 * largest));
      }
      const NodeResponse response = response_of(row);
      fmt::print("   error {:.2f} estimate {:.2f} {}\n",
                 100.0 * response_difference(response, best, outward),
                 100.0 * response.error_relative, row.node.failure);
    }
    const NodeResponse built = response_of(rows[2]);
    const double error = response_difference(built, best, outward);
    check.add(rows[3], error, built.error_relative,
              response_difference(built, response_of(rows[3]), outward));
    twice.add(rows[4], error, built.error_relative,
              response_difference(built, response_of(rows[4]), outward));
  }
  check.say();
  twice.say();
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: press_error_study SCENE.toml [VERTICES] [FINEST]\n");
    return 2;
  }
  try {
    return palpate::run(argv[1], argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 8,
                        argc > 3 ? std::strtod(argv[3], nullptr) : 4.0);
  } catch (const std::exception& error) {
    fmt::print(stderr, "press_error_study: {}\n", error.what());
    return 1;
  }
}

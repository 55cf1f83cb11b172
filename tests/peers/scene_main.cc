// Makes the benchmark's scenes: surfaces, hands, the truth along them. README.md is its
// page.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include <fmt/format.h>

#include "formats/base/command_line.h"
#include "formats/base/error.h"
#include "formats/base/stopwatch.h"
#include "formats/database/response_database.h"
#include "runtime/bench/cylinder_body.h"
#include "tests/peers/scene_compliance.h"
#include "tests/peers/scene_files.h"
#include "tests/peers/true_forces.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

// Between -kFreeM and the first touch nobody says that there is no force.
constexpr double kFreeM = 5e-4;
// Places whose truth is solved once more, half as fine, to say how far off it is.
constexpr std::size_t kAgain = 4;
constexpr int kTruthDepths = 24;

// Places that hands share are one: to a nanometre.
using PlaceKey = std::array<std::int64_t, 3>;
PlaceKey key(const PlacedDepth& p) {
  PlaceKey k{};
  for (int i = 0; i < 3; ++i) {
    k[static_cast<std::size_t>(i)] = std::llround(1e9 * p.at_m[i]);
  }
  return k;
}

// Every place that needs truth, with the deepest press there.
class TruthPlaces {
 public:
  void want(const PlacedDepth& p) {
    const auto [found, added] = index_.try_emplace(key(p), places_.size());
    if (added) {
      places_.push_back(p);
    } else {
      PlacedDepth& known = places_[found->second];
      known.depth_m = std::max(known.depth_m, p.depth_m);
    }
  }
  [[nodiscard]] const std::vector<PlacedDepth>& places() const { return places_; }
  [[nodiscard]] std::size_t of(const PlacedDepth& p) const { return index_.at(key(p)); }

 private:
  std::map<PlaceKey, std::size_t> index_;
  std::vector<PlacedDepth> places_;
};

double worst_difference(const std::vector<TrueCurve>& fine,
                        const std::vector<TrueCurve>& coarse) {
  double worst = 0.0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    if (fine[i].failure.empty() && coarse[i].failure.empty()) {
      const Eigen::Vector3d& f = fine[i].force_n.back();
      worst = std::max(worst, (coarse[i].force_n.back() - f).norm() / f.norm());
    }
  }
  return worst;
}

struct Solved {
  std::vector<TrueCurve> curve;
  std::string told;  // lines of scene.txt
};

Solved solve(const Scene& scene, const BodySource& body, const TruthPlaces& wanted,
             double times_finer) {
  const auto begin = std::chrono::steady_clock::now();
  Solved solved{true_curves(scene, body, wanted.places(), times_finer), {}};
  const double seconds = seconds_since(begin);
  const std::span<const PlacedDepth> again(wanted.places().data(),
                                           std::min(kAgain, wanted.places().size()));
  const auto coarse = true_curves(scene, body, again, 0.5 * times_finer);
  const auto failed =
      std::count_if(solved.curve.begin(), solved.curve.end(), [](const TrueCurve& c) {
        return !c.failure.empty();
      });
  solved.told = fmt::format(
      "truth_places {}\ntruth_failed {}\ntruth_times_finer {}\ntruth_seconds {:.1f}\n"
      "truth_coarser_differs_relative {:.4f}\n",
      wanted.places().size(), failed, times_finer, seconds,
      worst_difference(solved.curve, coarse));
  return solved;
}

std::vector<ToldHand> told(std::vector<PlannedHand> planned, const TruthPlaces& places,
                           const std::vector<TrueCurve>& curve) {
  std::vector<ToldHand> hands;
  for (PlannedHand& hand : planned) {
    ToldHand one{std::move(hand), {}};
    const auto tell = [&](std::size_t tick, std::vector<PlannedTruth>& to) {
      const PlacedDepth& p = one.planned.tick[tick];
      if (p.depth_m < -kFreeM) {
        to.push_back({tick, p.depth_m, Eigen::Vector3d::Zero()});
      } else if (p.depth_m > 0.0 && curve[places.of(p)].failure.empty()) {
        to.push_back({tick, p.depth_m, curve[places.of(p)].at(p.depth_m)});
      }
    };
    for (const std::size_t tick : one.planned.truth_tick) {
      tell(tick, one.truth);
    }
    for (const std::size_t tick : one.planned.dense_tick) {
      tell(tick, one.dense);
    }
    hands.push_back(std::move(one));
  }
  return hands;
}

SurfaceFrame frame_of(const SurfaceMesh& surface, const SceneRecipe& r) {
  return {surface, r.site_m, r.along};
}

// What a rival needs to know of the material and of where the body is held.
std::string body_lines(const Scene& scene) {
  std::string lines;
  if (const auto& box = scene.support.front().box_m) {
    lines +=
        fmt::format("support_box_m {} {} {} {} {} {}\n", box->min().x(), box->min().y(),
                    box->min().z(), box->max().x(), box->max().y(), box->max().z());
  }
  for (const SceneMaterial& m : scene.material) {
    if (m.region == kBodyRegion) {
      lines += fmt::format("law {}\nyoungs_modulus_pa {}\npoissons_ratio {}\n", m.law,
                           m.youngs_modulus_pa, m.poissons_ratio);
    }
  }
  return lines;
}

Scene scene_with_depths(const fs::path& file) {
  Scene scene = read_scene(file);
  scene.accuracy.depths = kTruthDepths;
  return scene;
}

// A folder with body.toml, body.obj and recipe.txt becomes a scene.
void make(const fs::path& folder) {
  const Scene scene = scene_with_depths(folder / "body.toml");
  const BodySource body = read_body(scene);
  SceneRecipe recipe = read_recipe(folder / "recipe.txt");
  recipe.hand.depth_max_m = scene.reach.depth_max_m;
  const SurfaceFrame frame = frame_of(body.surface, recipe);
  if (recipe.circle_centre_m) {
    recipe.hand.circle_m = frame.coordinates(*recipe.circle_centre_m);
  }
  std::vector<PlannedHand> planned = plan_hands(frame, recipe.hand);
  TruthPlaces wanted;
  for (const PlannedHand& hand : planned) {
    for (const auto& ticks : {hand.truth_tick, hand.dense_tick}) {
      for (const std::size_t tick : ticks) {
        if (hand.tick[tick].depth_m > 0.0) {
          wanted.want(hand.tick[tick]);
        }
      }
    }
  }
  const std::vector<PlacedDepth> raster = raster_of(frame, recipe);
  for (const PlacedDepth& place : raster) {
    wanted.want(place);
  }
  const Solved solved = solve(scene, body, wanted, recipe.times_finer);
  write_scene(folder, body.surface,
              {body.tool.front()->shape().radius_m, frame.place(0.0, 0.0, 0.0), recipe,
               body_lines(scene) + solved.told},
              told(std::move(planned), wanted, solved.curve));
  if (!raster.empty()) {
    std::vector<double> force_n;
    for (const PlacedDepth& p : raster) {
      const TrueCurve& curve = solved.curve[wanted.of(p)];
      force_n.push_back(curve.failure.empty()
                            ? curve.at(p.depth_m).dot(p.outward)
                            : std::numeric_limits<double>::quiet_NaN());
    }
    write_raster(folder, raster, force_n);
  }
}

// The paper's virtual body: its truth is a closed form.
void make_cylinder(const fs::path& folder) {
  const CylinderBodyOptions options{.friction = 0.0};
  const ResponseDatabase database = cylinder_body(options);
  SceneRecipe recipe;
  recipe.site_m = {0.0, 0.0, options.radius_m};
  recipe.hand.half_slide_m = 0.02;
  recipe.hand.depth_max_m = 0.008;
  const SurfaceFrame frame = frame_of(database.body, recipe);
  std::vector<ToldHand> hands;
  for (PlannedHand& planned : plan_hands(frame, recipe.hand)) {
    ToldHand hand{std::move(planned), {}};
    const auto tell = [&](std::size_t tick, std::vector<PlannedTruth>& to) {
      const PlacedDepth& p = hand.planned.tick[tick];
      Eigen::Vector3d out = p.at_m + (options.tool_radius_m - p.depth_m) * p.outward;
      out.x() = 0.0;  // the cylinder lies along x
      const double depth = options.radius_m + options.tool_radius_m - out.norm();
      to.push_back({tick, depth,
                    cylinder_force_n(options.stiffness_n_per_m, std::max(0.0, depth)) *
                        out.normalized()});
    };
    for (const std::size_t tick : hand.planned.truth_tick) {
      tell(tick, hand.truth);
    }
    for (const std::size_t tick : hand.planned.dense_tick) {
      tell(tick, hand.dense);
    }
    hands.push_back(std::move(hand));
  }
  write_scene(folder, database.body,
              {options.tool_radius_m, frame.place(0.0, 0.0, 0.0), recipe,
               "truth closed form\n"},
              hands);
  write_database(folder / "responses.h5", database);
}

// Vertices far from each other: each next one is farthest from those before.
std::vector<std::int32_t> spread_out(const BodySource& body,
                                     const std::vector<std::int32_t>& vertices,
                                     std::size_t count) {
  std::vector<std::int32_t> chosen{vertices.front()};
  while (chosen.size() < std::min(count, vertices.size())) {
    std::int32_t farthest = -1;
    double most = -1.0;
    for (const std::int32_t v : vertices) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::int32_t c : chosen) {
        nearest = std::min(
            nearest, (body.surface.position_m.row(v) - body.surface.position_m.row(c))
                         .squaredNorm());
      }
      if (nearest > most) {
        most = nearest;
        farthest = v;
      }
    }
    chosen.push_back(farthest);
  }
  return chosen;
}

struct MeasureFlags {
  std::string from;
  std::string folder;
  int points = 48;
  double noise_n = 0.002;
};

// The body of another scene as a laboratory knows it: pressed at some places, through
// air before the surface, with noise. Hands and truth are those of that scene.
void make_measured(const MeasureFlags& flags) {
  const fs::path from = flags.from;
  const fs::path folder = flags.folder;
  const Scene scene = scene_with_depths(from / "body.toml");
  const BodySource body = read_body(scene);
  const auto vertices = spread_out(body, reachable_vertices(scene, body),
                                   static_cast<std::size_t>(flags.points));
  std::vector<PlacedDepth> places;
  for (const std::int32_t v : vertices) {
    places.push_back({body.surface.position_m.row(v).transpose(),
                      body.normal.row(v).transpose(), scene.reach.depth_max_m});
  }
  const auto curves = true_curves(scene, body, places, 1.0);
  fs::create_directories(folder / "presses");
  for (const char* shared : {"surface.obj", "scene.txt", "raster.csv"}) {
    if (fs::exists(from / shared)) {
      fs::copy_file(from / shared, folder / shared,
                    fs::copy_options::overwrite_existing);
    }
  }
  for (const char* shared : {"hands", "truth"}) {
    fs::copy(from / shared, folder / shared,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }
  std::ofstream session(folder / "session.toml");
  session << fmt::format(
      "[read]\ndepth_column = \"depth_mm\"\ndepth_unit = \"mm\"\nforce_column = "
      "\"force_N\"\nforce_unit = \"N\"\n\n[indenter]\nshape = \"sphere\"\nradius_m = "
      "{}\npoissons_ratio = 0.45\n\n[body]\nmesh = \"surface.obj\"\nlength_unit = "
      "\"m\"\n",
      body.tool.front()->shape().radius_m);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, flags.noise_n);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!curves[i].failure.empty()) {
      continue;
    }
    const std::string file = fmt::format("presses/{:02}.csv", i);
    std::ofstream press(folder / file);
    press << "depth_mm,force_N\n";
    for (double d = -1e-3; d <= places[i].depth_m; d += 2.5e-5) {
      press << fmt::format("{:.4f},{:.5f}\n", 1e3 * (d + 1e-3),
                           curves[i].at(d).norm() + noise(random));
    }
    const auto& p = places[i];
    session << fmt::format(
        "\n[[run]]\nfiles = \"{}\"\nposition_m = [{}, {}, {}]\nnormal = [{}, {}, {}]\n",
        file, p.at_m.x(), p.at_m.y(), p.at_m.z(), p.outward.x(), p.outward.y(),
        p.outward.z());
  }
}

void add_make_command(Command app) {
  Command command =
      app.add_subcommand("make",
                         "Makes hands and truth of a folder with body.toml, its "
                         "mesh and recipe.txt");
  auto folder = std::make_shared<std::string>();
  command.add_option("folder", *folder, "Folder").required();
  command.callback([folder] {
    make(*folder);
  });
}

void add_cylinder_command(Command app) {
  Command command = app.add_subcommand("cylinder", "Makes the paper's virtual body");
  auto folder = std::make_shared<std::string>();
  command.add_option("folder", *folder, "Folder").required();
  command.callback([folder] {
    make_cylinder(*folder);
  });
}

void add_measured_command(Command app) {
  Command command = app.add_subcommand(
      "measured",
      "Makes a scene known from presses with noise alone, of another scene");
  auto flags = std::make_shared<MeasureFlags>();
  command.add_option("from", flags->from, "Folder of the scene that is pressed")
      .required();
  command.add_option("folder", flags->folder, "Folder").required();
  command.add_option("--points", flags->points, "Places that are pressed")
      .show_default()
      .positive();
  command.add_option("--noise-n", flags->noise_n, "Noise of force [N]")
      .show_default()
      .not_negative();
  command.callback([flags] {
    make_measured(*flags);
  });
}

void add_compliance_command(Command app) {
  Command command =
      app.add_subcommand("compliance", "Computes the compliance of a scene's surface");
  auto folder = std::make_shared<std::string>();
  auto output = std::make_shared<std::string>();
  command.add_option("folder", *folder, "Folder").required();
  command.add_option("-o,--output", *output, "File").required();
  command.callback([folder, output] {
    make_compliance(*folder, *output);
  });
}

}  // namespace
}  // namespace palpate::peers

int main(int argc, char** argv) {
  using namespace palpate::peers;
  return palpate::run_tool("peers_scene", "Makes the benchmark's scenes.",
                           {add_make_command, add_cylinder_command,
                            add_measured_command, add_compliance_command},
                           argc, argv);
}

#include "tests/peers/scene_files.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

std::ofstream created(const fs::path& file) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file);
  if (!out) {
    throw InputError(fmt::format("{}: cannot be written", file.string()));
  }
  return out;
}

std::string row(const Eigen::Vector3d& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

std::string blanks(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

void write_truth(const fs::path& file, const std::vector<PlannedTruth>& all) {
  if (all.empty()) {
    return;
  }
  std::ofstream truth = created(file);
  truth << "tick,fx_n,fy_n,fz_n\n";
  for (const PlannedTruth& t : all) {
    truth << fmt::format("{},{}\n", t.tick, row(t.force_n));
  }
}

void write_hand(const fs::path& folder, const ToldHand& hand, double radius_m) {
  const std::string file = hand.planned.name + ".csv";
  std::ofstream poses = created(folder / "hands" / file);
  poses << "x_m,y_m,z_m,nx,ny,nz\n";
  for (const PlacedDepth& p : hand.planned.tick) {
    const Eigen::Vector3d centre = p.at_m + (radius_m - p.depth_m) * p.outward;
    poses << row(centre) << ',' << row(p.outward) << '\n';
  }
  write_truth(folder / "truth" / file, hand.truth);
  write_truth(folder / "truth" / (hand.planned.name + "-dense.csv"), hand.dense);
}

using ReadValue = std::function<void(std::istream&)>;

template <class Number>
ReadValue read_number(Number& to) {
  return [&to](std::istream& in) {
    in >> to;
  };
}

ReadValue read_vector(Eigen::Vector3d& to) {
  return [&to](std::istream& in) {
    in >> to.x() >> to.y() >> to.z();
  };
}

ReadValue optional(std::optional<Eigen::Vector3d>& to) {
  return [&to](std::istream& in) {
    read_vector(to.emplace())(in);
  };
}

std::map<std::string, ReadValue> recipe_values(SceneRecipe& r) {
  return {{"site_m", read_vector(r.site_m)},
          {"along", read_vector(r.along)},
          {"circle_centre_m", optional(r.circle_centre_m)},
          {"circle_radius_m", read_number(r.hand.circle_radius_m)},
          {"half_slide_m", read_number(r.hand.half_slide_m)},
          {"slide_points", read_number(r.hand.slide_points)},
          {"circle_points", read_number(r.hand.circle_points)},
          {"walk_points", read_number(r.hand.walk_points)},
          {"dense_truth", read_number(r.hand.dense_truth)},
          {"raster_along_m", read_number(r.raster_along_m)},
          {"raster_across_m", read_number(r.raster_across_m)},
          {"raster_step_m", read_number(r.raster_step_m)},
          {"raster_depth_m", read_number(r.raster_depth_m)},
          {"nodule_m", optional(r.nodule_m)},
          {"nodule_radius_m", read_number(r.nodule_radius_m)},
          {"friction", read_number(r.friction)},
          {"presliding_m", read_number(r.presliding_m)},
          {"times_finer", read_number(r.times_finer)}};
}

}  // namespace

SceneRecipe read_recipe(const fs::path& file) {
  SceneRecipe recipe;
  const auto known = recipe_values(recipe);
  std::ifstream in(file);
  if (!in) {
    throw InputError(fmt::format("{}: cannot be read", file.string()));
  }
  int line_number = 0;
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    if (line.empty() || line.front() == '#') {
      continue;
    }
    std::istringstream words(line);
    std::string key;
    words >> key;
    const auto found = known.find(key);
    if (found == known.end()) {
      throw InputError(fmt::format("{}:{}: \"{}\" is no value of a recipe",
                                   file.string(), line_number, key));
    }
    found->second(words);
    if (!words) {
      throw InputError(
          fmt::format("{}:{}: \"{}\" lacks numbers", file.string(), line_number, line));
    }
  }
  return recipe;
}

std::vector<PlacedDepth> raster_of(const SurfaceFrame& frame, const SceneRecipe& r) {
  std::vector<PlacedDepth> places;
  if (!(r.raster_along_m > 0.0)) {
    return places;
  }
  const int along = static_cast<int>(std::lround(r.raster_along_m / r.raster_step_m));
  const int across = static_cast<int>(std::lround(r.raster_across_m / r.raster_step_m));
  for (int i = -along; i <= along; ++i) {
    for (int j = -across; j <= across; ++j) {
      places.push_back(
          frame.place(i * r.raster_step_m, j * r.raster_step_m, r.raster_depth_m));
    }
  }
  return places;
}

double typed_stiffness_n_per_m(const std::vector<ToldHand>& hands) {
  double force_depth = 0.0;
  double depth_depth = 0.0;
  for (const ToldHand& hand : hands) {
    for (const PlannedTruth& t : hand.truth) {
      if (t.depth_m > 0.0) {
        force_depth += t.force_n.norm() * t.depth_m;
        depth_depth += t.depth_m * t.depth_m;
      }
    }
  }
  return force_depth / depth_depth;
}

void write_scene(const fs::path& folder, const SurfaceMesh& surface,
                 const SceneText& text, const std::vector<ToldHand>& hands) {
  fs::create_directories(folder);
  write_obj(surface, folder / "surface.obj", "surface of a benchmark's body");
  for (const ToldHand& hand : hands) {
    write_hand(folder, hand, text.tool_radius_m);
  }
  const SceneRecipe& r = text.recipe;
  std::ofstream out = created(folder / "scene.txt");
  out << fmt::format(
      "tool_radius_m {}\ndepth_max_m {}\nsite_m {}\nsite_normal {}\n"
      "typed_stiffness_n_per_m {}\nfriction {}\npresliding_m {}\nraster_depth_m {}\n",
      text.tool_radius_m, r.hand.depth_max_m, blanks(text.site.at_m),
      blanks(text.site.outward), typed_stiffness_n_per_m(hands), r.friction,
      r.presliding_m, r.raster_depth_m);
  if (r.nodule_m) {
    out << fmt::format("nodule_m {}\nnodule_radius_m {}\n", blanks(*r.nodule_m),
                       r.nodule_radius_m);
  }
  out << text.more;
}

void write_raster(const fs::path& folder, const std::vector<PlacedDepth>& raster,
                  const std::vector<double>& force_n) {
  std::ofstream out = created(folder / "raster.csv");
  out << "x_m,y_m,z_m,nx,ny,nz,true_force_n\n";
  for (std::size_t i = 0; i < raster.size(); ++i) {
    out << fmt::format("{},{},{}\n", row(raster[i].at_m), row(raster[i].outward),
                       force_n[i]);
  }
}

}  // namespace palpate::peers

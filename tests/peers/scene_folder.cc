#include "tests/peers/scene_folder.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

std::ifstream opened(const fs::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw InputError(fmt::format("{}: cannot be read", file.string()));
  }
  return in;
}

std::map<std::string, std::string> read_values(const fs::path& file) {
  std::ifstream in = opened(file);
  std::map<std::string, std::string> values;
  for (std::string line; std::getline(in, line);) {
    const std::size_t blank = line.find(' ');
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (blank == std::string::npos) {
      throw FormatError(fmt::format("{}: \"{}\" must be a name, a blank and a value",
                                    file.string(), line));
    }
    values[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return values;
}

// Numbers of a value that has to be there.
std::vector<double> numbers(const PeerScene& scene, const std::string& key,
                            std::size_t count) {
  const auto found = scene.value.find(key);
  if (found == scene.value.end()) {
    throw FormatError(
        fmt::format("{}/scene.txt: no value \"{}\"", scene.folder.string(), key));
  }
  std::istringstream in(found->second);
  std::vector<double> all;
  for (double x = 0.0; in >> x;) {
    all.push_back(x);
  }
  if (all.size() != count) {
    throw FormatError(fmt::format("{}/scene.txt: \"{}\" is \"{}\", must be {} numbers",
                                  scene.folder.string(), key, found->second, count));
  }
  return all;
}

Eigen::Vector3d vector(const PeerScene& scene, const std::string& key) {
  return Eigen::Vector3d(numbers(scene, key, 3).data());
}

// Of a hand with so many ticks; none where there is no such file.
std::vector<TruePoint> read_truth(const fs::path& file, std::size_t ticks) {
  std::vector<TruePoint> points;
  if (!fs::exists(file)) {
    return points;
  }
  for (const auto& row : read_table(file, 4)) {
    const auto tick = static_cast<std::int64_t>(row[0]);
    if (tick < 0 || tick >= static_cast<std::int64_t>(ticks)) {
      throw FormatError(fmt::format("{}: tick {} is not one of the hand's {}",
                                    file.string(), tick, ticks));
    }
    points.push_back({tick, {row[1], row[2], row[3]}});
  }
  return points;
}

Hand read_hand(const fs::path& file, const fs::path& truth) {
  Hand hand;
  hand.name = file.stem().string();
  for (const auto& row : read_table(file, 6)) {
    hand.centre_m.emplace_back(row[0], row[1], row[2]);
    hand.outward.emplace_back(row[3], row[4], row[5]);
  }
  hand.truth = read_truth(truth / (hand.name + ".csv"), hand.centre_m.size());
  hand.dense_truth =
      read_truth(truth / (hand.name + "-dense.csv"), hand.centre_m.size());
  return hand;
}

void read_hands(PeerScene& scene) {
  for (const auto& entry : fs::directory_iterator(scene.folder / "hands")) {
    if (entry.path().extension() == ".csv") {
      scene.hand.push_back(read_hand(entry.path(), scene.folder / "truth"));
    }
  }
  std::sort(scene.hand.begin(), scene.hand.end(), [](const Hand& a, const Hand& b) {
    return a.name < b.name;
  });
}

void read_raster(PeerScene& scene) {
  const fs::path file = scene.folder / "raster.csv";
  if (!fs::exists(file)) {
    return;
  }
  scene.raster_depth_m = numbers(scene, "raster_depth_m", 1)[0];
  for (const auto& r : read_table(file, 7)) {
    scene.raster.push_back({{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, r[6]});
  }
  if (scene.value.contains("nodule_m")) {
    scene.nodule_m = vector(scene, "nodule_m");
    scene.nodule_radius_m = numbers(scene, "nodule_radius_m", 1)[0];
  }
}

}  // namespace

std::vector<std::vector<double>> read_table(const fs::path& file, std::size_t columns) {
  std::ifstream in = opened(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(in, line);  // the columns' names
  for (int number = 2; std::getline(in, line); ++number) {
    std::vector<double> row;
    const char* at = line.data();
    const char* end = at + line.size();
    while (at < end) {
      double x = 0.0;
      const auto read = std::from_chars(at, end, x);
      if (read.ec != std::errc()) {
        break;
      }
      row.push_back(x);
      at = read.ptr < end && *read.ptr == ',' ? read.ptr + 1 : read.ptr;
    }
    if (row.size() != columns || at != end) {
      throw FormatError(fmt::format("{}:{}: must be {} numbers with commas between",
                                    file.string(), number, columns));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

const Hand* PeerScene::find(const std::string& hand_name) const {
  const auto found = std::find_if(hand.begin(), hand.end(), [&](const Hand& h) {
    return h.name == hand_name;
  });
  return found == hand.end() ? nullptr : &*found;
}

PeerScene read_peer_scene(const fs::path& folder) {
  PeerScene scene;
  scene.folder = folder;
  scene.name = fs::absolute(folder / "scene.txt").parent_path().filename().string();
  scene.value = read_values(folder / "scene.txt");
  scene.radius_m = numbers(scene, "tool_radius_m", 1)[0];
  scene.depth_max_m = numbers(scene, "depth_max_m", 1)[0];
  scene.site.at_m = vector(scene, "site_m");
  scene.site.outward = vector(scene, "site_normal").normalized();
  scene.surface = read_surface(folder / "surface.obj", "m");
  read_hands(scene);
  read_raster(scene);
  return scene;
}

}  // namespace palpate::peers

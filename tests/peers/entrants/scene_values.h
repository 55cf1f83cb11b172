// What the benchmark's own entrants read of a scene: scene.txt and surface.obj. Of the
// standard library alone, to be built beside other libraries.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

class SceneValues {
 public:
  explicit SceneValues(const std::filesystem::path& folder) {
    std::ifstream in(folder / "scene.txt");
    for (std::string line; std::getline(in, line);) {
      const std::size_t blank = line.find(' ');
      if (blank != std::string::npos && line.front() != '#') {
        value_[line.substr(0, blank)] = line.substr(blank + 1);
      }
    }
  }

  [[nodiscard]] bool has(const std::string& key) const { return value_.contains(key); }

  /// @throws std::runtime_error naming the value that the scene does not have.
  [[nodiscard]] double number(const std::string& key) const {
    if (!has(key)) {
      throw std::runtime_error("the scene has no " + key);
    }
    return std::stod(value_.at(key));
  }

  /// All numbers of a value, likewise.
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const {
    (void)number(key);
    std::istringstream in(value_.at(key));
    std::vector<double> all;
    for (double x = 0.0; in >> x;) {
      all.push_back(x);
    }
    return all;
  }

 private:
  std::map<std::string, std::string> value_;
};

/// A triangle surface, as surface.obj has it.
struct SceneSurface {
  std::vector<std::array<double, 3>> vertex;
  std::vector<std::array<int, 3>> triangle;  ///< from 0
};

inline SceneSurface read_scene_surface(const std::filesystem::path& folder) {
  SceneSurface surface;
  std::ifstream in(folder / "surface.obj");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      auto& v = surface.vertex.emplace_back();
      words >> v[0] >> v[1] >> v[2];
    } else if (kind == "f") {
      auto& t = surface.triangle.emplace_back();
      words >> t[0] >> t[1] >> t[2];
      for (int& corner : t) {
        --corner;
      }
    }
  }
  if (surface.triangle.empty()) {
    throw std::runtime_error("the scene has no surface.obj");
  }
  return surface;
}

}  // namespace peers

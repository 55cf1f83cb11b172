// What the benchmark's own entrants read of a scene: scene.txt and surface.obj.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

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

 private:
  std::map<std::string, std::string> value_;
};

}  // namespace peers

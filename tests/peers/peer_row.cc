#include "tests/peers/peer_row.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

// Speed of a press of the raster, and from how far above it comes.
constexpr double kRasterMPerS = 0.02;
constexpr double kRasterAboveM = 0.002;
// At its end the tool rests, for renderers that move.
constexpr int kRasterRestTicks = 100;

std::uintmax_t bytes_in(const fs::path& folder) {
  std::uintmax_t sum = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    sum += entry.is_regular_file() ? entry.file_size() : 0;
  }
  return sum;
}

// Seconds that the library's variants took to build, whenever that was; this one is
// opened and timed if it never was.
double build_s(const Renderer& renderer, const std::string& variant,
               const PeerScene& scene, const fs::path& own) {
  const fs::path note = own.string() + ".built";
  std::ifstream in(note);
  double longest = 0.0;
  bool known = false;
  for (std::string line; std::getline(in, line);) {
    const std::size_t blank = line.find(' ');
    longest = std::max(longest, std::stod(line.substr(0, blank)));
    known = known || line.substr(blank + 1) == variant;
  }
  if (known) {
    return longest;
  }
  fs::create_directories(own);
  const auto begin = std::chrono::steady_clock::now();
  (void)OpenTool(renderer, variant, scene.folder, own, kHandTickS);
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::ofstream(note, std::ios::app) << fmt::format("{:.3f} {}\n", took, variant);
  return std::max(longest, took);
}

void note_forces(Sha256& digest, const std::vector<Eigen::Vector3d>& force_n) {
  digest.update(std::as_bytes(std::span(force_n)));
}

std::vector<double> raster_forces(const Renderer& renderer, const std::string& variant,
                                  const PeerScene& scene, const fs::path& own) {
  std::vector<double> all;
  for (const PressPlace& place : scene.raster) {
    OpenTool tool(renderer, variant, scene.folder, own, kHandTickS);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (double d = -kRasterAboveM; d < scene.raster_depth_m;
         d += kRasterMPerS * kHandTickS) {
      (void)tool.tick(centre_at(place, scene.radius_m, d));
    }
    for (int i = 0; i < kRasterRestTicks; ++i) {
      force = tool.tick(centre_at(place, scene.radius_m, scene.raster_depth_m));
    }
    all.push_back(force.dot(place.outward));
  }
  return all;
}

void measure_hands(const Renderer& renderer, const std::string& variant,
                   const PeerScene& scene, const fs::path& own, PeerRow& row,
                   Sha256& digest) {
  std::vector<RenderedHand> rendered;
  for (const Hand& hand : scene.hand) {
    OpenTool tool(renderer, variant, scene.folder, own, kHandTickS);
    RenderedHand one{&hand, {}};
    for (const Eigen::Vector3d& centre : hand.centre_m) {
      one.force_n.push_back(tool.tick(centre));
    }
    note_forces(digest, one.force_n);
    const PathEnergy energy = path_energy(hand.centre_m, one.force_n);
    if (hand.name.starts_with("cycle")) {
      row.created_cycle_j = std::max(row.created_cycle_j, -energy.put_in_j);
      row.cycle_j = std::max(row.cycle_j, energy.largest_j);
    } else {
      row.created_path_j = std::max(row.created_path_j, energy.created_j);
      row.lost_path_j = std::max(row.lost_path_j, energy.put_in_j);
    }
    if (hand.name == "slide-20") {
      row.jumps = edge_jumps(scene.surface, one);
      row.sideways = sideways(one);
    }
    rendered.push_back(std::move(one));
  }
  row.error = force_error(rendered);
}

std::vector<const Hand*> timed_hands(const PeerScene& scene) {
  std::vector<const Hand*> hands;
  for (const char* name : {"slide-50", "walk"}) {
    if (const Hand* hand = scene.find(name)) {
      hands.push_back(hand);
    }
  }
  return hands;
}

void measure_variant(const Renderer& renderer, const std::string& variant,
                     const PeerScene& scene, const fs::path& own,
                     const MeasureOptions& options, PeerRow& row) {
  row.build_s = build_s(renderer, variant, scene, own);
  row.bytes = bytes_in(own);
  Sha256 digest;
  measure_hands(renderer, variant, scene, own, row, digest);
  if (!scene.raster.empty()) {
    const auto force_n = raster_forces(renderer, variant, scene, own);
    digest.update(std::as_bytes(std::span(force_n)));
    row.nodule = find_nodule(scene, force_n);
  }
  if (options.stability) {
    for (const LeaningDevice& device : leaning_devices()) {
      row.stable.push_back(
          largest_stable_stiffness(renderer, variant, scene, own, device));
    }
  }
  if (options.times) {
    row.time = step_times(renderer, variant, scene, own, timed_hands(scene));
  }
  row.digest = digest.hex();
}

}  // namespace

std::vector<PeerRow> measure(const Renderer& renderer, const PeerScene& scene,
                             const MeasureOptions& options) {
  const fs::path own = scene.folder / "own" / renderer.name;
  std::vector<PeerRow> rows;
  for (const std::string& variant : renderer.variants()) {
    PeerRow row{.scene = scene.name,
                .renderer = fmt::format("{} {}", renderer.name, variant)};
    try {
      measure_variant(renderer, variant, scene, own, options, row);
    } catch (const Error& error) {
      row.missing = error.what();
    }
    rows.push_back(std::move(row));
  }
  // The library is built when its last variant is.
  for (PeerRow& row : rows) {
    if (row.missing.empty()) {
      row.bytes = bytes_in(own);
      row.build_s = std::max(row.build_s, rows.back().build_s);
    }
  }
  return rows;
}

std::optional<PeerRow> true_raster(const PeerScene& scene) {
  std::vector<double> force_n;
  for (const PressPlace& place : scene.raster) {
    force_n.push_back(place.true_force_n);
  }
  if (force_n.empty() || std::any_of(force_n.begin(), force_n.end(), [](double f) {
        return !std::isfinite(f);
      })) {
    return std::nullopt;
  }
  PeerRow row{.scene = scene.name, .renderer = "truth"};
  row.nodule = find_nodule(scene, force_n);
  return row;
}

}  // namespace palpate::peers

// A body made for benches and tests: a wavy square of surface with a response per node.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "formats/response/yielding.h"
#include "runtime/element/element.h"

namespace palpate {

struct BenchBodyOptions {
  int cells = 12;              ///< [-] >= 1, squares per side, two triangles each
  double cell_m = 0.005;       ///< [m] > 0
  double wave_m = 0.0;         ///< [m] height of the waves of the surface
  double wavelength_m = 0.04;  ///< [m] > 0
  double exponent = 1.5;       ///< [-] >= 1, f = a d^exponent
  double force_n = 2.0;        ///< [N] f at depth_m, before contrast
  double depth_m = 0.008;      ///< [m] > 0, last sample of every curve
  int samples = 33;            ///< [2, kElementSamples] of every curve
  double contrast = 1.0;       ///< [-] >= 1, largest over smallest stiffness
  double tilt_rad = 0.0;       ///< [rad] largest angle of u to n
  /// [1/m] by how much tilts change with the tool's height, at most: about that at
  /// touch
  double tilt_by_height_per_m = 0.0;
  double touch_height_m = 0.005;  ///< [m] of the tool
  double friction_min = 0.0;      ///< [-]
  double friction_max = 0.0;      ///< [-] per node in between
  double presliding_m = 5e-4;     ///< [m] delta_L of every node
  /// [-] Largest eigenvalue of the nodes' lateral stiffness; every node and depth draws
  /// its own from a tenth of it on. 0: the presliding length tells all.
  double lateral = 0.0;
  double touch_offset_m = 0.0;                ///< [m] largest touch offset, either sign
  std::vector<double> relaxing = {};          ///< [-] g_k of every node; none: static
  std::vector<double> relaxation_s = {};      ///< [s] tau_k, as many
  int bundles = 1;                            ///< that every curve is cut into
  std::optional<NodeYielding> yielding = {};  ///< of every node; none: nothing yields
  /// [-] >= 1; 1: every node is a memory site, else every so many along both sides.
  int cells_per_site = 1;
  std::uint32_t seed = 1;
};

/// Triangle 2 (row cells + column) and the one after it tile the square of that row and
/// column. The surface lies around z = 0, the body below it. x and y count from 0.
struct BenchBody {
  BenchBodyOptions options;
  std::vector<Element> element;  ///< `sequence` 0, not active

  [[nodiscard]] double side_m() const { return options.cells * options.cell_m; }

  /// Triangle over or under a position; the nearest one beyond the borders.
  [[nodiscard]] std::int32_t triangle_at(const Eigen::Vector3d& p_m) const;

  /// Height of the surface over (x, y), between its nodes as the triangles have it.
  [[nodiscard]] double height_m(const Eigen::Vector3d& p_m) const;

  /// What the slow process sends for a tool there: the active element, then those that
  /// share a vertex with it (at most 12).
  [[nodiscard]] std::vector<Element> around(const Eigen::Vector3d& p_m) const;
};

/// The same options and seed give the same body.
[[nodiscard]] BenchBody make_bench_body(const BenchBodyOptions& options);

/// A tool that wanders over the body and in and out of it. The tool's velocity is
/// first-order noise, and the tool is reflected at a box around the middle of the
/// surface.
struct BenchWalkOptions {
  int ticks = 100000;
  double tick_s = 0.0005;        ///< [s] > 0
  double speed_m_per_s = 0.05;   ///< [m/s] standard deviation of each component
  double memory_s = 0.1;         ///< [s] > 0, correlation time of the velocity
  double tool_radius_m = 0.005;  ///< [m]
  double depth_m = 0.008;        ///< [m] lowest point of the tool below z = 0
  double lift_m = 0.002;         ///< [m] highest above it
  std::uint32_t seed = 1;
};

/// Positions of the tool's centre [m]; the same options give the same walk.
[[nodiscard]] std::vector<Eigen::Vector3d> make_bench_walk(
    const BenchBody& body, const BenchWalkOptions& options);

/// How every node yields. Curves must be those of a first press: they become the
/// undamaged ones.
void set_yielding(BenchBody& body, const std::vector<NodeYielding>& by_node);

/// Samples f = a d^p, a = force_n / depth_m^p, into a node: exact slopes, energies of
/// the cubic between the samples. @param samples [2, kElementSamples].
void set_power_law(ElementNode& node, double exponent, double force_n, double depth_m,
                   int samples = 33);

}  // namespace palpate

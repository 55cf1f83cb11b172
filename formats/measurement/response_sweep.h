// Forces of a body under one tool for a grid of material parameters: what measured
// curves are compared with to find the material.
//
// As a file: delimited text. Line 1 is "# palpate response sweep 1"; where the forces'
// own error is known, line 2 is "# error_relative " and the error. A line of names
// "vertex,<parameter>,...,depth_m,force_n" follows. Then comes a row per vertex,
// combination and depth, in this order, the last parameter fastest. Depth counts from
// the first touch along the tool's way, force is that on the tool along it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

struct SweepParameter {
  std::string name;           ///< with its unit, "body.youngs_modulus_pa"
  std::vector<double> value;  ///< (g >= 2) > 0, increasing
};

struct ResponseSweep {
  std::vector<SweepParameter> parameter;  ///< at least one
  std::vector<std::int32_t> vertex;       ///< at least one, of the body
  std::vector<double> depth_m;            ///< (k >= 2) [m] > 0, increasing
  /// (vertices * combinations * k) [N] > 0
  std::vector<double> force_n;
  /// [-] [0, 1) standard deviation of a factor on all forces; 0: not known
  double error_relative = 0.0;

  /// Points of the grid: product of the parameters' counts.
  [[nodiscard]] std::size_t combinations() const;

  /// Value of each parameter at a point of the grid.
  [[nodiscard]] std::vector<double> values_at(std::size_t combination) const;

  /// (k) [N] of the vertex at this place in `vertex`.
  [[nodiscard]] std::span<const double> curve_n(std::size_t place,
                                                std::size_t combination) const;
};

/// @throws InputError naming the parameter or row that is out of range.
void check(const ResponseSweep& sweep);

/// Checks, then writes atomically, numbers so that they read back bit for bit.
/// @throws InputError.
void write_sweep(const std::filesystem::path& file, const ResponseSweep& sweep);

/// @throws InputError for a missing file; FormatError, naming the line, for one that is
/// of another kind or version, or whose grid is not complete.
[[nodiscard]] ResponseSweep read_sweep(const std::filesystem::path& file);

}  // namespace palpate

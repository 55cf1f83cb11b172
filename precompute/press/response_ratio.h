// How a good solution of a node's press compares with a cheap one, and what that says
// about its neighbours.
//
// A ratio needs two forces that mean the same thing. A press is a guide where it
// carries force at every depth after the first touch; where it carries none (the tool
// leaves contact on its way, or touches twice) nothing can be divided by it and nothing
// scaled. Two guides are alike where the ratio of their forces lies between 1/10 and 10
// at every depth; where it does not, the good press follows another mechanism than the
// cheap one (it lost contact, or a fold closed), and its ratio says nothing about other
// vertices, but that they may be as odd. Such vertices keep their own good press, and
// those around them are not interpolated without more solves.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// Good over cheap along a path.
struct PathRatio {
  Eigen::VectorXd force;  ///< (k) [-] at the cheap path's samples but the first
  /// (k x 3) [-] good direction minus the cheap one, for the same vertex only; else
  /// empty.
  Eigen::MatrixX3d turn;
  /// (k) [-] What sample k's ratio counts in an error, as force_difference() has it:
  /// nothing below a tenth of the depth, less where the force is below a tenth of the
  /// largest.
  Eigen::VectorXd weight;
  /// [-] [0, 1] part of what it was made of that comes from presses with a hard path.
  double hard_share = 0.0;
};

/// Whether a path can be scaled, or divided by: at least two samples after the first
/// touch, all numbers finite, force at each of them (above 1e-9 of the largest).
[[nodiscard]] bool is_guide(const Indentation& path);

/// Of two presses on one mesh, so at the same depths: its errors are alike in both and
/// cancel. None where either path is no guide, or they are not alike. Where the good
/// path is shorter its last ratio goes on.
[[nodiscard]] std::optional<PathRatio> path_ratio(const Indentation& good,
                                                  const Indentation& cheap);

/// A cheap path, on any mesh, scaled sample by sample, and turned where the ratio says
/// so. Hard to follow where half of the ratio or more is of such presses.
[[nodiscard]] Indentation scaled(const Indentation& cheap, const PathRatio& ratio,
                                 double force_max_n);

/// Ratios known at some vertices of a surface, and between them.
class RatioField {
 public:
  /// @param contact_m [m] radius of a contact: bodies change over it.
  RatioField(const SurfaceMesh& surface, const Points& normal, double contact_m)
      : surface_(surface), normal_(normal), contact_m_(contact_m) {}

  /// @param cheap the vertex's, a guide.
  /// @param ratio none where the presses are not alike: then the vertex counts in
  /// errors, as wrong by all of its force, but not in means.
  void add(std::int32_t vertex, const Indentation& cheap,
           std::optional<PathRatio> ratio);

  /// Vertices whose ratio is known.
  [[nodiscard]] std::size_t size() const { return ratios_; }

  /// How far apart two vertices are for ratios [m]: in space, and so much more as they
  /// face elsewhere, as the cheap path of one is stiffer than the other's, or as the
  /// body is more nonlinear there.
  [[nodiscard]] double distance_m(std::int32_t a, const Indentation& cheap_a,
                                  std::int32_t b, const Indentation& cheap_b) const;

  /// The same but for their places: how unlike each other they are [-], in radians that
  /// they face apart and in logarithms of stiffness.
  [[nodiscard]] double unlikeness(std::int32_t a, const Indentation& cheap_a,
                                  std::int32_t b, const Indentation& cheap_b) const;

  /// Mean of the nearest known ratios, weighted by inverse squares of distance; there
  /// must be one. @param without a vertex that must not count.
  [[nodiscard]] PathRatio at(std::int32_t vertex, const Indentation& cheap,
                             std::int32_t without = -1) const;

  /// Leave-one-out error of every known vertex, in the order of add().
  [[nodiscard]] std::vector<double> leave_one_out() const;

  /// Error expected at a vertex: rms of the leave-one-out errors around it, weighted as
  /// ratios are. A neighbour is farther from a left-out vertex than from this one, so
  /// that this is rather too large than too small.
  [[nodiscard]] double error_at(std::int32_t vertex, const Indentation& cheap,
                                std::span<const double> leave_one_out) const;

 private:
  struct Place {
    std::int32_t vertex = -1;
    double log_stiffness = 0.0;  // of the cheap path
    double nonlinearity = 0.0;
  };
  struct Known {
    Place place;
    std::optional<PathRatio> ratio;
  };
  struct Weight {
    std::size_t known = 0;
    double weight = 0.0;
    double distance_m = 0.0;
  };
  [[nodiscard]] static Place place_of(std::int32_t vertex, const Indentation& cheap);
  [[nodiscard]] double unlikeness(const Place& a, const Place& b) const;
  [[nodiscard]] double distance_m(const Place& a, const Place& b) const;
  [[nodiscard]] PathRatio mean_at(const Place& place, std::int32_t without) const;
  // Of the nearest known vertices; of all, or only of those with a ratio.
  enum class Of { kAll, kRatios };
  [[nodiscard]] std::vector<Weight> weights(const Place& place, std::int32_t without,
                                            Of of) const;

  const SurfaceMesh& surface_;
  const Points& normal_;
  double contact_m_;
  std::vector<Known> known_;
  std::size_t ratios_ = 0;
};

}  // namespace palpate

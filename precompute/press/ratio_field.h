// Ratios of full-accuracy and linear presses over a body: known at
// some vertices, predicted at the others by kriging.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/press/kriging.h"
#include "precompute/press/response_ratio.h"

namespace palpate {

/// Where the ratio is known.
class RatioField {
 public:
  /// What a vertex' ratio depends on.
  struct Place {
    std::int32_t vertex = -1;
    double log_stiffness = 0.0;  ///< ln [N/m], of the linear path
    double nonlinearity = 0.0;   ///< [-] Indentation::nonlinearity
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] mean of the linear path
  };
  struct Known {
    Place place;
    std::optional<PathRatio> ratio;
    /// (k x 3) [-] unit forces of the linear path at its samples but the first
    Eigen::MatrixX3d direction;
  };
  static constexpr std::size_t kCoordinates = 8;

  /// @param contact_m [m] radius of a contact: bodies change over it.
  RatioField(const SurfaceMesh& surface, const Points& normal, double contact_m)
      : surface_(surface), normal_(normal), contact_m_(contact_m) {}

  [[nodiscard]] static Place place_of(std::int32_t vertex, const Indentation& linear);

  /// @param linear the vertex's, a guide.
  /// @param ratio none where the two presses follow different mechanisms. Then the
  /// vertex counts in errors, as wrong by all of its force, but not in predictions.
  void add(std::int32_t vertex, const Indentation& linear,
           std::optional<PathRatio> ratio);

  [[nodiscard]] std::span<const Known> known() const { return known_; }
  /// Vertices whose ratio is known.
  [[nodiscard]] std::size_t size() const { return ratios_; }

  /// Distance of two places [m], for choosing some among them: their distance in space
  /// and more. What is added grows with the differences of normal, stiffness and
  /// nonlinearity of the body there.
  [[nodiscard]] double distance_m(const Place& a, const Place& b) const;

  /// The same but for where they are: how unlike each other they are [-], in radians
  /// that they face apart and in logarithms of stiffness.
  [[nodiscard]] double unlikeness(const Place& a, const Place& b) const;

  /// [-] Position in radii of the contact, normal, logarithm of stiffness and
  /// nonlinearity.
  [[nodiscard]] Eigen::Vector<double, kCoordinates> coordinates(const Place& p) const;

  /// The frame in which turns of forces are similar over the surface, in columns: the
  /// normal n, c and n x c. c is the part of the linear force along the surface. Its
  /// length is 1 where the force leans, and goes to 0 with the lean below a fifth of a
  /// degree. So c is continuous: where the force does not lean, c points nowhere. No
  /// turn along the surface is then taken from other vertices.
  [[nodiscard]] Eigen::Matrix3d frame(const Place& p) const;

 private:
  const SurfaceMesh& surface_;
  const Points& normal_;
  double contact_m_;
  std::vector<Known> known_;
  std::size_t ratios_ = 0;
};

/// Standard deviations in an expected error [-].
inline constexpr double kExpectedDeviations = 1.5;

/// What a field predicts. Logarithms of ratios, and turns of forces in the frame of
/// their vertex, are taken for a random field over all coordinates. The field is the
/// same at all depths. Errors are those of force vectors, |F - F'| over |F|. The
/// field's lengths of change are those by which the known ratios predict each other
/// best. The criterion is the leave-one-out predictive probability (Sundararajan and
/// Keerthi, Neural Computation 13, 2001). The lengths stay near the usual ones.
class RatioModel {
 public:
  /// @param field as it is now; must outlive it, unchanged.
  explicit RatioModel(const RatioField& field);

  /// The ratio at a vertex; field.size() must not be 0.
  [[nodiscard]] PathRatio at(std::int32_t vertex, const Indentation& linear) const;

  /// The same, from all others where the vertex' own ratio is known; field.size() must
  /// be larger than 1 there.
  [[nodiscard]] PathRatio from_others(std::int32_t vertex,
                                      const Indentation& linear) const;

  /// Error of force [-] that is expected at a vertex if the vertex takes this ratio.
  /// The error is kExpectedDeviations of a field as rough as around the vertex, or as
  /// everywhere, whichever is more. Presses nearby without a usable ratio raise the
  /// error.
  [[nodiscard]] double error_at(std::int32_t vertex, const Indentation& linear) const;

  /// Error [-] of every known ratio as the others predict it, in the order of
  /// field.known(); 1 where there is no ratio, or no other.
  [[nodiscard]] std::vector<double> left_out_errors() const;

 private:
  using Lengths = std::array<double, 4>;
  struct LeftOut {
    Eigen::VectorXd error;     // (n) [-] of force
    Eigen::VectorXd variance;  // (n) [-] that the kriging expects
  };
  // Squares of left-out errors over their variances.
  struct Roughness {
    Eigen::VectorXd each;   // (n)
    double ordinary = 0.0;  // of nine tenths of them
  };
  struct Around {
    double roughness = 0.0;
    double unlike = 0.0;  // share of those that were not alike
  };
  [[nodiscard]] Around around(const RatioField::Place& place) const;
  [[nodiscard]] Eigen::VectorXd scaled(const RatioField::Place& place,
                                       const Lengths& lengths) const;
  [[nodiscard]] Kriging kriging(const Lengths& lengths) const;
  [[nodiscard]] LeftOut left_out(const Kriging& kriging) const;
  [[nodiscard]] double improbability(const Lengths& lengths) const;
  [[nodiscard]] Lengths best_lengths() const;
  [[nodiscard]] PathRatio ratio_of(const Eigen::VectorXd& value,
                                   const RatioField::Place& place) const;

  const RatioField& field_;
  std::vector<std::size_t> with_ratio_;  // (n) in field_.known()
  // (n x 4 k + 1) logarithms of ratios, k of turns along each axis of the frame, and
  // the hard share
  Eigen::MatrixXd value_;
  Eigen::MatrixXd weight_;  // (n x k) of depths in an error
  Lengths lengths_;
  std::optional<Kriging> kriging_;
  LeftOut left_out_;
  Roughness roughness_;
};

}  // namespace palpate

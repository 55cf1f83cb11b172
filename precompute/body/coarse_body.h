// A body in coarse tets, which gives the displacement of the cut to a part cut out of
// the body.
//
// The part is clamped at its cut. E is the displacement of the part for a given
// displacement of the cut (its harmonic extension). Then the compliance of the whole
// body between two contact nodes is exactly
//   G(x, y) = G_clamped(x, y) + x . E u_y.
// u_y is the displacement of the whole body's cut under the unit pressure force at y.
// Here u_y is computed on the coarse body. G(x, y) and G(y, x) then have slightly
// different values; the mean of both is used.
//
// Error: a clamped part is wrong by order a/R of the force (contact radius over cut
// radius). The coarse body multiplies this error by its own relative error of u_y at
// the distance R from the load.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/fem/tet_locator.h"

namespace palpate {

/// A part whose cut is held: degrees of freedom of the cut are not free ones.
struct ClampedPart {
  BodyModel model;
  Stiffness stiffness;            ///< of all degrees of freedom, lower triangle
  std::vector<std::int32_t> cut;  ///< nodes of the mesh on the cut; empty: all the body
  std::vector<std::int32_t> corner;  ///< (n_corners) of the body's tets, ascending
};

class CoarseBody {
 public:
  /// The body's surface, coarsened or refined, meshed and factorised. Edges are about
  /// `edge_m` long near the vertices that will be pressed, and longer away from them.
  /// @throws InputError if the body would have more than kMostTriangles triangles.
  CoarseBody(const Scene& scene, const BodySource& body,
             std::span<const std::int32_t> vertices, double edge_m);
  explicit CoarseBody(BodyModel model);
  CoarseBody(const CoarseBody&) = delete;
  CoarseBody& operator=(const CoarseBody&) = delete;

  [[nodiscard]] const BodyModel& model() const { return model_; }

  /// What the cut's giving way adds to the part's compliance among the contact nodes,
  /// (n x n) [m/N], symmetric. Safe from several threads at once.
  [[nodiscard]] Eigen::MatrixXd exterior_compliance(
      const ClampedPart& part, std::span<const std::int32_t> nodes) const;

  /// What pressures on contact nodes of a part do to the coarse body, (n_free x k) [m]
  /// on its free degrees of freedom. @param pressure_n (n_nodes x k) [N].
  [[nodiscard]] Eigen::MatrixXd displaced_m(const ClampedPart& part,
                                            std::span<const std::int32_t> nodes,
                                            const Eigen::MatrixXd& pressure_n) const;

  /// What the part does, unloaded, where its cut moves with the coarse body, [m] on its
  /// free degrees of freedom. @param moved_m (n_free x k) of the coarse body.
  [[nodiscard]] Eigen::MatrixXd carried_m(const ClampedPart& part,
                                          const Eigen::MatrixXd& moved_m) const;

  /// Of a point in or near the coarse body.
  [[nodiscard]] TetLocator::Place place(const Eigen::Vector3d& p_m) const {
    return where_.place(p_m);
  }
  /// (3 x k) [m] there. @param moved_m (n_free x k) of the coarse body.
  [[nodiscard]] Eigen::MatrixXd at_m(const TetLocator::Place& place,
                                     const Eigen::MatrixXd& moved_m) const;

 private:
  [[nodiscard]] std::vector<TetLocator::Place> places_of_cut(
      const ClampedPart& part) const;
  [[nodiscard]] Eigen::MatrixXd carried_m(const ClampedPart& part,
                                          std::span<const TetLocator::Place> place,
                                          const Eigen::MatrixXd& moved_m) const;

  BodyModel model_;
  TetLocator where_;
};

}  // namespace palpate

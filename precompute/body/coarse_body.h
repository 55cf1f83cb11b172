// A body in coarse tets, which tells a part cut out of it how far the cut gives way.
//
// With the part clamped at its cut, and E the displacement of the part for one given on
// the cut (its harmonic extension), the compliance of the whole body between two
// contact nodes is exactly
//   G(x, y) = G_clamped(x, y) + x . E u_y,
// u_y being what the whole body's cut does under the unit pressure force at y. Here u_y
// is computed on the coarse body. It gives G(x, y) and G(y, x) slightly different
// values; the mean of both is used. Error: a clamped part is wrong by order a/R of the
// force (contact radius over cut radius); with the coarse body that is multiplied by
// the coarse body's own relative error of u_y at the distance R from the load.
#pragma once

#include <cstdint>
#include <span>

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
};

class CoarseBody {
 public:
  /// The body's surface, coarsened or refined to edges of about `edge_m` near the
  /// vertices that will be pressed and longer ones away from them, meshed and
  /// factorised.
  /// @throws InputError if it would have more than kMostTriangles triangles.
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

 private:
  BodyModel model_;
  TetLocator where_;
};

}  // namespace palpate

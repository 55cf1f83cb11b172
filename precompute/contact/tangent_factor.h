// A body's factor at a strained state, as a better preconditioner than that at rest.
//
// Near incompressibility the volume term's directions turn with the deformation, and
// the factor at rest knows nothing of it: conjugate gradients take hundreds of steps.
// This one has the elements' tangents of a state that Newton's method came through;
// contact is not in it.
#pragma once

#include <optional>

#include "precompute/contact/near_field.h"
#include "precompute/fem/cholesky_factor.h"

namespace palpate {

class TangentFactor {
 public:
  /// @param rest factor of `stiffness`, the body's K over its free unknowns (lower
  /// triangle). All must outlive it.
  TangentFactor(const CholeskyFactor& rest, const Stiffness& stiffness,
                const NearField& near)
      : rest_(rest), stiffness_(stiffness), near_(near) {}

  /// Factors K plus the change of the last NearField::linearise(). Where that is not
  /// positive definite the factor is as it was.
  void refresh();

  [[nodiscard]] bool ready() const { return factor_.has_value(); }
  /// Not ready until the next refresh().
  void drop() { factor_.reset(); }

  /// (K + change)^-1 r on the near nodes, with its source K u = r - change u. The pair
  /// leaves the far field in balance as well as the factor is exact. Only where
  /// ready().
  /// @param r (3 m), zero on held nodes.
  [[nodiscard]] NearState solve(const Eigen::VectorXd& r) const;

 private:
  const CholeskyFactor& rest_;
  const Stiffness& stiffness_;
  const NearField& near_;
  std::optional<CholeskyFactor> factor_;
  FactorPart part_;
  BlockMatrix change_;
};

}  // namespace palpate

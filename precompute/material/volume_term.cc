#include "precompute/material/volume_term.h"

#include "precompute/material/strain_invariants.h"

namespace palpate {

double volume_theta(VolumeMeasure measure, const Eigen::Matrix3d& F) {
  switch (measure) {
    case VolumeMeasure::kSmallTrace:
      return F.trace() - 3.0;
    case VolumeMeasure::kGreenTrace:
      return 0.5 * (F.squaredNorm() - 3.0);
    case VolumeMeasure::kJacobian:
      return F.determinant() - 1.0;
    case VolumeMeasure::kNone:
      break;
  }
  return 0.0;
}

VolumeResponse volume_response(VolumeMeasure measure, const Eigen::Matrix3d& F) {
  VolumeResponse response{volume_theta(measure, F), Eigen::Matrix3d::Zero(),
                          Tangent::Zero()};
  switch (measure) {
    case VolumeMeasure::kSmallTrace:
      response.gradient.setIdentity();
      break;
    case VolumeMeasure::kGreenTrace:
      response.gradient = F;
      response.curvature.setIdentity();
      break;
    case VolumeMeasure::kJacobian:
      response.gradient = cofactor(F);
      add_cofactor_derivative(F, 1.0, response.curvature);
      break;
    case VolumeMeasure::kNone:
      break;
  }
  return response;
}

}  // namespace palpate

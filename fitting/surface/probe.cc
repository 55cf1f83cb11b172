#include "fitting/surface/probe.h"

#include <cmath>

#include "fitting/curve/family_solve.h"
#include "fitting/curve/law_error.h"

namespace palpate {
namespace {

constexpr const char* kInContact = "already in contact: its depths are not known";
constexpr const char* kNotIdentified = "contact point not identified";

std::string reason_unusable(const FamilyFit& curve) {
  if (!curve.converged) {
    return "the fit did not converge";
  }
  if (curve.parameters[kFamilyContact].held == "assumed") {
    return kInContact;
  }
  return curve.contact_point_sd_m <= kContactSdShareMax * curve.depth_max_m
             ? ""
             : kNotIdentified;
}

}  // namespace

std::string reason_unusable(const SurfaceProbe& probe) {
  if (probe.fit.has(FitFlag::kEmptyRun)) {
    return "empty run";
  }
  if (probe.curve) {
    return reason_unusable(*probe.curve);
  }
  if (!probe.fit.converged) {
    return "the fit did not converge";
  }
  if (probe.fit.has(FitFlag::kAlreadyInContact)) {
    return kInContact;
  }
  return probe.fit.has(FitFlag::kContactPointNotIdentified) ? kNotIdentified : "";
}

double depth_max_m(const SurfaceProbe& probe) {
  return probe.curve ? probe.curve->depth_max_m : probe.fit.depth_max_m;
}

LogForces log_forces(const SurfaceProbe& probe, const Eigen::VectorXd& depth_m) {
  LogForces result;
  result.sd = probe.curve ? log_force_errors(*probe.curve, depth_m)
                          : log_force_errors(probe.approach, probe.fit, depth_m);
  result.value.resize(depth_m.size());
  for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
    result.value[k] =
        std::log(probe.curve ? family_point(*probe.curve, depth_m[k]).force
                             : contact_force_n(probe.fit, depth_m[k]));
  }
  return result;
}

std::string law_of(const SurfaceProbe& probe) {
  return probe.curve ? probe.curve->family : "power-law";
}

}  // namespace palpate

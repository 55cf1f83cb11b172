// What a run says of the virtual coupling that held its tool.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "runtime/contacts/virtual_tool.h"
#include "runtime/device/device.h"

namespace palpate {

struct CouplingReport {
  VirtualCoupling coupling;  ///< as rendered, softened where stiffness was limited
  double every_hand_n_s_per_m = 0.0;  ///< contact_stiffness.h
  double step_n = 0.0;  ///< [N] of the damper where a measured position makes a step
  VirtualToolAccount account;  ///< at the end
};

[[nodiscard]] CouplingReport coupling_on(const VirtualCoupling& coupling,
                                         const DeviceLimits& device, double hold_s);

/// Two sentences for people: what it is and holds, and where its energy is.
[[nodiscard]] std::string coupling_text(const CouplingReport& report);
[[nodiscard]] std::string coupling_energy_text(const CouplingReport& report);

[[nodiscard]] nlohmann::json as_json(const CouplingReport& report);

}  // namespace palpate

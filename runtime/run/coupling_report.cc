#include "runtime/run/coupling_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/slow/contact_stiffness.h"

namespace palpate {

CouplingReport coupling_on(const VirtualCoupling& coupling, const DeviceLimits& device,
                           double hold_s) {
  return {coupling,
          every_hand_n_s_per_m(coupling, hold_s, device.delay_s),
          coupling.damper_n_s_per_m * device.resolution_m / hold_s,
          {}};
}

std::string coupling_text(const CouplingReport& report) {
  const VirtualCoupling& c = report.coupling;
  return fmt::format(
      "tool of {:.4g} kg on springs of {:.4g} N/m and {:.4g} N m/rad, dampers of "
      "{:.4g} "
      "N s/m and {:.4g} N m s; the spring is the most that is felt; held dampers are "
      "passive for every hand from {:.3g} N s/m of the device's own on, and feel a "
      "step "
      "of its position by {:.2g} N",
      c.mass_kg, c.spring_n_per_m, c.spring_n_m_per_rad, c.damper_n_s_per_m,
      c.damper_n_m_s, report.every_hand_n_s_per_m, report.step_n);
}

std::string coupling_energy_text(const CouplingReport& report) {
  const VirtualToolAccount& a = report.account;
  return fmt::format(
      "of it kinetic {:.6g} mJ, springs {:.6g} mJ, dissipated by dampers {:.6g} mJ; "
      "largest residual of a tick {:.2g} J",
      1e3 * a.kinetic_j, 1e3 * a.spring_j, 1e3 * a.dissipated_j, a.residual_j);
}

nlohmann::json as_json(const CouplingReport& report) {
  const VirtualCoupling& c = report.coupling;
  const VirtualToolAccount& a = report.account;
  return {{"mass_kg", c.mass_kg},
          {"inertia_kg_m2", c.inertia_kg_m2.x()},
          {"spring_n_per_m", c.spring_n_per_m},
          {"spring_n_m_per_rad", c.spring_n_m_per_rad},
          {"damper_n_s_per_m", c.damper_n_s_per_m},
          {"damper_n_m_s", c.damper_n_m_s},
          {"every_hand_n_s_per_m", report.every_hand_n_s_per_m},
          {"step_n", report.step_n},
          {"kinetic_j", a.kinetic_j},
          {"spring_j", a.spring_j},
          {"dissipated_j", a.dissipated_j},
          {"residual_j", a.residual_j},
          {"taken_j", a.taken_j},
          {"iterations_max", a.iterations_max}};
}

}  // namespace palpate

#include "runtime/command/coupling_options.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

void add_coupling_options(Command command, CouplingFlags& flags) {
  command.add_flag("--coupling", flags.wanted,
                   "Of several contacts: hang the tool, with a mass of its own, on the "
                   "device by springs and dampers");
  const VirtualCoupling c;
  const auto add = [&](const char* flag, std::optional<double>& value, const char* what,
                       double otherwise) {
    command.add_option(flag, value, fmt::format("{} [{}]", what, otherwise));
  };
  add("--coupling-mass-kg", flags.mass_kg, "Mass of the coupled tool [kg]", c.mass_kg);
  add("--coupling-inertia-kg-m2", flags.inertia_kg_m2,
      "Its inertia about every axis [kg m^2]", c.inertia_kg_m2.x());
  add("--coupling-spring-n-per-m", flags.spring_n_per_m, "Spring [N/m]",
      c.spring_n_per_m);
  add("--coupling-spring-n-m-per-rad", flags.spring_n_m_per_rad,
      "Spring against turns [N m/rad]", c.spring_n_m_per_rad);
  add("--coupling-damper-n-s-per-m", flags.damper_n_s_per_m, "Damper [N s/m]",
      c.damper_n_s_per_m);
  add("--coupling-damper-n-m-s", flags.damper_n_m_s, "Damper against turns [N m s]",
      c.damper_n_m_s);
}

std::optional<VirtualCoupling> wanted_coupling(const CouplingFlags& flags) {
  VirtualCoupling c;
  bool given = false;
  const auto take = [&](const std::optional<double>& value, double& into) {
    given = given || value.has_value();
    into = value.value_or(into);
  };
  double inertia_kg_m2 = c.inertia_kg_m2.x();
  take(flags.mass_kg, c.mass_kg);
  take(flags.inertia_kg_m2, inertia_kg_m2);
  take(flags.spring_n_per_m, c.spring_n_per_m);
  take(flags.spring_n_m_per_rad, c.spring_n_m_per_rad);
  take(flags.damper_n_s_per_m, c.damper_n_s_per_m);
  take(flags.damper_n_m_s, c.damper_n_m_s);
  c.inertia_kg_m2.setConstant(inertia_kg_m2);
  if (given && !flags.wanted) {
    throw InputError("values of a coupling without --coupling: add it");
  }
  if (const char* wrong = check(c)) {
    throw InputError(fmt::format("--coupling: {}", wrong));
  }
  return flags.wanted ? std::optional(c) : std::nullopt;
}

}  // namespace palpate

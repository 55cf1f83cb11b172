// Options of the subcommands that may hang a tool on its device by a virtual coupling.
#pragma once

#include <optional>

#include "formats/base/command_line.h"
#include "runtime/contacts/virtual_coupling.h"

namespace palpate {

/// What the command line says of a coupling.
struct CouplingFlags {
  bool wanted = false;
  std::optional<double> mass_kg;
  std::optional<double> inertia_kg_m2;  ///< about every axis
  std::optional<double> spring_n_per_m;
  std::optional<double> spring_n_m_per_rad;
  std::optional<double> damper_n_s_per_m;
  std::optional<double> damper_n_m_s;
};

/// --coupling and what goes with it. @param flags must outlive the command.
void add_coupling_options(Command command, CouplingFlags& flags);

/// None without --coupling. @throws InputError for its values without it, and for
/// those that check() refuses.
[[nodiscard]] std::optional<VirtualCoupling> wanted_coupling(
    const CouplingFlags& flags);

}  // namespace palpate

// How stiff the contacts of a tool are together, where its body is stiffest.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/response/response_table.h"
#include "runtime/account/local_model.h"
#include "runtime/contacts/virtual_coupling.h"
#include "runtime/device/stability_margin.h"
#include "runtime/device/wrench_margin.h"
#include "runtime/slow/contact_elements.h"

namespace palpate {

/// Where a table of responses is stiffest, and what couples contacts there.
struct StiffestNode {
  RenderedStiffness stiffness;
  ContactRow row;  ///< of the node; zero where there is none
};

/// Of the responses of that name, at forces up to force_max_n [N] > 0.
using StiffestOfTable =
    std::function<StiffestNode(const std::string& table, double force_max_n)>;

/// By contact of a tool, each of its own radius. @param force_max_n [N] > 0 that they
/// share.
[[nodiscard]] std::vector<StiffestNode> stiffest_by_contact(
    const ToolShape& tool, double force_max_n, const StiffestOfTable& stiffest);

/// In memory, by that model.
[[nodiscard]] std::vector<StiffestNode> stiffest_by_contact(
    const ResponseDatabase& database, const ResponseTable& tool, LocalModel model,
    double force_max_n);

/// Each contact is as stiff as the responses of its radius are anywhere, k_i. Between
/// contacts stands the row of compliance of the node where the stiffest is:
/// (diag(1/k_i) + C)^-1. Where that is not positive definite, diag(k_i). An estimate:
/// elsewhere contacts couple otherwise.
[[nodiscard]] ContactStiffness contact_stiffness(const PressingTool& tool,
                                                 std::span<const StiffestNode> contact);

/// Of a virtual coupling's spring, alike in every direction: the most that a device
/// feels, however stiff or soft the contacts are. The tool's mass hardly moves within a
/// tick, so that what is held from one to the next is this spring even in free air.
/// Turns are not checked.
[[nodiscard]] WrenchMargin coupling_margin(const VirtualCoupling& coupling,
                                           const DeviceLimits& device, double hold_s);

/// [N s/m] Damping of a device with which no passive hand gets energy out of a stuck
/// tool's held spring and damper. The damping is b > k_t (T/2 + delay) + b_t (Colgate &
/// Schenkel 1997, b > K T / 2 + |B|). A damper needs far more than its spring. Short of
/// that damping, a device's mass and a hand's own damping must do. Mass and hand do
/// where T b_t is well below the mass.
[[nodiscard]] double every_hand_n_s_per_m(const VirtualCoupling& coupling,
                                          double hold_s, double delay_s);

/// Sums over all contacts of a tool, as if each pressed a body of its own. The sum is
/// more than the contacts have together where they sink one another, as contacts on one
/// side of a body do. The sum is no bound where one contact lifts another.
[[nodiscard]] RenderedStiffness stiffness_of_contacts(
    std::span<const StiffestNode> contact);

}  // namespace palpate

#include "runtime/view/steered_contacts.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <utility>

#include "formats/base/error.h"
#include "runtime/slow/contact_elements.h"

namespace palpate {
namespace {

// Forces of all contacts by port.
PortWrenches sum_of(CoupledField& field, const CoupledState& state) {
  PortWrenches sum;
  for (int i = 0; i < state.set.count; ++i) {
    const auto port =
        static_cast<std::size_t>(state.set.sphere[static_cast<std::size_t>(i)].port);
    const ContactReading reading = read_contact(field, state.set, state.surfaces, i);
    const Eigen::Vector3d arm =
        centre_of(state.set, state.latest.pose, i) - state.latest.pose[port].position_m;
    sum[port].force_n += reading.force_n;
    sum[port].torque_n_m += arm.cross(reading.force_n);
  }
  return sum;
}

}  // namespace

SteeredContacts::SteeredContacts(const ResponseDatabase& database,
                                 const std::vector<const ResponseTable*>& tools,
                                 const FastConfig& config, KeptSurface surface)
    : database_(database),
      config_(config),
      surface_(std::move(surface)),
      adjusted_(std::make_shared<AdjustedContacts>(database, tools)) {
  if (config_.model != LocalModel::kPotential) {
    throw InputError("several contacts are rendered by the model \"potential\" alone");
  }
  for (const ResponseTable* table : response_tables(database, tools)) {
    dents_.emplace_back(*table);
  }
  begin();
}

void SteeredContacts::begin() {
  body_ = std::make_unique<SeveralContacts>(adjusted_, config_,
                                            ContactsHeld{.torque_felt = true});
  body_->begin_with(surface_);
}

void SteeredContacts::set(const ViewRequest& request) {
  if (request.model && *request.model != LocalModel::kPotential) {
    throw InputError("several contacts are rendered by the model \"potential\" alone");
  }
  bool changed = false;
  if (request.stiffness_scale) {
    adjusted_->set_stiffness_scale(*request.stiffness_scale);
    changed = true;
  }
  if (request.friction || request.database_friction) {
    adjusted_->set_friction(request.friction);
    changed = true;
  }
  if (request.coupled) {
    adjusted_->set_coupled(*request.coupled);
    changed = true;
  }
  if (changed) {
    body_->renew();
  }
}

std::int32_t SteeredContacts::triangle_under(std::size_t hand,
                                             const TickRecord& /*latest*/) const {
  for (int i = 0; i < body_->contacts(); ++i) {
    const BodyContact contact = body_->contact_at(i);
    if (contact.at.touching && contact.hand == static_cast<int>(hand)) {
      return contact.at.triangle;
    }
  }
  return -1;
}

// The rows of the elements in use are exchanged while this lasts.
std::optional<PortWrenches> SteeredContacts::elastic(bool coupled) {
  CoupledState& state = body_->state();
  if (is_alone(state.set) || !state.sampled) {
    return std::nullopt;
  }
  CoupledField& field = *scratch_;
  // The same places in a scratch field: delta_0 = 0, C whole, and rows of compliance
  // that couple the contacts or do not.
  field = state.model.field;
  field.shift_m = 0.0;
  field.equilibrium.scale = 1.0;
  field.equilibrium.factor.sound = false;
  std::vector<std::array<ContactRow, 3>> kept(kContactsMax);
  const auto exchange = [&](int i, const std::array<ContactRow, 3>& row) {
    const int slot = field.at[static_cast<std::size_t>(i)].place.slot;
    return std::exchange(state.surfaces[i].row[static_cast<std::size_t>(slot)], row);
  };
  for (int i = 0; i < state.set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const int slot = field.at[self].place.slot;
    if (slot >= 0) {
      const std::int32_t triangle =
          state.surfaces[i].cache.triangle[static_cast<std::size_t>(slot)];
      kept[self] = exchange(i, adjusted_->element(i, triangle, coupled).row);
      // So that enter() reads the exchanged rows.
      field.at[self].slot = -1;
      field.at[self].stored_at = 0;
    }
    enter(field, state.set, state.surfaces, i);
  }
  set_places(field, state.set, state.surfaces, Keep::kNo);
  const bool solved = settle_contacts(field, state.set, state.surfaces);
  const PortWrenches sum = sum_of(field, state);
  for (int i = 0; i < state.set.count; ++i) {
    if (field.at[static_cast<std::size_t>(i)].place.slot >= 0) {
      (void)exchange(i, kept[static_cast<std::size_t>(i)]);
    }
  }
  return solved ? std::optional(sum) : std::nullopt;
}

std::vector<ViewTouch> SteeredContacts::touches() const {
  std::vector<ViewTouch> all;
  for (int i = 0; i < body_->contacts(); ++i) {
    if (const BodyContact contact = body_->contact_at(i); contact.at.triangle >= 0) {
      all.push_back(touch_at(database_, contact));
    }
  }
  return all;
}

// The deepest of what the contacts of all tables have left at a node.
std::vector<NodeDent> SteeredContacts::dents() const {
  std::map<std::int32_t, double> by_node;
  for (std::size_t t = 0; t < dents_.size(); ++t) {
    for (const NodeDent& dent :
         dents_[t].at(surface_dents(state(), static_cast<int>(t)),
                      adjusted_->stiffness_scale())) {
      double& depth_m = by_node[dent.node];
      depth_m = std::max(depth_m, dent.depth_m);
    }
  }
  std::vector<NodeDent> all;
  for (const auto& [node, depth_m] : by_node) {
    all.push_back({node, depth_m});
  }
  return all;
}

void SteeredContacts::show(const std::vector<SteeredHand>& hand, ViewFrame& frame) {
  ViewHands& all = frame.hands.emplace();
  all.touch = touches();
  all.coupled = adjusted_->coupled();
  all.scaled = body_->scaled();
  // The force as rendered by one body, beside the sum of contacts that do not couple.
  const std::optional<PortWrenches> coupled = elastic(true);
  const std::optional<PortWrenches> added_up = elastic(false);
  for (std::size_t i = 0; i < hand.size(); ++i) {
    const RecordedHand at = hand_in(frame.now, i);
    ViewHand& shown = all.hand.emplace_back();
    shown = {.tool_m = Eigen::Vector3d(at.position_m.data()),
             .turn = hand[i].pointer.target().turn,
             .hand_m = hand[i].pointer.target().position_m,
             .pointer_m = hand[i].pointer.pointer_m(),
             .holding = hand[i].holding,
             .force_n = Eigen::Vector3d(at.force_n.data()),
             .torque_n_m = Eigen::Vector3d(at.torque_n_m.data())};
    if (coupled && added_up) {
      shown.coupled_n = (*coupled)[i].force_n;
      shown.added_up_n = (*added_up)[i].force_n;
    }
  }
  frame.dents = dents();
}

void SteeredContacts::tell(ViewSettings& settings) const {
  settings.stiffness_scale = adjusted_->stiffness_scale();
  settings.friction = adjusted_->friction();
}

}  // namespace palpate

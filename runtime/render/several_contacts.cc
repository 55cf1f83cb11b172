#include "runtime/render/several_contacts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

// Faster than a wrist: one wrong orientation would be answered with the force of a pose
// in which the tool is not.
constexpr double kWristRadPerS = 40.0;
constexpr double kStillRad = 0.05;  // noise of readings a few microseconds apart

PortPose pose_of(const DeviceReading& reading) noexcept {
  return {reading.position_m, reading.turn.toRotationMatrix()};
}

// A hand that is not there stays where a pose begins.
PortPoses poses_of(const HandReadings& reading) noexcept {
  PortPoses pose;
  for (std::size_t hand = 0; hand < reading.size(); ++hand) {
    pose[hand] = pose_of(reading[hand]);
  }
  return pose;
}

const SurfaceMemory& memory_of(const CoupledState& state, int i) {
  return is_alone(state.set) ? state.alone->memory : state.surfaces[i].memory;
}

bool relaxes(const CoupledState& state) {
  bool any = false;
  for (int i = 0; i < state.set.count; ++i) {
    any = any || memory_of(state, i).times.terms > 0;
  }
  return any;
}

bool yields(const CoupledState& state) {
  bool any = false;
  for (int i = 0; i < state.set.count; ++i) {
    any = any || memory_of(state, i).yields;
  }
  return any;
}

// Sites without room, in tables that contacts share.
std::uint64_t not_yielded(const CoupledState& state) {
  std::uint64_t sum = 0;
  for (int i = 0; i < state.set.count; ++i) {
    sum += memory_of(state, i).yielded.refused;
  }
  return sum;
}

std::uint64_t forgotten(const CoupledState& state) {
  std::uint64_t sum = 0;
  for (int i = 0; i < state.set.count; ++i) {
    sum += memory_of(state, i).forgotten;
  }
  return sum;
}

// The elements that contact i holds, that which is in use first.
std::vector<ArrivalRecord> held_by(const CoupledState& state, int i) {
  const ElementCache& cache = state.surfaces[i].cache;
  std::vector<ArrivalRecord> held;
  for (int slot = 0; slot < kCacheSlots; ++slot) {
    const auto s = static_cast<std::size_t>(slot);
    if (cache.stored_at[s] == 0 || find(cache, cache.triangle[s]) != slot) {
      continue;
    }
    const Element& element = cache.element[s];
    held.insert(slot == cache.pinned ? held.begin() : held.end(),
                {.sequence = static_cast<std::int64_t>(element.sequence),
                 .sent_ns = element.sent_ns,
                 .triangle = cache.triangle[s],
                 .active = static_cast<std::uint8_t>(slot == cache.newest_active),
                 .contact = i});
  }
  return held;
}

}  // namespace

SeveralContacts::SeveralContacts(const ResponseDatabase& database,
                                 std::span<const ResponseTable* const> tools,
                                 const FastConfig& config, const ContactsHeld& held)
    : SeveralContacts(
          std::make_shared<ContactStream>(database, tools, held.force_scale), config,
          held) {}

SeveralContacts::SeveralContacts(std::shared_ptr<ContactSender> stream,
                                 const FastConfig& config, const ContactsHeld& held)
    : stream_(std::move(stream)),
      storage_(stream_->set(), config),
      torque_felt_(held.torque_felt),
      watch_turns_(held.watch_turns),
      watch_(held.watch) {
  if (!held.coupling) {
    return;
  }
  virtual_tool_ = std::make_unique<VirtualTool>();
  virtual_tool_->torque_felt = torque_felt_;
  if (const char* wrong = couple(*virtual_tool_, state(), *held.coupling)) {
    throw InputError(fmt::format("coupling: {}", wrong));
  }
}

void SeveralContacts::renew() {
  forget_what_is_under_way();
  if (is_alone(state().set)) {
    return;
  }
  for (int i = 0; i < state().set.count; ++i) {
    for (const ArrivalRecord& held : held_by(state(), i)) {
      // Else it gave way to the copy of the one in use.
      if (find(state().surfaces[i].cache, held.triangle) >= 0) {
        accept(held);
      }
    }
  }
  if (state().sampled) {
    (void)palpate::step(state(), state().latest, 0.0);
  }
}

void SeveralContacts::forget_what_is_under_way() noexcept {
  while (fifo_->front() != nullptr) {
    fifo_->pop();
  }
  forgotten_.store(true);
}

bool SeveralContacts::take_in(ArrivalRecord& arrival) noexcept {
  const ContactElement* message = fifo_->front();
  if (message == nullptr) {
    return false;
  }
  palpate::accept(state(), *message);
  const Element& element = message->element;
  arrival.contact = message->contact;
  arrival.sequence = static_cast<std::int64_t>(element.sequence);
  arrival.sent_ns = element.sent_ns;
  arrival.triangle = element.triangle;
  arrival.active = element.active ? std::uint8_t{1} : std::uint8_t{0};
  fifo_->pop();
  return true;
}

void SeveralContacts::accept(const ArrivalRecord& arrival) {
  std::optional<ContactElement> message =
      stream_->element_of(arrival.contact, arrival.triangle);
  if (!message) {
    throw_no_element(arrival);
  }
  message->element.sequence = static_cast<std::uint64_t>(arrival.sequence);
  message->element.sent_ns = arrival.sent_ns;
  message->element.active = arrival.active != 0;
  palpate::accept(state(), *message);
}

void SeveralContacts::watch_turns(const HandReadings& reading) noexcept {
  for (std::size_t hand = 0; stepped_ && hand < hands(); ++hand) {
    const double dt_s =
        std::max(0.0, seconds_in(reading[hand].time_ns - last_[hand].time_ns));
    const double turned_rad = reading[hand].turn.angularDistance(last_[hand].turn);
    if (!(turned_rad <= kStillRad + kWristRadPerS * dt_s)) {
      raise(Fault::kJump);
    }
  }
  last_ = reading;
  stepped_ = true;
}

WrenchCommand SeveralContacts::step(const HandReadings& reading, double dt_s) noexcept {
  PoseSample sample;
  sample.time_ns = reading[0].time_ns;
  if (watch_turns_ && !is_alone(state().set)) {
    watch_turns(reading);
  }
  sample.pose = poses_of(reading);
  if (is_alone(state().set) && !torque_felt_) {
    // No change of the model could take its turns.
    sample.pose[0].rotation.setIdentity();
  }
  const WrenchCommand command =
      virtual_tool_ != nullptr ? palpate::step(*virtual_tool_, state(), sample, dt_s)
      : torque_felt_           ? palpate::step(state(), sample, dt_s)
                               : step_unturned(state(), sample, dt_s);
  wrench_ = command.wrench;
  scaled_ = command.scaled;
  return command;
}

void SeveralContacts::account(const WrenchCommand& command,
                              RenderReport& report) const noexcept {
  if (relaxes(storage_.state())) {
    report.relaxes = true;
    report.memory_j = command.memory_j;
    report.memory_max_j = std::max(report.memory_max_j, command.memory_j);
    if (command.carried_n > report.carried_max_n) {
      report.carried_max_n = command.carried_n;
      report.carried_of_n = command.wrench[0].force_n.norm();
    }
    report.forgotten = forgotten(storage_.state());
  }
  report.yields = yields(storage_.state());
  report.not_yielded = not_yielded(storage_.state());
  report.yielded_j = command.yielded_j;
  if (virtual_tool_ != nullptr) {
    report.coupling = virtual_tool_->account;
  }
}

void SeveralContacts::delivered(const PortWrenches& made) noexcept {
  if (virtual_tool_ != nullptr) {
    palpate::delivered(*virtual_tool_, state(), made);
  } else {
    palpate::delivered(state(), made);
  }
}

void SeveralContacts::show(const HandReadings& reading) noexcept {
  const CoupledState& s = storage_.state();
  seen_.count = s.set.count;
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    seen_.hand[hand] = {s.latest.pose[hand], pose_of(reading[hand]), wrench_[hand]};
  }
  seen_.held = virtual_tool_ != nullptr;
  seen_.scaled = scaled_;
  for (int i = 0; i < s.set.count; ++i) {
    seen_.contact[static_cast<std::size_t>(i)] = contact_at(i);
  }
  watch_->write(seen_);
}

void SeveralContacts::publish(const HandReadings& reading,
                              std::int64_t ticks) noexcept {
  if (watch_ != nullptr) {
    show(reading);
  }
  ContactToolState at = contact_tool_state(
      storage_.state(), static_cast<std::uint64_t>(std::max<std::int64_t>(1, ticks)));
  if (ticks == 0) {  // no step has put the contacts anywhere
    const CoupledSet& set = storage_.state().set;
    const PortPoses pose = poses_of(reading);
    for (int i = 0; i < set.count; ++i) {
      at.contact[static_cast<std::size_t>(i)].position_m = centre_of(set, pose, i);
    }
  }
  tool_->write(at);
}

BodyContact SeveralContacts::contact_at(int i) const noexcept {
  const CoupledState& s = storage_.state();
  const ContactSphere& sphere = s.set.sphere[static_cast<std::size_t>(i)];
  return {.hand = sphere.port,
          .radius_m = sphere.radius_m,
          .table = sphere.table,
          .at = contact_place(s, i)};
}

Fault SeveralContacts::fault() const noexcept {
  const CoupledState& s = storage_.state();
  return is_alone(s.set) ? s.alone->safety.fault : s.safety.fault;
}

std::int32_t SeveralContacts::triangle() const noexcept {
  const CoupledState& s = storage_.state();
  for (int i = 0; i < s.set.count; ++i) {
    const ContactPlace at = contact_place(s, i);
    if (at.touching) {
      return at.triangle;
    }
  }
  return -1;
}

std::vector<SurfaceDent> SeveralContacts::dents() const {
  std::vector<SurfaceDent> all;
  for (int table = 0; table < kResponseTables; ++table) {
    const std::vector<SurfaceDent> some = surface_dents(storage_.state(), table);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::optional<std::size_t> SeveralContacts::serve(std::int64_t now_ns) {
  if (!tool_->fetch()) {
    return std::nullopt;
  }
  if (forgotten_.exchange(false)) {
    sent_ = {};
  }
  return stream_->update(tool_->latest(), now_ns, *fifo_, sent_);
}

FastContact SeveralContacts::contact() const noexcept {
  const CoupledState& s = storage_.state();
  FastContact at;
  at.time_ns = s.latest.time_ns;
  at.tool_m = s.latest.pose[0].position_m;
  at.in_contact = s.in_contact;
  double most = -1.0;
  for (int i = 0; i < s.set.count; ++i) {
    const ContactPlace place = contact_place(s, i);
    if (place.triangle >= 0 && place.force_n.norm() > most) {
      most = place.force_n.norm();
      at.point_m = place.point_m;
      at.normal = place.normal;
      at.triangle = place.triangle;
      at.starved = place.starved;
    }
  }
  return at;
}

void SeveralContacts::restart() noexcept {
  palpate::restart(state());
  stepped_ = false;
  forget_what_is_under_way();
}

}  // namespace palpate

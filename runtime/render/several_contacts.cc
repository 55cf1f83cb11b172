#include "runtime/render/several_contacts.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

// Faster than a wrist: one wrong orientation would be answered with the force of a pose
// in which the tool is not.
constexpr double kWristRadPerS = 40.0;
constexpr double kStillRad = 0.05;  // noise of readings a few microseconds apart

ContactStream stream_of(const ResponseDatabase& database, const ResponseTable& tool,
                        double force_scale) {
  const ResponseTable* const one[] = {&tool};
  return ContactStream(database, one, force_scale);
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

std::uint64_t forgotten(const CoupledState& state) {
  std::uint64_t sum = 0;
  for (int i = 0; i < state.set.count; ++i) {
    sum += memory_of(state, i).forgotten;
  }
  return sum;
}

}  // namespace

SeveralContacts::SeveralContacts(const ResponseDatabase& database,
                                 const ResponseTable& tool, const FastConfig& config,
                                 double force_scale,
                                 const std::optional<VirtualCoupling>& coupling,
                                 ContactsWatch* watch)
    : stream_(stream_of(database, tool, force_scale)),
      storage_(stream_.set(), config),
      watch_(watch) {
  if (!coupling) {
    return;
  }
  hung_ = std::make_unique<HungTool>();
  hung_->torque_felt = false;
  if (const char* wrong = hang(*hung_, state(), *coupling)) {
    throw InputError(fmt::format("coupling: {}", wrong));
  }
}

bool SeveralContacts::take_in(ArrivalRecord& arrival) noexcept {
  const ContactElement* message = fifo_->front();
  if (message == nullptr) {
    return false;
  }
  accept(state(), *message);
  const Element& element = message->element;
  arrival.sequence = static_cast<std::int64_t>(element.sequence);
  arrival.sent_ns = element.sent_ns;
  arrival.triangle = element.triangle;
  arrival.active = element.active ? std::uint8_t{1} : std::uint8_t{0};
  fifo_->pop();
  return true;
}

void SeveralContacts::watch_turn(const DeviceReading& reading) noexcept {
  const double dt_s =
      std::max(0.0, static_cast<double>(reading.time_ns - last_.time_ns) /
                        kNanosecondsPerSecond);
  const double turned_rad = reading.turn.angularDistance(last_.turn);
  if (stepped_ && !(turned_rad <= kStillRad + kWristRadPerS * dt_s)) {
    raise(Fault::kJump);
  }
  last_ = reading;
  stepped_ = true;
}

FastCommand SeveralContacts::step(const DeviceReading& reading, double dt_s) noexcept {
  CoupledSample sample;
  sample.pose[0].position_m = reading.position_m;
  sample.time_ns = reading.time_ns;
  if (!is_alone(state().set)) {
    watch_turn(reading);
    sample.pose[0].rotation = reading.turn.toRotationMatrix();
  }
  const CoupledCommand all = hung_ != nullptr
                                 ? palpate::step(*hung_, state(), sample, dt_s)
                                 : step_unturned(state(), sample, dt_s);
  wrench_ = all.wrench;
  scaled_ = all.scaled;
  FastCommand command;
  command.force_n = all.wrench[0].force_n;
  command.in_contact = all.in_contact;
  command.starved = all.starved;
  command.extrapolated = all.extrapolated;
  command.depth_m = all.depth_m;
  command.stored_j = all.stored_j;
  command.tank_j = all.tank_j;
  command.memory_j = all.memory_j;
  command.carried_n = all.carried_n;
  command.dissipated_j = all.dissipated_j;
  command.yielded_j = all.yielded_j;
  command.relaxed_shift_m = all.relaxed_shift_m;
  command.fault = all.fault;
  return command;
}

void SeveralContacts::account(const FastCommand& command,
                              RenderReport& report) const noexcept {
  if (relaxes(storage_.state())) {
    report.relaxes = true;
    report.memory_j = command.memory_j;
    report.memory_max_j = std::max(report.memory_max_j, command.memory_j);
    if (command.carried_n > report.carried_max_n) {
      report.carried_max_n = command.carried_n;
      report.carried_of_n = command.force_n.norm();
    }
    report.forgotten = forgotten(storage_.state());
  }
  report.yields = yields(storage_.state());
  report.yielded_j = command.yielded_j;
  if (hung_ != nullptr) {
    report.coupling = hung_->account;
  }
}

void SeveralContacts::delivered(const Eigen::Vector3d& force_n) noexcept {
  PortWrenches made = wrench_;
  made[0].force_n = force_n;
  if (hung_ != nullptr) {
    palpate::delivered(*hung_, state(), made);
  } else {
    palpate::delivered(state(), made);
  }
}

void SeveralContacts::show(const DeviceReading& reading) noexcept {
  const CoupledState& s = storage_.state();
  seen_.count = s.set.count;
  seen_.tool = s.latest.pose[0];
  seen_.device = {reading.position_m, reading.turn.toRotationMatrix()};
  seen_.wrench = wrench_[0];
  seen_.hung = hung_ != nullptr;
  seen_.scaled = scaled_;
  for (int i = 0; i < s.set.count; ++i) {
    seen_.contact[static_cast<std::size_t>(i)] = contact_place(s, i);
  }
  watch_->write(seen_);
}

void SeveralContacts::publish(const DeviceReading& reading,
                              std::int64_t ticks) noexcept {
  if (watch_ != nullptr) {
    show(reading);
  }
  tool_->write(contact_tool_state(storage_.state(), static_cast<std::uint64_t>(ticks)));
}

Fault SeveralContacts::fault() const noexcept {
  const CoupledState& s = storage_.state();
  return is_alone(s.set) ? s.alone->safety.fault : s.safety.fault;
}

std::int32_t SeveralContacts::triangle() const noexcept {
  const CoupledState& s = storage_.state();
  for (int i = 0; i < s.set.count; ++i) {
    const CoupledContactPlace at = contact_place(s, i);
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

bool SeveralContacts::serve(std::int64_t now_ns) {
  if (!tool_->fetch()) {
    return false;
  }
  (void)stream_.update(tool_->latest(), now_ns, *fifo_, sent_);
  return true;
}

void SeveralContacts::begin_with(const std::vector<YieldedRow>& rows) {
  if (!rows.empty()) {
    throw InputError(
        "a tool of several contacts begins on a fresh body: leave out --surface-in");
  }
}

}  // namespace palpate

#include "runtime/render/several_contacts.h"

#include "formats/base/error.h"

namespace palpate {
namespace {

ContactStream stream_of(const ResponseDatabase& database, const ResponseTable& tool,
                        double force_scale) {
  const ResponseTable* const one[] = {&tool};
  return ContactStream(database, one, force_scale);
}

}  // namespace

SeveralContacts::SeveralContacts(const ResponseDatabase& database,
                                 const ResponseTable& tool, const FastConfig& config,
                                 double force_scale)
    : stream_(stream_of(database, tool, force_scale)),
      storage_(stream_.set(), config) {}

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

FastCommand SeveralContacts::step(const DeviceReading& reading, double dt_s) noexcept {
  CoupledSample sample;
  sample.pose[0].position_m = reading.position_m;
  sample.time_ns = reading.time_ns;
  const CoupledCommand all = palpate::step(state(), sample, dt_s);
  wrench_ = all.wrench;
  FastCommand command;
  command.force_n = all.wrench[0].force_n;
  command.in_contact = all.in_contact;
  command.starved = all.starved;
  command.extrapolated = all.extrapolated;
  command.depth_m = all.depth_m;
  command.stored_j = all.stored_j;
  command.tank_j = all.tank_j;
  command.dissipated_j = all.dissipated_j;
  command.relaxed_shift_m = all.relaxed_shift_m;
  command.fault = all.fault;
  return command;
}

void SeveralContacts::delivered(const Eigen::Vector3d& force_n) noexcept {
  PortWrenches made = wrench_;
  made[0].force_n = force_n;
  palpate::delivered(state(), made);
}

void SeveralContacts::publish(const DeviceReading& /*reading*/,
                              std::int64_t ticks) noexcept {
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

bool SeveralContacts::serve(std::int64_t now_ns) {
  if (!tool_->fetch()) {
    return false;
  }
  (void)stream_.update(tool_->latest(), now_ns, *fifo_, sent_);
  return true;
}

void SeveralContacts::begin_with(const std::vector<YieldedRow>& rows) {
  if (!rows.empty()) {
    throw InputError("several contacts are rendered on a body that does not yield");
  }
}

}  // namespace palpate

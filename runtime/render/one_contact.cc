#include "runtime/render/one_contact.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

OneContact::OneContact(const FastConfig& config, ElementSender& stream)
    : stream_(stream) {
  if (const char* wrong = check(config)) {
    throw InputError(fmt::format("fast step: {}", wrong));
  }
  state_.config = config;
}

bool OneContact::take_in(ArrivalRecord& arrival) noexcept {
  const Element* element = exchange_->elements.front();
  if (element == nullptr) {
    return false;
  }
  accept(state_, *element);
  arrival.sequence = static_cast<std::int64_t>(element->sequence);
  arrival.sent_ns = element->sent_ns;
  arrival.triangle = element->triangle;
  arrival.active = element->active ? std::uint8_t{1} : std::uint8_t{0};
  exchange_->elements.pop();
  return true;
}

FastCommand OneContact::step(const DeviceReading& reading, double dt_s) noexcept {
  return palpate::step(
      state_, {.position_m = reading.position_m, .time_ns = reading.time_ns}, dt_s);
}

void OneContact::publish(const DeviceReading& reading, std::int64_t ticks) noexcept {
  const FastContact at = contact(state_);
  exchange_->tool.write({.sequence = static_cast<std::uint64_t>(ticks),
                         .time_ns = reading.time_ns,
                         .position_m = reading.position_m,
                         .triangle = at.triangle,
                         .in_contact = at.in_contact});
}

void OneContact::account(const FastCommand& command,
                         RenderReport& report) const noexcept {
  if (!remembers(state_.memory)) {
    return;
  }
  RenderReport& r = report;
  r.relaxes = state_.memory.times.terms > 0;
  r.memory_j = command.memory_j;
  r.memory_max_j = std::max(r.memory_max_j, command.memory_j);
  if (command.carried_n > r.carried_max_n) {
    r.carried_max_n = command.carried_n;
    r.carried_of_n = command.force_n.norm();
  }
  r.forgotten = state_.memory.forgotten;
  r.yields = state_.memory.yields;
  r.yielded_j = command.yielded_j;
  r.not_yielded = state_.memory.yielded.refused;
}

bool OneContact::serve(std::int64_t now_ns) {
  if (!exchange_->tool.fetch()) {
    return false;
  }
  stream_.update(exchange_->tool.latest(), now_ns, exchange_->elements);
  return true;
}

}  // namespace palpate

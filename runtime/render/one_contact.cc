#include "runtime/render/one_contact.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

namespace {

NeedleReport needle_report(const NeedleState& needle) {
  NeedleReport r{.punctures = true,
                 .channels = needle.channels,
                 .broken = needle.broken,
                 .refused = needle.refused,
                 .crack_j = needle.crack_j,
                 .released_j = needle.released_j,
                 .shaft_j = needle.shaft_j};
  for (std::int32_t i = 0; i < needle.channels; ++i) {
    r.deepest_m = std::max<double>(r.deepest_m,
                                   needle.channel[static_cast<std::size_t>(i)].depth_m);
  }
  return r;
}

}  // namespace

OneContact::OneContact(const FastConfig& config, ElementSender& stream,
                       NeedleWatch* watch, FrictionWatch* rubbed)
    : stream_(stream), watch_(watch), rubbed_(rubbed) {
  state_.config = config;
  state_.config.puncture = stream.puncture();
  if (const char* wrong = check(state_.config)) {
    throw InputError(fmt::format("fast step: {}", wrong));
  }
}

bool OneContact::take_in(ArrivalRecord& arrival) noexcept {
  const Element* element = exchange_->elements.front();
  if (element == nullptr) {
    return false;
  }
  palpate::accept(state_, *element);
  arrival.sequence = static_cast<std::int64_t>(element->sequence);
  arrival.sent_ns = element->sent_ns;
  arrival.triangle = element->triangle;
  arrival.active = element->active ? std::uint8_t{1} : std::uint8_t{0};
  exchange_->elements.pop();
  return true;
}

void OneContact::accept(const ArrivalRecord& arrival) {
  std::optional<Element> element = stream_.element_of(arrival.triangle);
  if (!element) {
    throw_no_element(arrival);
  }
  element->sequence = static_cast<std::uint64_t>(arrival.sequence);
  element->sent_ns = arrival.sent_ns;
  element->active = arrival.active != 0;
  palpate::accept(state_, *element);
}

WrenchCommand OneContact::step(const HandReadings& reading, double dt_s) noexcept {
  return as_wrench(palpate::step(
      state_, {.position_m = reading[0].position_m, .time_ns = reading[0].time_ns},
      dt_s));
}

void OneContact::publish(const HandReadings& reading, std::int64_t ticks) noexcept {
  if (watch_ != nullptr) {
    watch_->write(needle());
  }
  if (rubbed_ != nullptr) {
    static_cast<void>(rubbed_->push(friction()));  // a page that is late misses some
  }
  exchange_->tool.write({.sequence = static_cast<std::uint64_t>(ticks),
                         .time_ns = reading[0].time_ns,
                         .position_m = reading[0].position_m,
                         .triangle = triangle(),
                         .in_contact = state_.in_contact});
}

void OneContact::account(const WrenchCommand& command,
                         RenderReport& report) const noexcept {
  if (is_needle(state_.config.puncture)) {
    report.needle = needle_report(state_.needle);
  }
  if (!remembers(state_.memory)) {
    return;
  }
  RenderReport& r = report;
  r.relaxes = state_.memory.times.terms > 0;
  r.memory_j = command.memory_j;
  r.memory_max_j = std::max(r.memory_max_j, command.memory_j);
  if (command.carried_n > r.carried_max_n) {
    r.carried_max_n = command.carried_n;
    r.carried_of_n = command.wrench[0].force_n.norm();
  }
  r.forgotten = state_.memory.forgotten;
  r.yields = state_.memory.yields;
  r.yielded_j = command.yielded_j;
  r.not_yielded = state_.memory.yielded.refused;
}

std::optional<std::size_t> OneContact::serve(std::int64_t now_ns) {
  if (!exchange_->tool.fetch()) {
    return std::nullopt;
  }
  return stream_.update(exchange_->tool.latest(), now_ns, exchange_->elements);
}

void OneContact::restart() noexcept {
  const FastConfig config = state_.config;
  kept_ = state_.memory.yielded;
  NeedleState needle = state_.needle;
  std::construct_at(&state_);
  state_.config = config;
  state_.memory.yielded = kept_;
  needle.active = -1;
  std::for_each(needle.channel.begin(), needle.channel.end(), let_go);
  state_.needle = needle;
  // What is under way is of the place before.
  while (exchange_->elements.front() != nullptr) {
    exchange_->elements.pop();
  }
}

}  // namespace palpate

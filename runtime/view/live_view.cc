#include "runtime/view/live_view.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/view/view_curve.h"
#include "runtime/view/view_field.h"
#include "runtime/view/view_json.h"

namespace palpate {
namespace {

std::string_view tape_text(const HandTape& tape) {
  if (tape.recording()) {
    return "recording";
  }
  if (tape.playing()) {
    return "playing";
  }
  return tape.empty() ? "empty" : "recorded";
}

}  // namespace

void LiveView::opened(ViewClient client) {
  clients_.push_back(client);
  outbox_->send(client, role_text(steers(client)));
}

void LiveView::closed(ViewClient client) {
  const bool steered = steers(client);
  if (news_ != nullptr) {
    news_->forget(client);
  }
  clients_.erase(std::remove(clients_.begin(), clients_.end(), client), clients_.end());
  if (steered) {
    let_go(false);
    if (!clients_.empty()) {
      outbox_->send(clients_.front(), role_text(true));
    }
  }
}

void LiveView::received(ViewClient client, std::string_view text) {
  try {
    obey(client, decode_view_message(text));
  } catch (const InputError& error) {
    outbox_->send(client, refusal_text(error.what()));
  }
}

void LiveView::obey(ViewClient client, const ViewRequest& request) {
  if (request.action == ViewAction::kNode) {
    outbox_->send(
        client, news_ != nullptr
                    ? news_->curve(request.node)
                    : curve_text(session_.database(), session_.table(), request.node));
    return;
  }
  if (request.action == ViewAction::kField) {
    outbox_->send(client, field_text(session_.table(), request.node));
    return;
  }
  if (!steers(client)) {
    throw InputError("another page steers, this one watches");
  }
  switch (request.action) {
    case ViewAction::kPoint:
      point(request);
      break;
    case ViewAction::kSet:
      set(request);
      break;
    case ViewAction::kDevice:
    case ViewAction::kDeviceKept:
    case ViewAction::kDeviceOff:
      ask_device(request);
      break;
    case ViewAction::kPause:
    case ViewAction::kResume:
      refuse_while_held("pauses");
      paused_ = request.action == ViewAction::kPause;
      break;
    case ViewAction::kStep:
      step();
      break;
    case ViewAction::kReset:
      tape_.stop(session_.ticks());
      reset();
      break;
    case ViewAction::kRecord:
      record();
      break;
    case ViewAction::kReplay:
      replay();
      break;
    case ViewAction::kAnew:
      start_anew();
      break;
    case ViewAction::kNode:
    case ViewAction::kField:
      break;
  }
}

void LiveView::point(const ViewRequest& request) {
  if (request.hold) {
    refuse_while_held("else steers");
  }
  if (tape_.playing()) {
    tape_.stop(0);  // the page's hand goes first
  }
  HandWish wish{.tick = session_.ticks(), .hold = request.hold};
  if (request.hold) {
    wish.target_m = request.target_m;
    wish.turn = request.turn;
  }
  wish.hand = request.hand.value_or(request.hold ? 0 : -1);
  session_.follow(wish);
  silent_ns_ = 0;
  fell_silent_ = false;
  tape_.add(wish);
}

void LiveView::refuse_while_held(const char* what) const {
  if (device_active()) {
    throw InputError(
        fmt::format("nothing {} while a device presses: let go of it first", what));
  }
}

void LiveView::ask_device(const ViewRequest& request) {
  if (device_ == nullptr) {
    throw InputError("this page has no device: palpate view --device has one");
  }
  silent_ns_ = 0;
  if (request.action == ViewAction::kDeviceOff) {
    device_->let_go("");
  } else if (request.action == ViewAction::kDevice) {
    tape_.stop(session_.ticks());
    let_go(false);
    paused_ = false;
    device_->ask(request);
  }
}

void LiveView::set(const ViewRequest& request) {
  if (device_active()) {
    device_->set(request);
  } else {
    session_.set(request);
  }
}

void LiveView::let_go(bool silent) {
  fell_silent_ = silent;
  session_.let_go();
  tape_.add({.tick = session_.ticks(), .hold = false, .hand = -1});
}

void LiveView::reset() {
  session_.reset();
  owed_ticks_ = 0.0;
  fell_silent_ = false;
}

// Begins, or ends.
void LiveView::record() {
  refuse_while_held("is recorded");
  if (tape_.recording()) {
    tape_.stop(session_.ticks());
    return;
  }
  reset();
  tape_.record();
}

void LiveView::replay() {
  refuse_while_held("is replayed");
  tape_.stop(session_.ticks());
  if (tape_.empty()) {
    throw InputError("nothing is recorded: record first");
  }
  reset();
  tape_.play();
}

void LiveView::start_anew() {
  if (news_ == nullptr) {
    throw InputError("the body is whole, nothing computes it");
  }
  news_->start_anew();
}

// One slow period, so that a step shows an update.
void LiveView::step() {
  refuse_while_held("pauses");
  paused_ = true;
  advance(std::max(1L, std::lround(session_.fast_hz() / session_.slow_hz())));
}

// Ticks pass; what is played takes place between them.
void LiveView::advance(std::int64_t ticks) {
  while (tape_.playing() && ticks > 0 && session_.fault() == Fault::kNone) {
    const std::int64_t now = session_.ticks();
    const std::optional<HandWish> wish = tape_.take(now);
    if (wish) {
      session_.follow(*wish);
    } else if (!tape_.playing()) {
      session_.let_go();
    } else {
      const std::int64_t part = std::min(ticks, tape_.next_tick() - now);
      session_.advance(part);
      ticks -= part;
    }
  }
  session_.advance(ticks);
}

void LiveView::pass_time(std::int64_t wall_ns, std::int64_t passed_ns) {
  if (session_.is_held()) {  // its time passes in its ticks
    speed_ = 1.0;
    return;
  }
  if (paused_ || wall_ns <= 0) {
    return;
  }
  owed_ticks_ +=
      static_cast<double>(passed_ns) / kNanosecondsPerSecond * session_.fast_hz();
  const auto ticks = static_cast<std::int64_t>(owed_ticks_);
  owed_ticks_ -= static_cast<double>(ticks);
  advance(ticks);
  constexpr double kSmoothing = 0.05;
  speed_ += kSmoothing *
            (static_cast<double>(passed_ns) / static_cast<double>(wall_ns) - speed_);
}

void LiveView::frame() {
  const std::int64_t now_ns = wall_.now_ns();
  const std::int64_t wall_ns = before_ns_ < 0 ? 0 : now_ns - before_ns_;
  const std::int64_t passed_ns = std::min(wall_ns, kLateNs);
  before_ns_ = now_ns;
  silent_ns_ += passed_ns;
  if (session_.holding() && !tape_.playing() && silent_ns_ > kSilentNs) {
    let_go(true);
  }
  if (device_active()) {
    device_->watch(now_ns);
    if (silent_ns_ > kSilentNs) {
      device_->let_go("the page fell silent");
    }
  }
  pass_time(wall_ns, passed_ns);
  ViewFrame frame = session_.frame();
  frame.state = state();
  frame.paused = paused_;
  frame.speed = paused_ ? 0.0 : speed_;
  frame.clients = clients_.size();
  frame.tape = tape_text(tape_);
  if (device_ != nullptr) {
    frame.device = device_->shown();
  }
  if (news_ != nullptr) {
    frame.service = news_->service();
    tell_news(now_ns);
  }
  const auto text =
      std::make_shared<const std::string>(frame_text(frame, session_.take_ticks()));
  for (const ViewClient client : clients_) {
    outbox_->send_latest(client, text);
  }
}

void LiveView::tell_news(std::int64_t now_ns) {
  for (const ViewClient client : clients_) {
    if (std::optional<std::string> text = news_->answers(client, now_ns)) {
      outbox_->send(client, std::move(*text));
    }
  }
}

std::string_view LiveView::state() const {
  if (session_.fault() != Fault::kNone) {
    return "fault";
  }
  if (paused_) {
    return "paused";
  }
  const bool touching = session_.touching();
  if (session_.is_held()) {
    return touching ? "pressing" : "free";
  }
  if (session_.holding()) {
    return touching ? "pressing" : "approaching";
  }
  if (touching) {
    return "releasing";
  }
  return fell_silent_ ? "let go: page silent" : "free";
}

}  // namespace palpate

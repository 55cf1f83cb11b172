#include "runtime/live_view.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "formats/error.h"
#include "runtime/view_text.h"

namespace palpate {

void LiveView::opened(ViewClient client) {
  clients_.push_back(client);
  outbox_->send(client, role_text(steers(client)));
}

void LiveView::closed(ViewClient client) {
  const bool steered = steers(client);
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
    outbox_->send(client, curve_text(session_, request.node));
    return;
  }
  if (!steers(client)) {
    throw InputError("another page steers, this one watches");
  }
  switch (request.action) {
    case ViewAction::kPoint:
      if (request.hold) {
        silent_ns_ = 0;
        fell_silent_ = false;
        session_.hold(request.target_m);
      } else {
        let_go(false);
      }
      break;
    case ViewAction::kSet:
      set(request);
      break;
    case ViewAction::kPause:
    case ViewAction::kResume:
      paused_ = request.action == ViewAction::kPause;
      break;
    case ViewAction::kStep:
      step();
      break;
    case ViewAction::kReset:
      session_.reset();
      fell_silent_ = false;
      break;
    case ViewAction::kNode:
      break;
  }
}

void LiveView::set(const ViewRequest& request) {
  if (request.model) {
    session_.use(*request.model);
  }
  if (request.slow_hz) {
    session_.set_slow_hz(*request.slow_hz);
  }
  if (request.stiffness_scale) {
    session_.set_stiffness_scale(*request.stiffness_scale);
  }
  if (request.friction || request.database_friction) {
    session_.set_friction(request.friction);
  }
}

void LiveView::let_go(bool silent) {
  fell_silent_ = silent;
  session_.let_go();
}

// One slow period, so that a step shows an update.
void LiveView::step() {
  paused_ = true;
  const ViewSessionOptions& options = session_.options();
  session_.advance(std::max(1L, std::lround(options.fast_hz / options.slow_hz)));
}

void LiveView::pass_time(std::int64_t wall_ns, std::int64_t passed_ns) {
  if (paused_ || wall_ns <= 0) {
    return;
  }
  owed_ticks_ += static_cast<double>(passed_ns) / kNanosecondsPerSecond *
                 session_.options().fast_hz;
  const auto ticks = static_cast<std::int64_t>(owed_ticks_);
  owed_ticks_ -= static_cast<double>(ticks);
  session_.advance(ticks);
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
  if (session_.holding() && silent_ns_ > kSilentNs) {
    let_go(true);
  }
  pass_time(wall_ns, passed_ns);
  const ViewMoment moment{.state = state(),
                          .paused = paused_,
                          .speed = paused_ ? 0.0 : speed_,
                          .clients = clients_.size()};
  const auto text = std::make_shared<const std::string>(
      frame_text(session_, moment, session_.take_ticks()));
  for (const ViewClient client : clients_) {
    outbox_->send_latest(client, text);
  }
}

std::string_view LiveView::state() const {
  if (session_.report().fault != Fault::kNone) {
    return "fault";
  }
  if (paused_) {
    return "paused";
  }
  const auto contact = static_cast<unsigned>(TickFlag::kContact);
  const bool touching = (session_.latest().flags & contact) != 0U;
  if (session_.holding()) {
    return touching ? "pressing" : "approaching";
  }
  if (touching) {
    return "releasing";
  }
  return fell_silent_ ? "let go: page silent" : "free";
}

}  // namespace palpate

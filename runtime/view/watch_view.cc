#include "runtime/view/watch_view.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/view/view_curve.h"
#include "runtime/view/view_field.h"

namespace palpate {
namespace {

bool has(const TickRecord& tick, TickFlag flag) {
  return (tick.flags & static_cast<unsigned>(flag)) != 0U;
}

void count(ViewRun& run, const TickRecord& tick) {
  run.ticks = tick.tick + 1;
  run.late_ticks += has(tick, TickFlag::kSkipped) ? 1 : 0;
  run.starved_ticks += has(tick, TickFlag::kStarved) ? 1 : 0;
  run.extrapolated_ticks += has(tick, TickFlag::kExtrapolated) ? 1 : 0;
  run.depth_max_m = std::max(run.depth_max_m, tick.depth_m);
  run.force_max_n = std::max(
      run.force_max_n, std::hypot(tick.force_n[0], tick.force_n[1], tick.force_n[2]));
}

}  // namespace

WatchView::WatchView(const ViewedBody& body, const SimulationOptions& options,
                     TickQueue& ticks, ViewNews* news)
    : body_(body),
      search_(body.database.body),
      ticks_(ticks),
      contacts_(options.watch_contacts),
      needle_(body.table.puncture.empty() ? nullptr : options.watch_needle),
      rubbed_(shows_friction(body.table) ? options.watch_friction : nullptr),
      news_(news) {
  frame_.settings = {
      .model = options.model, .slow_hz = options.slow_hz, .fast_hz = options.fast_hz};
}

void WatchView::opened(ViewClient client) {
  clients_.push_back(client);
  outbox_->send(client, role_text(false));
}

void WatchView::closed(ViewClient client) {
  clients_.erase(std::remove(clients_.begin(), clients_.end(), client), clients_.end());
  if (news_ != nullptr) {
    news_->forget(client);
  }
}

void WatchView::received(ViewClient client, std::string_view text) {
  try {
    obey(client, decode_view_message(text));
  } catch (const InputError& error) {
    outbox_->send(client, refusal_text(error.what()));
  }
}

void WatchView::obey(ViewClient client, const ViewRequest& request) {
  if (request.action == ViewAction::kNode) {
    outbox_->send(client, news_ != nullptr
                              ? news_->curve(request.node)
                              : curve_text(body_.database, body_.table, request.node));
  } else if (request.action == ViewAction::kField) {
    outbox_->send(client, field_text(body_.table, request.node));
  } else if (request.action == ViewAction::kAnew && news_ != nullptr) {
    // As of a steered view: the oldest page's to say.
    if (clients_.empty() || clients_.front() != client) {
      throw InputError("another page was there before, which may start the scene anew");
    }
    news_->start_anew();
  } else {
    throw InputError(fmt::format("the {} steers, pages watch", body_.device));
  }
}

void WatchView::tell_news() {
  frame_.service = news_->service();
  for (const ViewClient client : clients_) {
    if (std::optional<std::string> text = news_->answers(client, clock_.now_ns())) {
      outbox_->send(client, std::move(*text));
    }
  }
}

void WatchView::frame() {
  std::vector<TickRecord> passed;
  while (const TickRecord* tick = ticks_.front()) {
    first_ns_ = frame_.run.ticks == 0 ? tick->time_ns : first_ns_;
    passed.push_back(*tick);
    passed.back().time_ns -= first_ns_;
    count(frame_.run, *tick);
    ticks_.pop();
  }
  if (needle_ != nullptr) {
    static_cast<void>(needle_->fetch());
    frame_.needle =
        view_needle(needle_->latest().state, body_.table.tool, frame_.needle);
  }
  if (!passed.empty()) {
    frame_.now = passed.back();
    const Eigen::Map<const Eigen::Vector3d> tool(frame_.now.position_m.data());
    if (tool.allFinite()) {
      frame_.contact = tool_contact(body_.database, body_.table.tool, search_, tool,
                                    frame_.now.triangle, frame_.needle);
    }
  }
  if (rubbed_ != nullptr) {
    while (const FrictionSeen* seen = rubbed_->front()) {
      friction_.add(*seen);
      rubbed_->pop();
    }
    frame_.friction = view_friction(friction_, body_.database, body_.table.tool,
                                    search_, frame_.now.triangle);
  }
  frame_.state = state();
  frame_.fault = name(static_cast<Fault>(frame_.now.fault));
  frame_.net_j = frame_.now.work_j;
  frame_.clients = clients_.size();
  if (contacts_ != nullptr) {
    frame_.hands = hands();
  }
  if (news_ != nullptr) {
    tell_news();
  }
  const auto text = std::make_shared<const std::string>(frame_text(frame_, passed));
  for (const ViewClient client : clients_) {
    outbox_->send_latest(client, text);
  }
}

// The devices are the hands.
ViewHands WatchView::hands() {
  static_cast<void>(contacts_->fetch());
  const ContactsSeen& seen = contacts_->latest();
  ViewHands all;
  all.scaled = seen.scaled;
  all.compared = false;
  for (std::size_t i = 0; i < body_.hands.size(); ++i) {
    const HandSeen& hand = seen.hand[i];
    all.hand.push_back({.tool_m = hand.tool.position_m,
                        .turn = Eigen::Quaterniond(hand.tool.rotation),
                        .hand_m = hand.device.position_m,
                        .pointer_m = hand.device.position_m,
                        .holding = seen.held,
                        .force_n = hand.wrench.force_n,
                        .torque_n_m = hand.wrench.torque_n_m});
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(seen.count); ++i) {
    if (seen.contact[i].at.triangle >= 0) {
      all.touch.push_back(touch_at(body_.database, seen.contact[i]));
    }
  }
  return all;
}

std::string_view WatchView::state() const {
  if (frame_.run.ticks == 0) {
    return "waiting for the device";
  }
  return has(frame_.now, TickFlag::kContact) ? "pressing" : "free";
}

}  // namespace palpate

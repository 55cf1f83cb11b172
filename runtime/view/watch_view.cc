#include "runtime/view/watch_view.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/view/view_field.h"
#include "runtime/view/view_message.h"

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
                     TickQueue& ticks)
    : body_(body), search_(body.database.body), ticks_(ticks) {
  frame_.settings = {
      .model = options.model, .slow_hz = options.slow_hz, .fast_hz = options.fast_hz};
}

void WatchView::opened(ViewClient client) {
  clients_.push_back(client);
  outbox_->send(client, role_text(false));
}

void WatchView::closed(ViewClient client) {
  clients_.erase(std::remove(clients_.begin(), clients_.end(), client), clients_.end());
}

void WatchView::received(ViewClient client, std::string_view text) {
  try {
    const ViewRequest request = decode_view_message(text);
    if (request.action == ViewAction::kNode) {
      outbox_->send(client, curve_text(body_.database, body_.table, request.node));
    } else if (request.action == ViewAction::kField) {
      outbox_->send(client, field_text(body_.table, request.node));
    } else {
      throw InputError(fmt::format("the {} steers, pages watch", body_.device));
    }
  } catch (const InputError& error) {
    outbox_->send(client, refusal_text(error.what()));
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
  if (!passed.empty()) {
    frame_.now = passed.back();
    const Eigen::Map<const Eigen::Vector3d> tool(frame_.now.position_m.data());
    if (tool.allFinite()) {
      frame_.contact = view_contact(body_.database, body_.table.tool, search_, tool,
                                    frame_.now.triangle);
    }
  }
  frame_.state = state();
  frame_.fault = name(static_cast<Fault>(frame_.now.fault));
  frame_.net_j = frame_.now.work_j;
  frame_.clients = clients_.size();
  const auto text = std::make_shared<const std::string>(frame_text(frame_, passed));
  for (const ViewClient client : clients_) {
    outbox_->send_latest(client, text);
  }
}

std::string_view WatchView::state() const {
  if (frame_.run.ticks == 0) {
    return "waiting for the device";
  }
  return has(frame_.now, TickFlag::kContact) ? "pressing" : "free";
}

}  // namespace palpate

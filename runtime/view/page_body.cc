#include "runtime/view/page_body.h"

#include <utility>

#include "runtime/view/view_json.h"

namespace palpate {
namespace {

constexpr ViewClient kPage = 1;

}  // namespace

PageBody::PageBody(ResponseDatabase database, std::string_view name,
                   const ViewSessionOptions& options, const InverseConfig& inverse)
    : database_(std::move(database)),
      session_(database_, options),
      device_(session_, inverse),
      view_(session_, wall_) {
  view_.steer_by(device_);
  session_.set({.stiffness_scale = 1.0});
  text_ = body_text(viewed(session_, std::string(name)));
  bytes_ = body_bytes(database_, session_.table());
  view_.answer_through(*this);
  view_.opened(kPage);
}

void PageBody::receive(std::string_view message) {
  view_.received(kPage, message);
}

void PageBody::frame(std::int64_t now_ns) {
  wall_.sleep_until_ns(now_ns);
  view_.frame();
}

std::optional<std::string> PageBody::take() {
  if (!told_.empty()) {
    std::string oldest = std::move(told_.front());
    told_.erase(told_.begin());
    return oldest;
  }
  const std::shared_ptr<const std::string> frame = std::exchange(latest_, nullptr);
  return frame ? std::optional(*frame) : std::nullopt;
}

void PageBody::send(ViewClient /*client*/, std::string text) {
  told_.push_back(std::move(text));
}

void PageBody::send_latest(ViewClient /*client*/,
                           const std::shared_ptr<const std::string>& text) {
  latest_ = text;
}

}  // namespace palpate

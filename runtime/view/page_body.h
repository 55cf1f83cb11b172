// A body in a page that needs no server: what a page of the live view asks for and is
// told, without anything between them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/realtime/clock.h"
#include "runtime/view/live_view.h"
#include "runtime/view/page_device.h"
#include "runtime/view/view_outbox.h"
#include "runtime/view/view_session.h"

namespace palpate {

/// One page, which steers; one thread.
class PageBody : private ViewOutbox {
 public:
  /// @param name of the database, as the page shows it. @param inverse ports of Haply's
  /// service, as the page may reach them. @throws as ViewSession.
  PageBody(ResponseDatabase database, std::string_view name,
           const ViewSessionOptions& options, const InverseConfig& inverse = {});

  /// What does not change, as body_text(), and the body, as body_bytes().
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

  /// A message of the page (view_message.h). What is wrong with it becomes an answer.
  void receive(std::string_view message);

  /// Time passes until `now_ns` [ns] of the page's clock, which starts anywhere and
  /// never goes back; then a frame is told.
  void frame(std::int64_t now_ns);

  /// The oldest message that the page has not taken, if there is one. Of frames only
  /// the latest is kept, and comes last.
  [[nodiscard]] std::optional<std::string> take();

  /// The page's own device, for who carries its messages.
  [[nodiscard]] PageDevice& device() noexcept { return device_; }

  [[nodiscard]] const ViewSession& session() const noexcept { return session_; }

 private:
  void send(ViewClient client, std::string text) override;
  void send_latest(ViewClient client,
                   const std::shared_ptr<const std::string>& text) override;

  ResponseDatabase database_;
  ViewSession session_;
  SimulatedClock wall_;
  PageDevice device_;
  LiveView view_;
  std::string text_;
  std::string bytes_;
  std::vector<std::string> told_;  // from the oldest on
  std::shared_ptr<const std::string> latest_;
};

}  // namespace palpate

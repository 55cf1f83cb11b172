// The application behind the live view's server: who may steer, what is simulated when,
// and what is reported to every page.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "runtime/hand/hand_tape.h"
#include "runtime/realtime/clock.h"
#include "runtime/view/view_device.h"
#include "runtime/view/view_message.h"
#include "runtime/view/view_news.h"
#include "runtime/view/view_outbox.h"
#include "runtime/view/view_session.h"

namespace palpate {

/// The first page steers, the others watch until it is gone; then the one that came
/// first of them steers. Simulated time follows the wall clock; where the machine is
/// late by more than kLateNs, time is lost, not made up for. A page that holds the tool
/// and says nothing for kSilentNs has let go. Lost time does not count, because what
/// the page said in that time has not been read yet. What a page does to the tool can
/// be recorded and replayed, with the settings of the moment. A page that presses with
/// a device of its own has to say so as often.
class LiveView : public ViewApplication {
 public:
  static constexpr std::int64_t kSilentNs = 1'000'000'000;
  static constexpr std::int64_t kLateNs = 100'000'000;

  /// All must outlive the view. @param news of a body whose responses are still to
  /// come; null: it is whole.
  LiveView(ViewSession& session, Clock& wall, ViewNews* news = nullptr)
      : session_(session), wall_(wall), news_(news) {}

  /// The page's own device; must outlive the view.
  void steer_by(ViewDevice& device) noexcept { device_ = &device; }

  /// Where messages go from now on; must outlive the view, or its last call.
  void answer_through(ViewOutbox& outbox) noexcept { outbox_ = &outbox; }

  void opened(ViewClient client) override;
  void received(ViewClient client, std::string_view text) override;
  void closed(ViewClient client) override;
  void frame() override;

 private:
  void obey(ViewClient client, const ViewRequest& request);
  void point(const ViewRequest& request);
  void let_go(bool silent);
  void ask_device(const ViewRequest& request);
  void refuse_while_held(const char* what) const;
  void set(const ViewRequest& request);
  void record();
  void replay();
  void reset();
  void advance(std::int64_t ticks);
  void pass_time(std::int64_t wall_ns, std::int64_t passed_ns);
  void step();
  void start_anew();
  void tell_news(std::int64_t now_ns);
  [[nodiscard]] std::string_view state() const;
  [[nodiscard]] bool device_active() const {
    return device_ != nullptr && device_->active();
  }
  [[nodiscard]] bool steers(ViewClient client) const {
    return !clients_.empty() && clients_.front() == client;
  }

  ViewSession& session_;
  Clock& wall_;
  ViewNews* news_ = nullptr;
  ViewDevice* device_ = nullptr;
  ViewOutbox* outbox_ = nullptr;
  std::vector<ViewClient> clients_;  // by age; the first steers
  std::int64_t before_ns_ = -1;      // wall time up to which was simulated
  std::int64_t silent_ns_ = 0;       // time since the page that holds the tool spoke
  HandTape tape_;
  double owed_ticks_ = 0.0;  // fraction of a tick
  double speed_ = 1.0;
  bool paused_ = false;
  bool fell_silent_ = false;
};

}  // namespace palpate

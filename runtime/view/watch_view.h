// Pages that look on while a device renders in real time, in threads of its own.
#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/surface_search.h"
#include "runtime/realtime/clock.h"
#include "runtime/run/render_run.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_message.h"
#include "runtime/view/view_news.h"
#include "runtime/view/view_outbox.h"

namespace palpate {

/// Shows what the fast thread says of its ticks. No page steers. The fast thread only
/// fills a queue: it does not know whether there is a page.
class WatchView : public ViewApplication {
 public:
  /// All must outlive the view. @param ticks filled by the run, read here alone.
  /// What `options` has of several contacts, needles and friction, likewise. @param
  /// news of a body whose responses come meanwhile; else null.
  WatchView(const ViewedBody& body, const SimulationOptions& options, TickQueue& ticks,
            ViewNews* news = nullptr);

  /// Where messages go from now on; must outlive the view, or its last call.
  void answer_through(ViewOutbox& outbox) noexcept { outbox_ = &outbox; }

  void opened(ViewClient client) override;
  void received(ViewClient client, std::string_view text) override;
  void closed(ViewClient client) override;
  void frame() override;

 private:
  [[nodiscard]] std::string_view state() const;
  [[nodiscard]] ViewHands hands();
  void obey(ViewClient client, const ViewRequest& request);
  void tell_news();

  const ViewedBody& body_;
  SurfaceSearch search_;
  TickQueue& ticks_;
  ContactsWatch* contacts_;
  NeedleWatch* needle_;
  FrictionWatch* rubbed_;
  FrictionTrail friction_;
  ViewNews* news_;
  MonotonicClock clock_;
  ViewOutbox* outbox_ = nullptr;
  std::vector<ViewClient> clients_;
  ViewFrame frame_;
  std::int64_t first_ns_ = 0;  // of the run
};

}  // namespace palpate

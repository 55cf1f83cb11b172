// A small web server for the live view: a fixed table of files, and WebSockets to the
// pages that may use them. The page is the only client meant; every other program on
// the machine, and every other page in the browser, is a third party.
//
// What it does against third-party programs: it binds 127.0.0.1 alone. A request must
// name exactly that host and port (no rebinding of names). A WebSocket must come from
// the page's own origin and bring a 128-bit token, and a request for data must do so,
// too. Only GET and HEAD are taken, with no bodies, headers of at most 8 KiB, and 10 s
// to send them. Messages have at most 4 KiB; rates and clients are capped. The content
// policy is strict, and nothing is cached. A page that is too slow gets the latest
// frame, never a queue of old ones.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "formats/report/page_assets.h"
#include "runtime/view/view_outbox.h"

namespace palpate {

/// Data of the database, for those with the token.
struct ViewData {
  std::string path;
  std::string content_type;
  std::string bytes;
};

struct ViewServerOptions {
  std::uint16_t port = 0;  ///< 0: any free one
  std::string token;       ///< 32 hexadecimal digits
  double frame_hz = 60.0;  ///< [Hz] > 0, calls of frame()
  std::size_t clients_max = 4;
  double messages_per_s_max = 240.0;  ///< of one client, before it is dropped
  std::vector<ViewAsset> assets = {};
  std::vector<ViewData> data = {};
};

/// One thread, which calls run(); the other calls may be made before it or from the
/// application's calls.
class ViewServer : public ViewOutbox {
 public:
  /// Binds and listens. @throws InputError if the port cannot be had or the options are
  /// out of range.
  ViewServer(ViewServerOptions options, ViewApplication& application);
  ~ViewServer() override;

  [[nodiscard]] std::uint16_t port() const;

  /// The page's address with the token behind '#', where no server sees it.
  [[nodiscard]] std::string address() const;

  /// Serves until `stop` is set, which is seen within a frame.
  void run(const std::atomic<bool>& stop);

  void send(ViewClient client, std::string text) override;
  void send_latest(ViewClient client,
                   const std::shared_ptr<const std::string>& text) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate

// How the live view's application and its pages speak, whatever lies between them: a
// server's sockets, or nothing where both are in one page.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace palpate {

using ViewClient = std::uint64_t;  ///< counts from 1, never used twice

/// What pages are for. All calls come from one thread.
class ViewApplication {
 public:
  ViewApplication() = default;
  virtual ~ViewApplication() = default;
  ViewApplication(const ViewApplication&) = delete;
  ViewApplication& operator=(const ViewApplication&) = delete;

  virtual void opened(ViewClient client) = 0;
  virtual void received(ViewClient client, std::string_view text) = 0;
  virtual void closed(ViewClient client) = 0;
  /// As often as pages show something, 60 times a second; late when the machine is.
  virtual void frame() = 0;
};

/// How an application speaks to its pages.
class ViewOutbox {
 public:
  ViewOutbox() = default;
  virtual ~ViewOutbox() = default;
  ViewOutbox(const ViewOutbox&) = delete;
  ViewOutbox& operator=(const ViewOutbox&) = delete;

  /// Queues a message for one client; a client with 64 of them waiting is dropped.
  virtual void send(ViewClient client, std::string text) = 0;

  /// The latest frame of a client, in place of an older one that has not left yet.
  virtual void send_latest(ViewClient client,
                           const std::shared_ptr<const std::string>& text) = 0;
};

}  // namespace palpate

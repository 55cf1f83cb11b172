// Reaching a service on this machine, and being one: connections with deadlines, a
// request by HTTP, the handshake of a WebSocket (RFC 6455).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <poll.h>

namespace palpate {

/// [ns] `wait_s` from now, by the monotonic clock.
[[nodiscard]] std::int64_t inverse_deadline_ns(double wait_s) noexcept;

/// Waits for poll()'s events. False when the deadline passed first. An error counts as
/// ready: the next call tells it.
bool wait_for_sockets(std::span<pollfd> ends, std::int64_t deadline_ns) noexcept;
[[nodiscard]] bool wait_for_socket(int descriptor, short events,
                                   std::int64_t deadline_ns) noexcept;

/// Listens on 127.0.0.1:`port`, any free one for 0; tells which. @returns a descriptor
/// that never waits, or -1: errno says why.
[[nodiscard]] int listen_on_loopback(std::uint16_t& port) noexcept;

/// The next connection there, which never waits; -1: there is none.
[[nodiscard]] int accept_connection(int acceptor) noexcept;

/// Body of GET `target` at 127.0.0.1:`port`, at most 4 KiB. @throws DeviceError.
[[nodiscard]] std::string http_get(std::uint16_t port, const std::string& target,
                                   double wait_s);

struct OpenedWebSocket {
  int descriptor = -1;  ///< never waits; the caller's
  std::string rest{};   ///< frames that have come already, at most 16 KiB
};

/// ws://127.0.0.1:`port`/ within `wait_s`. @throws DeviceError.
[[nodiscard]] OpenedWebSocket open_websocket(std::uint16_t port, double wait_s);

}  // namespace palpate

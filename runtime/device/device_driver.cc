#include "runtime/device/device_driver.h"

#include <algorithm>
#include <cerrno>
#include <string_view>

#include <poll.h>
#include <sys/socket.h>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"
#include "runtime/device/socket_device.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/real_time.h"

namespace palpate {
namespace {

constexpr int kDeviceExitCode = 5;

template <typename Datagram>
void say(int descriptor, const Datagram& datagram) noexcept {
  // A renderer that takes nothing misses states; it will notice.
  static_cast<void>(
      ::send(descriptor, &datagram, sizeof datagram, MSG_DONTWAIT | MSG_NOSIGNAL));
}

// Waits for room, a second at most: a renderer that was kept from reading would never
// know why.
void say_farewell(int descriptor, std::string_view why) noexcept {
  SocketFarewell farewell;
  const std::size_t size = std::min(why.size(), farewell.why.size() - 1);
  std::copy_n(why.begin(), size, farewell.why.begin());
  pollfd end{.fd = descriptor, .events = POLLOUT, .revents = 0};
  ::poll(&end, 1, 1000);
  say(descriptor, farewell);
}

// The renderer's latest wish, and whether it still has any.
class Commands {
 public:
  Commands(int descriptor, std::int64_t silent_ns)
      : descriptor_(descriptor), silent_ns_(silent_ns) {}

  /// Takes what has come. False when the other end is closed or talks nonsense.
  bool take() noexcept {
    for (;;) {
      SocketCommand next;
      const ssize_t size =
          ::recv(descriptor_, &next, sizeof next, MSG_DONTWAIT | MSG_TRUNC);
      if (size == sizeof next) {
        latest_ = next;
        heard_ns_ = clock_.now_ns();
      } else if (size >= 0 || errno != EINTR) {
        return size < 0 && errno == EAGAIN;
      }
    }
  }

  /// Zero force when the renderer has fallen silent.
  [[nodiscard]] SocketCommand wanted() noexcept {
    return is_silent() ? SocketCommand{} : latest_;
  }

  void await_next(std::int64_t until_ns) noexcept {
    const std::int64_t left_ns = until_ns - clock_.now_ns();
    if (!is_silent() && left_ns > 0) {
      pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
      const timespec left{.tv_sec = left_ns / 1'000'000'000,
                          .tv_nsec = left_ns % 1'000'000'000};
      ::ppoll(&end, 1, &left, nullptr);
    }
  }

 private:
  [[nodiscard]] bool is_silent() noexcept {
    return heard_ns_ == 0 || clock_.now_ns() - heard_ns_ > silent_ns_;
  }

  int descriptor_;
  std::int64_t silent_ns_;
  MonotonicClock clock_;
  SocketCommand latest_;
  std::int64_t heard_ns_ = 0;
};

int exchange_until_the_end(DeviceLink& link, int descriptor,
                           const DriverTiming& timing) noexcept {
  MonotonicClock clock;
  Commands commands(descriptor, nanoseconds_in(timing.silent_s));
  TurnFromStart from_start;
  SocketTurnedState turned;
  SocketState& state = turned.state;
  while (commands.take()) {
    const SocketCommand command = commands.wanted();
    const Eigen::Vector3d wanted_n(command.force_n.data());
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    const std::int64_t begin_ns = clock.now_ns();
    const LinkStatus status = link.transact(wanted_n, position_m);
    if (status == LinkStatus::kLost) {
      say_farewell(descriptor, link.failure());
      return kDeviceExitCode;
    }
    if (status == LinkStatus::kMissed) {
      ++state.missed;
    } else {
      // What of the wish the link did not exert: limits, rounding to motor steps, no
      // known pose.
      const Eigen::Vector3d withheld_n = wanted_n - link.sent_n();
      state.time_ns = begin_ns;
      state.done_ns = clock.now_ns();
      state.sequence = command.sequence;
      std::copy_n(position_m.data(), 3, state.position_m.begin());
      std::copy_n(withheld_n.data(), 3, state.withheld_n.begin());
      if (link.measures_turns()) {
        const Eigen::Quaterniond turn = from_start(link.turn());
        turned.turn_wxyz = {turn.w(), turn.x(), turn.y(), turn.z()};
        say(descriptor, turned);
      } else {
        say(descriptor, state);
      }
      // The answer to this position is given answer_s to come. rate_max_hz bounds
      // exchanges.
      commands.await_next(state.done_ns + nanoseconds_in(timing.answer_s));
    }
    clock.sleep_until_ns(begin_ns + nanoseconds_in(1.0 / timing.rate_max_hz));
  }
  return 0;
}

}  // namespace

int serve_device(DeviceLink& link, int descriptor, const DriverTiming& timing) {
  try {
    link.open();
  } catch (const Error& error) {
    say_farewell(descriptor, error.what());
    return kDeviceExitCode;
  }
  static_cast<void>(request_real_time(-1));
  const DeviceLimits limits = link.limits();
  say(descriptor, SocketHello{.magic = link.measures_turns() ? kTurnedHello : kHello,
                              .damping_n_s_per_m = limits.damping_n_s_per_m,
                              .coulomb_n = limits.coulomb_n,
                              .resolution_m = limits.resolution_m,
                              .delay_s = limits.delay_s,
                              .force_max_n = limits.force_max_n});
  const int code = exchange_until_the_end(link, descriptor, timing);
  link.close();
  return code;
}

bool is_hung_up(int descriptor) noexcept {
  pollfd end{.fd = descriptor, .events = 0, .revents = 0};
  return ::poll(&end, 1, 0) == 1 && (end.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace palpate

#include "runtime/device/socket_device.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/base/socket_peer.h"
#include "runtime/device/device_turn.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr int kFirstStateMs = 2000;

// What a driver may say.
union Datagram {
  SocketHello hello;
  SocketState state;
  SocketTurnedState turned;
  SocketFarewell farewell;
  constexpr Datagram() : farewell() {}
};
static_assert(sizeof(SocketHello) == 48 && sizeof(SocketState) == 80 &&
              sizeof(SocketTurnedState) == 112 && sizeof(SocketFarewell) == 256);

// Whoever listens gets positions and receives forces: this user, or root.
void check_peer(int descriptor, const std::string& name) {
  if (const auto stranger = stranger_at(descriptor)) {
    ::close(descriptor);
    throw DeviceError(fmt::format("{}: belongs to user {}, must be yours or root's",
                                  name, *stranger));
  }
}

int connected(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path) {
    throw DeviceError(fmt::format("{}: name of a socket has {} bytes, at most {} fit",
                                  name, name.size(), sizeof address.sun_path - 1));
  }
  std::memcpy(address.sun_path, name.c_str(), name.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (descriptor < 0 ||
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address),
                sizeof address) != 0) {
    const int error = errno;
    if (descriptor >= 0) {
      ::close(descriptor);
    }
    throw DeviceError(
        fmt::format("{}: no device answers: {}", name, std::strerror(error)));
  }
  check_peer(descriptor, name);
  return descriptor;
}

// Sequence 0 and zero force. A driver that takes nothing for a second is beyond help.
// The last one closes our ears and empties them: a socket that is closed with something
// unread in it makes the other end see an error before it sees what was sent.
void send_zero(int descriptor, bool last) noexcept {
  const SocketCommand zero{};
  pollfd end{.fd = descriptor, .events = POLLOUT, .revents = 0};
  ::poll(&end, 1, 1000);
  ::send(descriptor, &zero, sizeof zero, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (last) {
    ::shutdown(descriptor, SHUT_RD);
    SocketState unread;
    while (::recv(descriptor, &unread, sizeof unread, MSG_DONTWAIT) > 0) {
    }
  }
}

bool is_limit(double value) {
  return std::isfinite(value) && value >= 0.0;
}

}  // namespace

SocketDevice::SocketDevice(const std::filesystem::path& socket,
                           const SocketPatience& patience)
    : SocketDevice(connected(socket), patience) {
  look_at_wire();
}

SocketDevice::SocketDevice(int descriptor, const SocketPatience& patience)
    : descriptor_(descriptor), patience_(patience) {
  try {
    greet();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

SocketDevice::~SocketDevice() {
  close();
  ::close(descriptor_);
}

void SocketDevice::greet() {
  constexpr int kLookMs = 50;
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + nanoseconds_in(patience_.hello_s);
  pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
  while (::poll(&end, 1, kLookMs) != 1 && clock.now_ns() < until_ns) {
    if (patience_.stopped && patience_.stopped()) {
      throw Interrupted();
    }
  }
  Datagram heard{};
  // MSG_TRUNC returns the whole length of a datagram: hello 48 bytes, farewell 256.
  const ssize_t size =
      ::recv(descriptor_, &heard, sizeof heard, MSG_TRUNC | MSG_DONTWAIT);
  if (size == sizeof heard.farewell && heard.farewell.magic == SocketFarewell{}.magic) {
    farewell_ = heard.farewell;
    throw DeviceError(failure());
  }
  if (size != sizeof heard.hello) {
    throw DeviceError(fmt::format("socket device: no hello of the device within {:g} s",
                                  patience_.hello_s));
  }
  const SocketHello& hello = heard.hello;
  turned_ = hello.magic == kTurnedHello;
  if (!turned_ && hello.magic != kHello) {
    throw DeviceError("socket device: what answers is not a device of this protocol");
  }
  if (!is_limit(hello.damping_n_s_per_m) || !is_limit(hello.coulomb_n) ||
      !is_limit(hello.resolution_m) || !is_limit(hello.delay_s) ||
      !is_limit(hello.force_max_n) || !(hello.force_max_n > 0.0)) {
    throw DeviceError("socket device: its hello has limits that cannot be");
  }
  limits_ = {.damping_n_s_per_m = hello.damping_n_s_per_m,
             .coulomb_n = hello.coulomb_n,
             .resolution_m = hello.resolution_m,
             .delay_s = hello.delay_s,
             .force_max_n = hello.force_max_n};
}

// A driver that answers commands alone says one state, and its wire is not known.
void SocketDevice::look_at_wire() {
  constexpr std::size_t kIntervals = 8;
  constexpr std::int64_t kLookNs = 100'000'000;
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + kLookNs;
  std::vector<std::int64_t> interval_ns;
  DeviceReading before;
  pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
  while (interval_ns.size() < kIntervals && clock.now_ns() < until_ns) {
    ::poll(&end, 1, 1);
    DeviceReading now;
    if (read(now, 1) == DeviceStatus::kLost) {
      return;  // open() says why
    }
    if (before.time_ns != 0 && now.time_ns > before.time_ns) {
      interval_ns.push_back(now.time_ns - before.time_ns);
    }
    before = now;
  }
  report_ = {};
  if (!interval_ns.empty()) {
    const auto middle = interval_ns.begin() + std::ssize(interval_ns) / 2;
    std::nth_element(interval_ns.begin(), middle, interval_ns.end());
    limits_.hold_s = seconds_in(*middle);
  }
}

void SocketDevice::open() {
  guardian_ = std::make_unique<Guardian>(descriptor_, send_zero, patience_.silent_s);
  // Until the first state there is no position to start from.
  pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
  DeviceReading first;
  const bool heard = heard_ns_ != 0 || ::poll(&end, 1, kFirstStateMs) == 1;
  if (!heard || read(first) == DeviceStatus::kLost || heard_ns_ == 0) {
    guardian_.reset();
    throw DeviceError(heard && *failure_ != '\0'
                          ? failure()
                          : "socket device: no position of the device within 2 s");
  }
  opened_ns_ = heard_ns_;
}

std::string SocketDevice::failure() const {
  const auto end = std::find(farewell_.why.begin(), farewell_.why.end(), '\0');
  const std::string why(farewell_.why.begin(), end);
  return why.empty() ? failure_ : why;
}

bool SocketDevice::take(const SocketTurnedState& turned) noexcept {
  const auto& [w, x, y, z] = turned.turn_wxyz;
  const auto turn = exact_turn(Eigen::Quaterniond(w, x, y, z));
  if (turn) {
    take(turned.state);
    latest_.turn = *turn;
  }
  return turn.has_value();
}

// How old a force was when the next took its place: by then the driver knew the next.
void SocketDevice::take(const SocketState& state) noexcept {
  MonotonicClock clock;
  heard_ns_ = clock.now_ns();
  latest_.time_ns = state.time_ns;
  latest_.position_m = Eigen::Vector3d(state.position_m.data());
  latest_.withheld_n = Eigen::Vector3d(state.withheld_n.data());
  const std::int64_t taken_ns = state.done_ns - state.time_ns;
  if (taken_ns >= 0) {
    report_.time.add(taken_ns);
  }
  report_.missed = static_cast<std::int64_t>(state.missed);
  ++report_.transactions;
  if (state.sequence == acting_ || state.sequence > sequence_) {
    return;
  }
  const Written& held = written_[acting_ % kWrittenMax];
  if (held.sequence == acting_ && !held.zero && state.done_ns > held.measured_ns) {
    report_.force_age.add(state.done_ns - held.measured_ns);
  }
  acting_ = state.sequence;
}

DeviceStatus SocketDevice::read(DeviceReading& reading) noexcept {
  constexpr int kStatesMax = 64;  // a flood keeps nobody from the time of a tick
  return read(reading, kStatesMax);
}

// One that ended with commands unread makes the system say so once, before what it said
// last.
DeviceStatus SocketDevice::read(DeviceReading& reading, int states_max) noexcept {
  for (int taken = 0; taken < states_max; ++taken) {
    Datagram heard;
    // Datagrams differ by length: state 80 bytes, state with a turn 112, farewell 256.
    const ssize_t bytes =
        ::recv(descriptor_, &heard, sizeof heard, MSG_DONTWAIT | MSG_TRUNC);
    if (bytes == sizeof heard.state && !turned_) {
      take(heard.state);
    } else if (bytes == sizeof heard.turned && turned_) {
      if (!take(heard.turned)) {
        failure_ = "its driver says an orientation that is none";
        return DeviceStatus::kLost;
      }
    } else if (bytes < 0 && errno == EAGAIN) {
      break;
    } else if (bytes == sizeof heard.farewell) {
      farewell_ = heard.farewell;
      failure_ = "its driver has ended";
      return DeviceStatus::kLost;
    } else if (bytes >= 0 || (errno != EINTR && errno != ECONNRESET)) {
      failure_ = bytes > 0 ? "its driver says what is not of the protocol"
                           : "its driver has ended without a word";
      return DeviceStatus::kLost;
    }
  }
  // The newest state is the answer, until it is older than stale_s.
  MonotonicClock clock;
  if (heard_ns_ == 0) {
    return DeviceStatus::kLate;
  }
  reading = latest_;
  reading.read_ns = clock.now_ns();
  const bool stale = reading.read_ns - heard_ns_ > nanoseconds_in(patience_.stale_s);
  return stale ? DeviceStatus::kLate : DeviceStatus::kOk;
}

DeviceStatus SocketDevice::write(const Eigen::Vector3d& force_n) noexcept {
  const bool guarded = guardian_ != nullptr && guardian_->beat();
  const SocketCommand command{
      .sequence = ++sequence_,
      .force_n = guarded ? std::array{force_n.x(), force_n.y(), force_n.z()}
                         : std::array<double, 3>{}};
  written_[sequence_ % kWrittenMax] = {.sequence = sequence_,
                                       .measured_ns = latest_.time_ns,
                                       .zero = force_n == Eigen::Vector3d::Zero()};
  const ssize_t sent =
      ::send(descriptor_, &command, sizeof command, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (!guarded) {
    failure_ = "its guardian process is gone or had to step in";
    return DeviceStatus::kLost;
  }
  if (sent < 0 && errno != EAGAIN && errno != EINTR) {
    // What the driver said before it ended is still to be read.
    DeviceReading ignored;
    if (read(ignored) != DeviceStatus::kLost) {
      failure_ = "its driver has ended without a word";
    }
    return DeviceStatus::kLost;
  }
  return sent < 0 ? DeviceStatus::kLate : DeviceStatus::kOk;
}

void SocketDevice::close() noexcept {
  if (guardian_ != nullptr) {
    report_.duration_s =
        static_cast<double>(heard_ns_ - opened_ns_) / kNanosecondsPerSecond;
    send_zero(descriptor_, false);
    guardian_.reset();  // sends it, too
    send_zero(descriptor_, true);
  }
}

}  // namespace palpate

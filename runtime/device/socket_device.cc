#include "runtime/device/socket_device.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kHelloMs = 2000;

// Whoever listens gets positions and is told forces: this user, or root.
void check_peer(int descriptor, const std::string& name) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0 ||
      (peer.uid != ::geteuid() && peer.uid != 0)) {
    ::close(descriptor);
    throw DeviceError(
        fmt::format("{}: belongs to user {}, must be yours or root's", name, peer.uid));
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

SocketDevice::SocketDevice(const std::filesystem::path& socket, double silent_s)
    : SocketDevice(connected(socket), silent_s) {}

SocketDevice::SocketDevice(int descriptor, double silent_s)
    : descriptor_(descriptor), silent_s_(silent_s) {
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
  pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
  SocketHello hello{};
  if (::poll(&end, 1, kHelloMs) != 1 ||
      ::recv(descriptor_, &hello, sizeof hello, MSG_TRUNC) != sizeof hello) {
    throw DeviceError("socket device: no hello of the device within 2 s");
  }
  if (hello.magic != SocketHello{}.magic) {
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

void SocketDevice::open() {
  guardian_ = std::make_unique<Guardian>(descriptor_, send_zero, silent_s_);
  // Until the first state there is no position to start from.
  pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
  if (::poll(&end, 1, kHelloMs) != 1) {
    guardian_.reset();
    throw DeviceError("socket device: no position of the device within 2 s");
  }
}

DeviceStatus SocketDevice::read(DeviceReading& reading) noexcept {
  // A driver that floods keeps nobody from the time of a tick.
  constexpr int kStatesMax = 64;
  DeviceStatus status = DeviceStatus::kLate;
  for (int taken = 0; taken < kStatesMax; ++taken) {
    SocketState state;
    const ssize_t bytes =
        ::recv(descriptor_, &state, sizeof state, MSG_DONTWAIT | MSG_TRUNC);
    if (bytes == sizeof state) {
      reading.time_ns = state.time_ns;
      reading.position_m = {state.position_m[0], state.position_m[1],
                            state.position_m[2]};
      status = DeviceStatus::kOk;
    } else if (bytes < 0 && errno == EAGAIN) {
      return status;
    } else if (bytes >= 0 || errno != EINTR) {
      return DeviceStatus::kLost;  // the other end is gone, or talks nonsense
    }
  }
  return status;
}

DeviceStatus SocketDevice::write(const Eigen::Vector3d& force_n) noexcept {
  const bool guarded = guardian_ != nullptr && guardian_->beat();
  const SocketCommand command{
      .sequence = ++sequence_,
      .force_n = guarded ? std::array{force_n.x(), force_n.y(), force_n.z()}
                         : std::array<double, 3>{}};
  const ssize_t sent =
      ::send(descriptor_, &command, sizeof command, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (!guarded || (sent < 0 && errno != EAGAIN && errno != EINTR)) {
    return DeviceStatus::kLost;
  }
  return sent < 0 ? DeviceStatus::kLate : DeviceStatus::kOk;
}

void SocketDevice::close() noexcept {
  if (guardian_ != nullptr) {
    send_zero(descriptor_, false);
    guardian_.reset();  // sends it, too
    send_zero(descriptor_, true);
  }
}

}  // namespace palpate

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/base/socket_peer.h"
#include "formats/service/service_socket.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

sockaddr_un address_of(const std::filesystem::path& socket) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = socket.string();
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    throw InputError(fmt::format(
        "socket '{}' has {} bytes, must have 1 to {}: give a shorter --socket", path,
        path.size(), sizeof(address.sun_path) - 1));
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

int new_socket() {
  return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

// Whether something can be done within that time.
bool wait_for(int descriptor, short what, milliseconds within) {
  const auto deadline = steady_clock::now() + within;
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    pollfd entry{.fd = descriptor, .events = what, .revents = 0};
    const int ready =
        ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(0, left.count())));
    if (ready > 0) {
      return true;
    }
    if (ready == 0 || errno != EINTR) {
      return false;
    }
  }
}

bool connects(int descriptor, const sockaddr_un& address) {
  return ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address),
                   sizeof(address)) == 0;
}

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

// Also one who hangs, with a queue full of those who would join.
bool somebody_listens(const sockaddr_un& address) {
  const int descriptor = new_socket();
  const bool listens =
      descriptor >= 0 && (connects(descriptor, address) || would_block());
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  return listens;
}

// Held by who looks whether somebody listens and then listens there: two at once would
// both see nobody, and the second take away the first's socket. A lock on the folder
// leaves no file behind; where it cannot be had, it is gone without.
class FolderOfSocket {
 public:
  explicit FolderOfSocket(const std::filesystem::path& socket)
      : descriptor_(
            ::open(socket.has_parent_path() ? socket.parent_path().c_str() : ".",
                   O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    while (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FolderOfSocket() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }
  FolderOfSocket(const FolderOfSocket&) = delete;
  FolderOfSocket& operator=(const FolderOfSocket&) = delete;

 private:
  int descriptor_;
};

}  // namespace

ServiceConnection::~ServiceConnection() {
  close();
}

ServiceConnection::ServiceConnection(ServiceConnection&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      frames_(std::move(other.frames_)) {}

ServiceConnection& ServiceConnection::operator=(ServiceConnection&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
    frames_ = std::move(other.frames_);
  }
  return *this;
}

void ServiceConnection::close() noexcept {
  if (descriptor_ >= 0) {
    ::close(std::exchange(descriptor_, -1));
  }
}

std::optional<ServiceConnection> ServiceConnection::join(
    const std::filesystem::path& socket) {
  const sockaddr_un address = address_of(socket);
  ServiceConnection connection(new_socket());
  if (!connection.is_open() || !connects(connection.descriptor_, address)) {
    return std::nullopt;
  }
  if (const auto stranger = stranger_at(connection.descriptor_)) {
    throw InputError(
        fmt::format("{}: a service of user {} listens there, must be yours or root's",
                    socket.string(), *stranger));
  }
  return connection;
}

bool ServiceConnection::send(std::span<const std::byte> frame, milliseconds within) {
  const auto deadline = steady_clock::now() + within;
  while (is_open() && !frame.empty()) {
    const ssize_t sent = ::send(descriptor_, frame.data(), frame.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      frame = frame.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    if (!would_block() || left.count() <= 0 || !wait_for(descriptor_, POLLOUT, left)) {
      close();  // half a frame may be out
    }
  }
  return is_open();
}

bool ServiceConnection::send(const ServiceMessage& message, milliseconds within) {
  return send(to_frame(message), within);
}

std::optional<ServiceMessage> ServiceConnection::receive(milliseconds within) {
  const auto deadline = steady_clock::now() + within;
  while (is_open()) {
    if (const std::vector<std::byte> body = frames_.next(); !body.empty()) {
      return message_from_bytes(body);
    }
    const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
    if (!wait_for(descriptor_, POLLIN, std::max(left, milliseconds(0)))) {
      return std::nullopt;
    }
    std::array<std::byte, 65536> buffer;
    const ssize_t got = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
    if (got > 0) {
      frames_.take(std::span(buffer).first(static_cast<std::size_t>(got)));
    } else if (got == 0 || !would_block()) {
      close();
    }
  }
  return std::nullopt;
}

ServiceListener::ServiceListener(std::filesystem::path socket)
    : socket_(std::move(socket)) {
  const sockaddr_un address = address_of(socket_);
  const auto deadline = std::chrono::steady_clock::now() + kGoing;
  std::optional<FolderOfSocket> folder(std::in_place, socket_);
  while (somebody_listens(address)) {
    folder.reset();
    if (std::chrono::steady_clock::now() > deadline) {
      throw InputError(
          fmt::format("a service listens at {} already: join it, or give another "
                      "--socket",
                      socket_.string()));
    }
    std::this_thread::sleep_for(milliseconds(50));
    folder.emplace(socket_);
  }
  std::error_code ignored;
  if (std::filesystem::is_socket(socket_, ignored)) {
    std::filesystem::remove(socket_, ignored);  // of one that was killed
  }
  descriptor_ = new_socket();
  const bool bound =
      descriptor_ >= 0 &&
      ::fchmod(descriptor_, S_IRUSR | S_IWUSR) == 0 &&  // of the file that bind() makes
      ::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address),
             sizeof(address)) == 0 &&
      ::listen(descriptor_, 8) == 0;
  if (!bound) {
    const std::string why = std::strerror(errno);
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    throw InputError(
        fmt::format("socket {} cannot be made: {}", socket_.string(), why));
  }
}

ServiceListener::~ServiceListener() {
  ::close(descriptor_);
  std::error_code ignored;
  std::filesystem::remove(socket_, ignored);
}

std::optional<ServiceConnection> ServiceListener::accept(milliseconds within) {
  if (!wait_for(descriptor_, POLLIN, within)) {
    return std::nullopt;
  }
  const int joined =
      ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (joined < 0) {
    return std::nullopt;
  }
  return ServiceConnection(joined);
}

}  // namespace palpate

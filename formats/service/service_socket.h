// The local socket between a service and those who join it (SERVICE.md).
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/service/service_message.h"

namespace palpate {

/// One end of a connection. One thread at a time; move-only.
class ServiceConnection {
 public:
  /// @param descriptor of a connected socket, which the connection then owns
  explicit ServiceConnection(int descriptor) noexcept : descriptor_(descriptor) {}
  ~ServiceConnection();
  ServiceConnection(ServiceConnection&& other) noexcept;
  ServiceConnection& operator=(ServiceConnection&& other) noexcept;

  /// None if nobody listens there. @throws InputError for a path that is longer than a
  /// socket's can be (107 bytes), and for a service of another user, but root.
  [[nodiscard]] static std::optional<ServiceConnection> join(
      const std::filesystem::path& socket);

  /// False if the other end is gone, or has not taken the frame in that time: the
  /// connection is then of no more use.
  [[nodiscard]] bool send(std::span<const std::byte> frame,
                          std::chrono::milliseconds within);
  [[nodiscard]] bool send(const ServiceMessage& message,
                          std::chrono::milliseconds within);

  /// The next message; none if none came in that time or the other end is gone, which
  /// is_open() tells apart. @throws FormatError for what is no message.
  [[nodiscard]] std::optional<ServiceMessage> receive(std::chrono::milliseconds within);

  [[nodiscard]] bool is_open() const noexcept { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  void close() noexcept;

 private:
  int descriptor_ = -1;
  FrameReader frames_;
};

/// A socket in the file system that others join; its owner alone may. Its file goes
/// away with it.
class ServiceListener {
 public:
  /// One that was killed may take a moment to go.
  static constexpr std::chrono::milliseconds kGoing{1000};

  /// A file of a service that is gone is replaced. @throws InputError if somebody still
  /// listens there after kGoing, the path is too long, or the place cannot be written.
  explicit ServiceListener(std::filesystem::path socket);
  ~ServiceListener();
  ServiceListener(const ServiceListener&) = delete;
  ServiceListener& operator=(const ServiceListener&) = delete;

  /// Who has joined since the last call; none within that time.
  [[nodiscard]] std::optional<ServiceConnection> accept(
      std::chrono::milliseconds within);

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

 private:
  std::filesystem::path socket_;
  int descriptor_ = -1;
};

/// Where the service of a scene listens unless another address is stated:
/// "OUTPUT.socket".
[[nodiscard]] inline std::filesystem::path service_socket(
    const std::filesystem::path& output) {
  return output.string() + ".socket";
}

}  // namespace palpate

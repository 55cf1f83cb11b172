#include "runtime/device/driven_device.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr std::int64_t kEndNs = 1'000'000'000;  // that a driver has to end in

}  // namespace

DrivenDevice::~DrivenDevice() {
  close();
}

void DrivenDevice::start(int descriptor) {
  ::fcntl(descriptor, F_SETFD, 0);  // stays open in the driver
  std::vector<std::string> words = program_.command;
  words.emplace_back("--descriptor");
  words.push_back(std::to_string(descriptor));
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  const int error = ::posix_spawn(&driver_, arguments[0], nullptr, nullptr,
                                  arguments.data(), environ);
  if (error != 0) {
    driver_ = -1;
    throw DeviceError(fmt::format("{}: its driver {} cannot be started: {}",
                                  program_.name, words[0], std::strerror(error)));
  }
}

void DrivenDevice::open() {
  close();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw DeviceError(fmt::format("{}: no socket for its driver: {}", program_.name,
                                  std::strerror(errno)));
  }
  try {
    start(ends[1]);
  } catch (...) {
    ::close(ends[0]);
    // The driver's end closes here, so that the socket ends when the driver does.
    ::close(ends[1]);
    throw;
  }
  ::close(ends[1]);
  try {
    SocketPatience patience;
    patience.hello_s = program_.open_s;
    patience.stopped = program_.stopped;
    device_ = std::make_unique<SocketDevice>(ends[0], patience);
    turns_ = device_->measures_turns();
    device_->open();
  } catch (...) {
    close();
    throw;
  }
}

DeviceStatus DrivenDevice::read(DeviceReading& reading) noexcept {
  return device_ == nullptr ? DeviceStatus::kLost : device_->read(reading);
}

DeviceStatus DrivenDevice::write(const Eigen::Vector3d& force_n) noexcept {
  return device_ == nullptr ? DeviceStatus::kLost : device_->write(force_n);
}

std::string DrivenDevice::failure() const {
  return device_ == nullptr ? failure_ : device_->failure();
}

void DrivenDevice::end_driver() noexcept {
  if (driver_ < 0) {
    return;
  }
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + kEndNs;
  pid_t ended = 0;
  while ((ended = ::waitpid(driver_, nullptr, WNOHANG)) == 0 &&
         clock.now_ns() < until_ns) {
    clock.sleep_until_ns(clock.now_ns() + 1'000'000);
  }
  if (ended == 0) {
    ::kill(driver_, SIGKILL);
    ::waitpid(driver_, nullptr, 0);
  }
  driver_ = -1;
}

void DrivenDevice::close() noexcept {
  if (device_ != nullptr) {
    device_->close();
    report_ = *device_->wire();
    failure_ = device_->failure();
    device_.reset();
  }
  end_driver();
}

}  // namespace palpate

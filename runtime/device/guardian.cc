#include "runtime/device/guardian.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>
#include <new>

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr int kGuardianPriority = 81;  // SCHED_FIFO, one above the fast thread
constexpr int kEndMs = 100;  // within which a lifeline closes whose process has died
constexpr int kLookMs = 5;
constexpr int kLooks = 8;  // a patience

[[noreturn]] void fail(const char* what) {
  throw DeviceError(
      fmt::format("no guardian for the device: {}: {}", what, std::strerror(errno)));
}

// Everything that the parent has open except the two.
void close_others(int a, int b) noexcept {
  const auto low = static_cast<unsigned>(std::min(a, b));
  const auto high = static_cast<unsigned>(std::max(a, b));
  if (low > 0) {
    ::close_range(0, low - 1, 0);
  }
  if (high > low + 1) {
    ::close_range(low + 1, high - 1, 0);
  }
  ::close_range(high + 1, ~0U, 0);
}

// Whether the other end is closed, after waiting for that.
bool is_closed(int lifeline, int wait_ms) noexcept {
  pollfd end{.fd = lifeline, .events = POLLIN, .revents = 0};
  return ::poll(&end, 1, wait_ms) > 0;
}

timespec after(std::int64_t duration_ns) noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t ns = time.tv_nsec + duration_ns;
  return {.tv_sec = time.tv_sec + ns / kSecondNs, .tv_nsec = ns % kSecondNs};
}

}  // namespace

Guardian::Guardian(int device_descriptor, ZeroForce zero_force, double silent_s) {
  if (!(silent_s > 0.0)) {
    throw DeviceError(fmt::format(
        "no guardian for the device: its patience is {} s, must be positive",
        silent_s));
  }
  // The lifeline closes with the last end of this process. Shared memory has the beats
  // and a robust mutex, by which the child learns that the beating thread has died.
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail("socketpair");
  }
  void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    ::close(ends[0]);
    ::close(ends[1]);
    fail("shared memory");
  }
  shared_ = new (memory) Shared;
  // The child never returns from guard().
  child_ = init(shared_->held) ? ::fork() : -1;
  if (child_ == 0) {
    ::close(ends[0]);
    const double silent_ns =
        std::min(silent_s, 3600.0) * static_cast<double>(kSecondNs);
    guard(*shared_, ends[1], device_descriptor, zero_force, std::llround(silent_ns));
  }
  ::close(ends[1]);
  lifeline_ = ends[0];
  if (child_ < 0) {
    ::close(lifeline_);
    ::munmap(memory, sizeof(Shared));
    fail("fork");
  }
}

// A mutex that tells who waits for it that its owner has died.
bool Guardian::init(pthread_mutex_t& mutex) noexcept {
  pthread_mutexattr_t attributes;
  const bool done =
      ::pthread_mutexattr_init(&attributes) == 0 &&
      ::pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED) == 0 &&
      ::pthread_mutexattr_setrobust(&attributes, PTHREAD_MUTEX_ROBUST) == 0 &&
      ::pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_ERRORCHECK) == 0 &&
      ::pthread_mutex_init(&mutex, &attributes) == 0;
  ::pthread_mutexattr_destroy(&attributes);
  return done;
}

Guardian::~Guardian() {
  ::close(lifeline_);
  if (beating_) {
    // Has no effect where another thread beat: that has ended, or silence tells.
    ::pthread_mutex_unlock(&shared_->held);
  }
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
  ::munmap(shared_, sizeof(Shared));
}

bool Guardian::beat() noexcept {
  if (!beating_) {
    beating_ = ::pthread_mutex_trylock(&shared_->held) == 0;
  }
  shared_->beats.fetch_add(1, std::memory_order_release);
  // The guardian never writes: anything but "nothing to read" means that it is gone.
  char byte = 0;
  const ssize_t read = ::recv(lifeline_, &byte, 1, MSG_DONTWAIT | MSG_PEEK);
  const bool there = read < 0 && (errno == EAGAIN || errno == EINTR);
  return there && !shared_->tripped.load(std::memory_order_acquire);
}

void Guardian::guard(Shared& shared, int lifeline, int device_descriptor,
                     ZeroForce zero_force, std::int64_t silent_ns) noexcept {
  ::setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
    ::signal(signal, SIG_IGN);
  }
  const sched_param priority{.sched_priority = kGuardianPriority};
  ::sched_setscheduler(0, SCHED_FIFO, &priority);  // where permitted
  close_others(lifeline, device_descriptor);
  // Until somebody holds the mutex, look at the socket alone.
  while (shared.beats.load(std::memory_order_acquire) == 0) {
    if (is_closed(lifeline, kLookMs)) {
      zero_force(device_descriptor, true);
      ::_exit(0);
    }
  }
  // Several looks a patience: silence is seen when it has lasted, not up to twice that.
  std::uint64_t seen = 0;
  int quiet = 0;
  for (;;) {
    const timespec until = after(silent_ns / kLooks);
    const int got = ::pthread_mutex_clocklock(&shared.held, CLOCK_MONOTONIC, &until);
    if (got != ETIMEDOUT || is_closed(lifeline, 0)) {
      // What the device's end says last is for the process, where that lives and a
      // thread alone has ended.
      zero_force(device_descriptor, false);
      if (is_closed(lifeline, kEndMs)) {
        zero_force(device_descriptor, true);
      }
      ::_exit(0);
    }
    const std::uint64_t beats = shared.beats.load(std::memory_order_acquire);
    quiet = beats == seen ? quiet + 1 : 0;
    seen = beats;
    if (quiet >= kLooks) {
      quiet = 0;
      shared.tripped.store(true, std::memory_order_release);
      zero_force(device_descriptor, false);
    }
  }
}

}  // namespace palpate

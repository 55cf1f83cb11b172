#include "precompute/process/run_in_child.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <mutex>
#include <new>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/die_with_parent.h"
#include "precompute/process/patience.h"
#include "precompute/process/random_sequence.h"

namespace palpate {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;
#else
constexpr bool kLimitMemory = true;
#endif

constexpr int kThrew = 101;
constexpr int kOutOfMemory = 102;
constexpr int kPipeBroke = 103;
constexpr int kNoMemory = 104;
constexpr double kLongestWait = 20.0;  // over the limit of processor time

// False where the user has set a lower one.
bool limit_resource(int resource, rlim_t value) {
  const rlimit limit{value, value};
  return setrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0;
}

void silence_output() {
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
  }
}

std::size_t address_space_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

bool write_all(int pipe, const std::vector<char>& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = write(pipe, bytes.data() + sent, bytes.size() - sent);
    if (n < 0 && errno != EINTR) {
      return false;
    }
    sent += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  return true;
}

// A child and the end of the pipe that it writes to; nothing of it outlives this.
class Forked {
 public:
  Forked(pid_t child, int pipe) : child_(child), pipe_(pipe) {}
  ~Forked() {
    if (child_ > 0) {
      (void)end();
    }
  }
  Forked(const Forked&) = delete;
  Forked& operator=(const Forked&) = delete;

  [[nodiscard]] pid_t child() const { return child_; }
  [[nodiscard]] int pipe() const { return pipe_; }

  // Kills it, unless it has said all. @return its status.
  int end(bool has_said_all = false) {
    close(pipe_);
    if (!has_said_all) {
      kill(child_, SIGKILL);
    }
    return wait_for_child(std::exchange(child_, -1));
  }

 private:
  pid_t child_;
  int pipe_;
};

// Children do not execute another program, so what is open is theirs, too. One at a
// time makes a pipe, forks and closes the end that writes: no other child holds that
// open, and the end of this one is its end. Nobody draws from the random sequence
// meanwhile, whose lock the child would find taken.
Forked fork_with_pipe(const std::function<void(int pipe)>& in_child) {
  const std::lock_guard nobody_draws(random_sequence_mutex());
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw ResourceError(
        fmt::format("cannot make a pipe to another process: {}", std::strerror(errno)));
  }
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    in_child(ends[1]);
  }
  const int reason = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw ResourceError(
        fmt::format("cannot start another process: {}", std::strerror(reason)));
  }
  return {child, ends[0]};
}

[[noreturn]] void send_from_child(pid_t parent, int pipe,
                                  const std::function<std::vector<char>()>& work,
                                  std::size_t memory_bytes) {
  die_with_parent(parent);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGABRT, SIGSEGV, SIGFPE}) {
    std::signal(signal, SIG_DFL);
  }
  sigset_t none;  // blocked, where the parent notes interrupts
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  silence_output();
  limit_resource(RLIMIT_CORE, 0);
  const bool limited = kLimitMemory && limit_resource(RLIMIT_AS, memory_bytes);
  try {
    const std::vector<char> bytes = work();
    _exit(write_all(pipe, bytes) ? 0 : kPipeBroke);
  } catch (const std::bad_alloc&) {
    _exit(limited ? kOutOfMemory : kNoMemory);
  } catch (...) {
    _exit(kThrew);
  }
}

// Processor time that a child has taken [s].
double cpu_seconds_of(pid_t child) {
  clockid_t clock{};
  timespec taken{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &taken) != 0) {
    return 0.0;
  }
  return static_cast<double>(taken.tv_sec) + 1e-9 * static_cast<double>(taken.tv_nsec);
}

enum class End { kClosed, kTooMuchTime, kWaited };

// Reads until the other end closes, or until a limit of time has passed.
End read_until_closed(const Forked& forked, double time_s, std::vector<char>& bytes) {
  using Clock = std::chrono::steady_clock;
  const auto deadline =
      Clock::now() + std::chrono::duration<double>(kLongestWait * time_s);
  const int look_ms = static_cast<int>(std::clamp(1e3 * time_s, 1.0, 1e3));
  std::vector<char> block(1 << 20);
  while (true) {
    pollfd ready{forked.pipe(), POLLIN, 0};
    if (poll(&ready, 1, look_ms) <= 0) {
      if (cpu_seconds_of(forked.child()) > time_s) {
        return End::kTooMuchTime;
      }
      if (Clock::now() > deadline) {
        return End::kWaited;
      }
      continue;
    }
    const ssize_t n = read(forked.pipe(), block.data(), block.size());
    if (n == 0) {
      return End::kClosed;
    }
    if (n > 0) {
      bytes.insert(bytes.end(), block.begin(), block.begin() + n);
    }
  }
}

// @throws what is not the work's fault: interrupts, and kills that it did not cause.
std::string child_failure(int status, const ChildLimits& limits) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM) {
      throw Interrupted();
    }
    if (WTERMSIG(status) == SIGKILL) {
      throw ResourceError(
          "another process that this one started was killed, perhaps for want of "
          "memory: fewer --workers take less");
    }
    return fmt::format("it died of signal {} ({})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
  }
  switch (WEXITSTATUS(status)) {
    case kNoMemory:
      throw ResourceError("another process that this one started found no memory");
    case kOutOfMemory:
      return fmt::format("it needed more than {:.3g} GB of memory",
                         static_cast<double>(limits.memory_bytes) / 1e9);
    case kThrew:
      return "it threw an exception";
    default:
      return fmt::format("it ended the process with code {}", WEXITSTATUS(status));
  }
}

ChildResult run_once(const std::function<std::vector<char>()>& work,
                     const ChildLimits& limits) {
  const std::size_t memory_bytes = address_space_bytes() + limits.memory_bytes;
  const pid_t parent = getpid();
  Forked forked = fork_with_pipe([&](int pipe) {
    send_from_child(parent, pipe, work, memory_bytes);
  });
  ChildResult result;
  const End end = read_until_closed(forked, limits.time_s, result.bytes);
  const int status = forked.end(end == End::kClosed);
  if (end == End::kWaited) {
    throw ResourceError(fmt::format(
        "another process that this one started got less than {:.3g} s of a processor "
        "within {:.3g} s",
        limits.time_s, kLongestWait * limits.time_s));
  }
  result.done = end == End::kClosed && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  result.at_limit = end == End::kTooMuchTime ||
                    (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory);
  if (end == End::kTooMuchTime) {
    result.failure = fmt::format("it took longer than {:.3g} s", limits.time_s);
  } else if (!result.done) {
    result.failure = child_failure(status, limits);
  }
  return result;
}

}  // namespace

ChildResult run_in_child(const std::function<std::vector<char>()>& work,
                         const ChildLimits& limits) {
  ChildResult result;
  with_patience(kMomentS, "another process", [&] {
    result = run_once(work, limits);
  });
  return result;
}

}  // namespace palpate

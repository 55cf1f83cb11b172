#include "precompute/process/run_in_child.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/die_with_parent.h"
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

void limit_resource(int resource, rlim_t value) {
  const rlimit limit{value, value};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
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

// While nobody draws from the random sequence, whose lock the child would find taken.
pid_t fork_alone() {
  const std::lock_guard nobody_draws(random_sequence_mutex());
  return fork();
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
  if (kLimitMemory) {
    limit_resource(RLIMIT_AS, memory_bytes);
  }
  try {
    const std::vector<char> bytes = work();
    _exit(write_all(pipe, bytes) ? 0 : kPipeBroke);
  } catch (const std::bad_alloc&) {
    _exit(kOutOfMemory);
  } catch (...) {
    _exit(kThrew);
  }
}

// Reads until the other end closes. False if the deadline passed first.
bool read_until_closed(int pipe, double time_s, std::vector<char>& bytes) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(time_s);
  std::vector<char> block(1 << 20);
  while (true) {
    const double left_s =
        std::chrono::duration<double>(deadline - Clock::now()).count();
    if (left_s <= 0.0) {
      return false;
    }
    pollfd ready{pipe, POLLIN, 0};
    const int wait_ms = static_cast<int>(std::min(left_s * 1e3 + 1.0, 1e3));
    if (poll(&ready, 1, wait_ms) <= 0) {
      continue;
    }
    const ssize_t n = read(pipe, block.data(), block.size());
    if (n == 0) {
      return true;
    }
    if (n > 0) {
      bytes.insert(bytes.end(), block.begin(), block.begin() + n);
    }
  }
}

std::string child_failure(int status, const ChildLimits& limits) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM) {
      throw Interrupted();
    }
    return fmt::format("it died of signal {} ({})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
  }
  switch (WEXITSTATUS(status)) {
    case kOutOfMemory:
      return fmt::format("it needed more than {:.3g} GB of memory",
                         static_cast<double>(limits.memory_bytes) / 1e9);
    case kThrew:
      return "it threw an exception";
    default:
      return fmt::format("it ended the process with code {}", WEXITSTATUS(status));
  }
}

}  // namespace

ChildResult run_in_child(const std::function<std::vector<char>()>& work,
                         const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw NumericalError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  const std::size_t memory_bytes = address_space_bytes() + limits.memory_bytes;
  const pid_t parent = getpid();
  const pid_t pid = fork_alone();
  if (pid < 0) {
    const int reason = errno;
    close(ends[0]);
    close(ends[1]);
    throw NumericalError(
        fmt::format("cannot start a process: {}", std::strerror(reason)));
  }
  if (pid == 0) {
    close(ends[0]);
    send_from_child(parent, ends[1], work, memory_bytes);
  }
  close(ends[1]);
  ChildResult result;
  const bool in_time = read_until_closed(ends[0], limits.time_s, result.bytes);
  close(ends[0]);
  if (!in_time) {
    kill(pid, SIGKILL);
  }
  const int status = wait_for_child(pid);
  result.done = in_time && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  result.at_limit =
      !in_time || (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory);
  if (!in_time) {
    result.failure = fmt::format("it took longer than {:.3g} s", limits.time_s);
  } else if (!result.done) {
    result.failure = child_failure(status, limits);
  }
  return result;
}

}  // namespace palpate

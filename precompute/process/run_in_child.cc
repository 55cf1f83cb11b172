#include "precompute/process/run_in_child.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/die_with_parent.h"
#include "precompute/process/patience.h"

namespace palpate {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;
#else
constexpr bool kLimitMemory = true;
#endif

constexpr int kThrew = 101;
constexpr int kOutOfMemory = 102;
constexpr int kNoMemory = 104;
constexpr double kLongestWait = 20.0;           // over the limit of processor time
constexpr std::size_t kMostKept = 256'000'000;  // bytes, between two pieces of work

// A child and its owner are of one program: what crosses between them is as it lies in
// memory, and a function has one address in both.
struct ChildRequest {
  ChildWork work = nullptr;
  std::size_t memory_bytes = 0;
  std::size_t input = 0;  // bytes, which follow
};

struct Answer {
  bool is_last = false;   // the child ends after it
  std::size_t bytes = 0;  // which follow
};

bool send_all(int socket, const void* data, std::size_t size) {
  const char* next = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = send(socket, next, size, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR) {
      return false;
    }
    const std::size_t sent = n > 0 ? static_cast<std::size_t>(n) : 0;
    next += sent;
    size -= sent;
  }
  return true;
}

// What is there of so many bytes: 0 where the other end has closed.
std::size_t receive_some(int socket, void* data, std::size_t size) {
  ssize_t n = 0;
  do {
    n = recv(socket, data, size, 0);
  } while (n < 0 && errno == EINTR);
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

bool receive_all(int socket, void* data, std::size_t size) {
  char* next = static_cast<char*>(data);
  while (size > 0) {
    const std::size_t n = receive_some(socket, next, size);
    if (n == 0) {
      return false;
    }
    next += n;
    size -= n;
  }
  return true;
}

// The address space, or what of it is in memory.
std::size_t memory_bytes(bool resident) {
  std::size_t all = 0;
  std::size_t in_memory = 0;
  std::ifstream("/proc/self/statm") >> all >> in_memory;
  return (resident ? in_memory : all) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Holds the address space to so many bytes while it lives, or to fewer if the user did.
class MemoryLimit {
 public:
  explicit MemoryLimit(rlim_t bytes) {
    getrlimit(RLIMIT_AS, &users_);
    const rlimit limit{std::min(bytes, users_.rlim_cur), users_.rlim_max};
    is_ours_ =
        kLimitMemory && setrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur == bytes;
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &users_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  [[nodiscard]] bool is_ours() const { return is_ours_; }

 private:
  rlimit users_{};
  bool is_ours_ = false;
};

// Ends the process unless the work returned: what else it left behind ends with it.
std::vector<char> done(const ChildRequest& request, std::span<const char> input) {
  const MemoryLimit limit(memory_bytes(false) + request.memory_bytes);
  try {
    return request.work(input);
  } catch (const std::bad_alloc&) {
    _exit(limit.is_ours() ? kOutOfMemory : kNoMemory);
  } catch (...) {
    _exit(kThrew);
  }
}

bool serve_request(int socket) {
  ChildRequest request;
  if (!receive_all(socket, &request, sizeof(request))) {
    return false;
  }
  std::vector<char> input(request.input);
  if (!receive_all(socket, input.data(), input.size())) {
    return false;
  }
  const std::vector<char> bytes = done(request, input);
  const Answer answer{.is_last = memory_bytes(true) > kMostKept, .bytes = bytes.size()};
  return send_all(socket, &answer, sizeof(answer)) &&
         send_all(socket, bytes.data(), bytes.size()) && !answer.is_last;
}

void silence_output() {
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    close(null);
  }
}

// What the owner has open is not the child's: locks on files, others' sockets.
[[noreturn]] void be_child(pid_t owner, int socket) {
  die_with_parent(owner);
  constexpr int kSocket = STDERR_FILENO + 1;
  if (socket != kSocket) {
    dup2(socket, kSocket);
  }
  close_range(kSocket + 1, UINT_MAX, 0);
  silence_output();
  for (const int signal :
       {SIGINT, SIGTERM, SIGPIPE, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
    std::signal(signal, SIG_DFL);
  }
  sigset_t none;  // blocked, where the owner notes interrupts
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  try {
    while (serve_request(kSocket)) {
    }
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  }
  _exit(0);
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
          "memory: fewer --threads take less");
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

enum class End { kAnswered, kClosed, kTooMuchTime, kWaited };

class Child {
 public:
  Child() : owner_(getpid()) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw ResourceError(fmt::format("cannot make a socket to another process: {}",
                                      std::strerror(errno)));
    }
    process_ = fork();
    if (process_ == 0) {
      be_child(owner_, ends[1]);
    }
    const int reason = errno;
    close(ends[1]);
    socket_ = ends[0];
    if (process_ < 0) {
      close(socket_);
      throw ResourceError(
          fmt::format("cannot start another process: {}", std::strerror(reason)));
    }
  }
  ~Child() {
    close(socket_);
    if (is_mine() && process_ > 0) {
      kill(process_, SIGKILL);
      (void)wait_for_child(process_);
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Else it is that of a process which this one was forked from.
  [[nodiscard]] bool is_mine() const { return owner_ == getpid(); }

  // One that is idle may have been killed, or have ended with the thread that had it
  // forked.
  [[nodiscard]] bool is_alive() {
    if (process_ > 0 && waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
    }
    return process_ > 0 && !is_last_;
  }

  ChildResult run(ChildWork work, std::span<const char> input,
                  const ChildLimits& limits) {
    const double taken_s = cpu_seconds();
    const ChildRequest request{
        .work = work, .memory_bytes = limits.memory_bytes, .input = input.size()};
    ChildResult result;
    const End end = send_all(socket_, &request, sizeof(request)) &&
                            send_all(socket_, input.data(), input.size())
                        ? receive(taken_s + limits.time_s, limits.time_s, result.bytes)
                        : End::kClosed;
    result.done = end == End::kAnswered;
    result.at_limit = end == End::kTooMuchTime;
    if (end == End::kWaited) {
      throw ResourceError(fmt::format(
          "another process that this one started got less than {:.3g} s of a processor "
          "within {:.3g} s",
          limits.time_s, kLongestWait * limits.time_s));
    }
    if (end == End::kTooMuchTime) {
      result.failure = fmt::format("it took longer than {:.3g} s", limits.time_s);
    }
    if (end == End::kClosed) {
      const int status = wait_for_child(std::exchange(process_, -1));
      result.failure = child_failure(status, limits);
      result.at_limit = WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory;
    }
    return result;
  }

 private:
  // Processor time that it has taken [s].
  [[nodiscard]] double cpu_seconds() const {
    clockid_t clock{};
    timespec taken{};
    if (clock_getcpuclockid(process_, &clock) != 0 ||
        clock_gettime(clock, &taken) != 0) {
      return 0.0;
    }
    return static_cast<double>(taken.tv_sec) +
           1e-9 * static_cast<double>(taken.tv_nsec);
  }

  // Until all of the answer is there, or the child ends, or a limit of time has passed.
  [[nodiscard]] End receive(double cpu_end_s, double time_s, std::vector<char>& bytes) {
    using Clock = std::chrono::steady_clock;
    const auto deadline =
        Clock::now() + std::chrono::duration<double>(kLongestWait * time_s);
    const int look_ms = static_cast<int>(std::clamp(1e3 * time_s, 1.0, 1e3));
    pollfd ready{socket_, POLLIN, 0};
    while (poll(&ready, 1, look_ms) <= 0) {
      if (cpu_seconds() > cpu_end_s) {
        return End::kTooMuchTime;
      }
      if (Clock::now() > deadline) {
        return End::kWaited;
      }
    }
    Answer answer;
    if (!receive_all(socket_, &answer, sizeof(answer))) {
      return End::kClosed;
    }
    is_last_ = answer.is_last;
    bytes.resize(answer.bytes);
    return receive_all(socket_, bytes.data(), bytes.size()) ? End::kAnswered
                                                            : End::kClosed;
  }

  pid_t owner_;
  pid_t process_ = -1;
  int socket_ = -1;
  bool is_last_ = false;
};

class IdleChildren {
 public:
  std::unique_ptr<Child> take_or_fork() {
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(idle_, [](const auto& child) {
        return !child->is_mine() || !child->is_alive();
      });
      if (!idle_.empty()) {
        std::unique_ptr<Child> child = std::move(idle_.back());
        idle_.pop_back();
        return child;
      }
    }
    return std::make_unique<Child>();
  }

  void put(std::unique_ptr<Child> child) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(child));
  }

  void clear() {
    const std::lock_guard lock(mutex_);
    idle_.clear();
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Child>> idle_;
};

IdleChildren& idle_children() {
  static IdleChildren all;
  return all;
}

}  // namespace

ChildResult run_in_child(ChildWork work, std::span<const char> input,
                         const ChildLimits& limits) {
  ChildResult result;
  with_patience(kMomentS, "another process", [&] {
    std::unique_ptr<Child> child = idle_children().take_or_fork();
    result = child->run(work, input, limits);
    if (result.done) {
      idle_children().put(std::move(child));
    }
  });
  return result;
}

void keep_children_ready(std::size_t count) {
  std::vector<std::unique_ptr<Child>> ready;
  try {
    while (ready.size() < count) {
      ready.push_back(idle_children().take_or_fork());
    }
  } catch (const ResourceError&) {
    // Later.
  }
  for (std::unique_ptr<Child>& child : ready) {
    idle_children().put(std::move(child));
  }
}

void end_idle_children() {
  idle_children().clear();
}

}  // namespace palpate

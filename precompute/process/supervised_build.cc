#include "precompute/process/supervised_build.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/die_with_parent.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/run_in_child.h"

namespace palpate {
namespace {

constexpr int kMostCrashes = 100;

struct Crash {
  std::int32_t vertex = -1;
  int signal = 0;
};

// In memory that parent and children share: the children's crashes so far.
struct Crashes {
  std::atomic<int> count = 0;
  std::array<Crash, kMostCrashes> crash;
};

// Set before the first child; read-only but for the crash handler.
Crashes* g_crashes =
    nullptr;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<pid_t> g_child =
    0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<int> g_unsent =
    0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
thread_local std::int32_t t_vertex = -1;

// Notes the vertex of the thread that crashed and dies as without a handler.
void note_crash(int signal) {
  if (t_vertex >= 0 && g_crashes != nullptr) {
    const int at = g_crashes->count.fetch_add(1);
    if (at < kMostCrashes) {
      g_crashes->crash[static_cast<std::size_t>(at)] = {t_vertex, signal};
    }
  }
  std::signal(signal, SIG_DFL);
  raise(signal);
}

// Hands the signal on for which there was no child before, if any.
void hand_on_unsent() {
  const pid_t child = g_child.load();
  if (child > 0) {
    if (const int signal = g_unsent.exchange(0); signal != 0) {
      kill(child, signal);
    }
  }
}

// Ctrl-C reaches a child by itself; a signal that somebody sent to this process alone
// does not.
void hand_on(int signal, siginfo_t* info, void* /*context*/) {
  if (g_child.load() <= 0 || info->si_code <= 0) {
    g_unsent = signal;
    hand_on_unsent();
  }
}

void set_handlers() {
  struct sigaction action {};
  action.sa_flags = SA_SIGINFO;
  action.sa_sigaction = hand_on;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Interrupts of this thread and of children that it forks wait. Other threads (a
// library's) still take the process's.
void hold_interrupts(bool held) {
  sigset_t interrupts;
  sigemptyset(&interrupts);
  sigaddset(&interrupts, SIGINT);
  sigaddset(&interrupts, SIGTERM);
  sigprocmask(held ? SIG_BLOCK : SIG_UNBLOCK, &interrupts, nullptr);
}

[[noreturn]] void build_in_child(pid_t parent, const std::function<int(bool)>& work,
                                 bool resume) {
  die_with_parent(parent);
  std::signal(SIGINT, SIG_DFL);  // until the work has its own handler
  std::signal(SIGTERM, SIG_DFL);
  hold_interrupts(false);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    std::signal(signal, note_crash);
  }
  const int code = work(resume);
  std::fflush(nullptr);
  end_idle_children();
  _exit(code);
}

}  // namespace

void note_pressed_vertex(std::int32_t vertex) {
  t_vertex = vertex;
}

int signal_of_crash_at(std::int32_t vertex) {
  const int count = g_crashes != nullptr ? g_crashes->count.load() : 0;
  for (int i = 0; i < std::min(count, kMostCrashes); ++i) {
    const Crash& crash = g_crashes->crash[static_cast<std::size_t>(i)];
    if (crash.vertex == vertex) {
      return crash.signal;
    }
  }
  return 0;
}

int run_supervised(const std::function<int(bool)>& work,
                   const std::string& how_to_go_on) {
  void* shared = mmap(nullptr, sizeof(Crashes), PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) {
    return work(false);
  }
  g_crashes = new (shared) Crashes;
  std::fflush(nullptr);
  for (bool resume = false;; resume = true) {
    const int before = g_crashes->count.load();
    hold_interrupts(true);
    set_handlers();
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid < 0) {
      hold_interrupts(false);
      return work(resume);
    }
    if (pid == 0) {
      build_in_child(parent, work, resume);
    }
    g_child = pid;
    hand_on_unsent();
    hold_interrupts(false);
    const int status = wait_for_child(pid);
    g_child = 0;
    if (WIFEXITED(status)) {
      return WEXITSTATUS(status);
    }
    const int signal = WTERMSIG(status);
    if (signal == SIGINT || signal == SIGTERM) {
      throw Interrupted();
    }
    const int after = g_crashes->count.load();
    const auto newest = g_crashes->crash.begin() + std::max(after - 1, 0);
    const bool again =
        std::any_of(g_crashes->crash.begin(), newest, [&](const Crash& crash) {
          return crash.vertex == newest->vertex;
        });
    if (after == before || again || after >= kMostCrashes) {
      const std::string kept =
          fmt::format("what it had solved is kept: {} goes on with it", how_to_go_on);
      if (signal == SIGKILL) {
        throw ResourceError(
            "the build was killed (signal 9), perhaps for want of memory: fewer "
            "--threads take less; " +
            kept);
      }
      throw NumericalError(fmt::format("the build died of signal {} ({}); {}", signal,
                                       strsignal(signal), kept));
    }
    fmt::print(stderr,
               "palpate-precompute: warning: vertex {} crashed its press (signal {}, "
               "{}); going on without it\n",
               newest->vertex, signal, strsignal(signal));
  }
}

}  // namespace palpate

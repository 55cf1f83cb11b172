#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/served/service_process.h"

extern char** environ;

namespace palpate {
namespace {

constexpr const char* kProgram = "palpate-precompute";

bool is_program(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) &&
         ::access(file.c_str(), X_OK) == 0;
}

// In a group of its own, signals and scheduling as a program expects them, stdout on
// stderr, nothing else open.
int spawn(const std::vector<std::string>& words, int& id) {
  std::vector<char*> arguments;
  for (const std::string& word : words) {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  // The runtime may block signals and run in real time. A service inherits neither.
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  const sched_param usual{};
  posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  posix_spawnattr_setschedparam(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                            POSIX_SPAWN_SETSIGDEF |
                                            POSIX_SPAWN_SETSCHEDULER);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
#endif
  const int failure = ::posix_spawn(&id, arguments.front(), &actions, &attributes,
                                    arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return failure;
}

}  // namespace

std::filesystem::path find_server(const std::filesystem::path& given) {
  if (!given.empty()) {
    if (!is_program(given)) {
      throw InputError(fmt::format("server {}: no program is there", given.string()));
    }
    return given;
  }
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (const auto beside = self.parent_path() / kProgram; is_program(beside)) {
    return beside;
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const auto there = std::filesystem::path(folder) / kProgram;
    if (!folder.empty() && is_program(there)) {  // empty is the present folder
      return there;
    }
  }
  throw InputError(
      fmt::format("{} is neither beside this program nor in PATH: it computes a "
                  "scene's responses; name it as the server, or build the database "
                  "elsewhere",
                  kProgram));
}

ServiceProcess::ServiceProcess(const ServiceCommand& command) {
  std::vector<std::string> words = {
      command.program.string(), "serve",  command.scene.string(),    "-o",
      command.output.string(),  "--with", std::to_string(::getpid())};
  if (command.anew) {
    words.emplace_back("--anew");
  }
  if (const int failure = spawn(words, id_); failure != 0) {
    throw InputError(fmt::format("{} cannot be started: {}", command.program.string(),
                                 std::strerror(failure)));
  }
}

std::optional<int> ServiceProcess::exit_code() noexcept {
  if (exit_code_) {
    return exit_code_;
  }
  int status = 0;
  const pid_t ended = ::waitpid(id_, &status, WNOHANG);
  if (ended == id_) {
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  } else if (ended < 0 && errno == ECHILD) {
    exit_code_ = kReapedElsewhere;
  }
  return exit_code_;
}

ServiceProcess::~ServiceProcess() {
  if (exit_code()) {
    return;
  }
  ::kill(id_, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!exit_code() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!exit_code()) {
    ::kill(-id_, SIGKILL);  // its whole group
    int status = 0;
    ::waitpid(id_, &status, 0);
  }
}

}  // namespace palpate

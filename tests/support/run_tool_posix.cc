#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

void redirect(const std::filesystem::path& file, int descriptor) {
  const int to = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(to, descriptor);
}

// Waits for the end of a child, and does something meanwhile.
using Meanwhile = std::function<int(pid_t child)>;

int wait_for(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

ToolRun run(const std::string& tool, const std::vector<std::string>& arguments,
            const Meanwhile& meanwhile) {
  const ScratchFolder scratch;
  const std::string program = (std::filesystem::path(PALPATE_BIN_DIR) / tool).string();
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) {
    argv.push_back(const_cast<char*>(argument.c_str()));
  }
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    redirect(scratch / "out", STDOUT_FILENO);
    redirect(scratch / "err", STDERR_FILENO);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  const int status = meanwhile(child);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          content(scratch / "out"), content(scratch / "err")};
}

}  // namespace

ToolRun run_tool_process(const std::string& tool,
                         const std::vector<std::string>& arguments) {
  return run(tool, arguments, wait_for);
}

ToolRun interrupt_tool_process(const std::string& tool,
                               const std::vector<std::string>& arguments,
                               int milliseconds) {
  return run(tool, arguments, [&](pid_t child) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, SIGINT);
    return wait_for(child);
  });
}

ToolRun kill_tool_process(const std::string& tool,
                          const std::vector<std::string>& arguments,
                          const std::function<bool()>& now, int signal) {
  return run(tool, arguments, [&](pid_t child) {
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (now()) {
        kill(child, signal);
        return wait_for(child);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return status;
  });
}

}  // namespace palpate

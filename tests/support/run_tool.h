// Runs one of the command-line tools as a user would.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace palpate {

struct ToolRun {
  int exit_code = -1;  ///< 128 + n if signal n ended it
  std::string out;
  std::string err;
};

/// @param tool e.g. "palpate-db"; @param arguments passed as they are, no shell.
[[nodiscard]] ToolRun run_tool_process(const std::string& tool,
                                       const std::vector<std::string>& arguments);

/// Starts the tool, sends it SIGINT after `milliseconds`, and waits for its end.
[[nodiscard]] ToolRun interrupt_tool_process(const std::string& tool,
                                             const std::vector<std::string>& arguments,
                                             int milliseconds);

/// Starts the tool and sends it a signal as soon as `now` is true, unless it ends
/// before. @param signal SIGKILL unless stated
[[nodiscard]] ToolRun kill_tool_process(const std::string& tool,
                                        const std::vector<std::string>& arguments,
                                        const std::function<bool()>& now,
                                        int signal = 9);

}  // namespace palpate

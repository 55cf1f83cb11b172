#include <cstdlib>

#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {

// By the command processor, which takes the outer pair of quotes away.
ToolRun run_tool_process(const std::string& tool,
                         const std::vector<std::string>& arguments) {
  const ScratchFolder scratch;
  const auto quoted = [](const std::filesystem::path& word) {
    return '"' + std::filesystem::path(word).make_preferred().string() + '"';
  };
  std::string command =
      '"' + quoted(std::filesystem::path(PALPATE_BIN_DIR) / (tool + ".exe"));
  for (const std::string& argument : arguments) {
    command += ' ' + quoted(argument);
  }
  command += " > " + quoted(scratch / "out") + " 2> " + quoted(scratch / "err") + '"';
  const int code = std::system(command.c_str());
  return {code, bytes_of(scratch / "out"), bytes_of(scratch / "err")};
}

}  // namespace palpate

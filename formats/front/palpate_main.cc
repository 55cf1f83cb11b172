// palpate: one program in front of the tools, which have licences of their own.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/command_line.h"
#include "formats/base/nearest_name.h"
#include "formats/front/verbs.h"

namespace palpate {
namespace {

[[noreturn]] void refuse(std::string_view name) {
  std::vector<std::string_view> names;
  for (const Verb& verb : kVerbs) {
    names.push_back(verb.name);
  }
  throw InputError(
      fmt::format("there is no verb {:?}; the nearest is {} (see palpate "
                  "--help)",
                  name.substr(0, 40), nearest_name(name, names)));
}

// Becomes the tool: one beside this program, else one of the PATH.
[[noreturn]] void become(const std::string& tool, std::vector<char*> arguments) {
  std::error_code none;
  const std::filesystem::path beside =
      std::filesystem::read_symlink("/proc/self/exe", none).parent_path() / tool;
  std::string name = std::filesystem::exists(beside, none) ? beside.string() : tool;
  arguments.front() = name.data();
  arguments.push_back(nullptr);
  execvp(name.c_str(), arguments.data());
  throw InputError(fmt::format("{} cannot be started: {}", name, std::strerror(errno)));
}

int run(int argc, char** argv) {
  const std::string_view first = argc > 1 ? argv[1] : "";
  if (first == "--man" || first == "--completion") {
    fmt::print("{}", first == "--man" ? front_man_page() : front_completion());
    return 0;
  }
  if (first == "--version") {
    fmt::print("{}\n", PALPATE_VERSION);
    return 0;
  }
  if (first.empty() || first == "--help" || first == "-h" || first == "help") {
    fmt::print("{}", front_help());
    return first.empty() ? 2 : 0;
  }
  const Verb* verb = find_verb(first);
  if (verb == nullptr) {
    refuse(first);
  }
  // What "palpate-precompute build .." and "palpate-fit curve .." begin with.
  std::vector<char*> arguments(argv, argv + argc);
  if (verb->command.empty()) {
    arguments.erase(arguments.begin());
  }
  become(
      std::string(tool_for(*verb, std::span<const char* const>(argv + 2, argv + argc))),
      std::move(arguments));
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  return palpate::run_reporting("palpate", [&] {
    return palpate::run(argc, argv);
  });
}

// Man page and shell completion of a command-line tool, from the same text as --help.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): another library's name
class App;
}  // namespace CLI

namespace palpate {

/// Section 1 page (troff) of a tool with its subcommands.
[[nodiscard]] std::string man_page(const CLI::App& app);

/// For bash, and for zsh by way of bashcompinit.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

}  // namespace palpate

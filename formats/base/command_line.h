// What every command-line tool does the same way: options, parsing, errors by kind.
//
// CLI11 parses; this header hides it, because its templates cost seconds in every
// source that includes them.
#pragma once

#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "formats/base/error.h"

namespace CLI {  // NOLINT(readability-identifier-naming): another library's name
class App;
class Option;
}  // namespace CLI

namespace palpate {

/// One option of a command, as add_option() returns it; it belongs to the command.
/// Every function returns the option itself, to be called in a row.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option& option) : option_(&option) {}

  CommandOption required();
  CommandOption show_default();            ///< its value now, in the help
  CommandOption separated_by(char comma);  ///< several values in one word
  CommandOption values(int count);
  CommandOption values_at_least(int count);
  CommandOption one_value_each();  ///< more values only by naming the option again

  CommandOption in_range(double least, double most);
  CommandOption in_range(int least, int most);
  CommandOption in_range(long least, long most);
  CommandOption in_range(unsigned least, unsigned most);
  CommandOption positive();
  CommandOption not_negative();
  CommandOption one_of(const std::vector<std::string>& words);

 private:
  CLI::Option* option_;
};

/// A tool, one of its subcommands, or a group of options. What options are bound to
/// must outlive the parsing.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  Command add_subcommand(const std::string& name, const std::string& description);
  /// Options of which exactly one must be given.
  Command add_choice(const std::string& name);
  void require_subcommand();

  /// @tparam Value a type that command_line.cc instantiates it for: numbers, strings,
  /// paths, their optionals and vectors.
  template <class Value>
  CommandOption add_option(const std::string& names, Value& value,
                           const std::string& description);
  CommandOption add_flag(const std::string& names, bool& value,
                         const std::string& description);
  [[nodiscard]] CommandOption option(const std::string& name);
  /// How often an option was given, while the callback runs.
  [[nodiscard]] std::size_t count(const std::string& name) const;
  void callback(std::function<void()> work);

 private:
  CLI::App* app_;
};

/// Adds one subcommand to a tool.
using AddCommand = void (*)(Command app);

/// Runs the work; a failure is one line on stderr, "palpate-db: error: ...". @return
/// its exit code (formats/base/error.h), or that of the work.
template <class Work>
int run_reporting(const char* name, Work&& work) {
  try {
    return work();
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: error: %s\n", name, error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error: %s\n", name, error.what());
    return 1;
  } catch (...) {
    std::fprintf(stderr, "%s: internal error\n", name);
    return 1;
  }
}

/// Parses the command line and runs the chosen subcommand. A failure is one line on
/// stderr, "palpate-db: error: ...", and its exit code (formats/base/error.h); a
/// command line that cannot be parsed exits with 2. Presets and old names: as
/// command_words(). "--man" or "--completion" alone
/// print what an installation keeps of the tool.
int run_tool(const char* name, const char* description,
             std::initializer_list<AddCommand> commands, int argc, char** argv);

}  // namespace palpate

#include "formats/base/command_line.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "formats/base/command_words.h"
#include "formats/base/man_page.h"

namespace palpate {
namespace {

// CLI11's own says the largest number that there is.
CLI::Validator number_that(const std::string& must_be, const std::string& name,
                           bool (*holds)(double)) {
  return {[must_be, holds](const std::string& text) {
            double value = 0.0;
            return CLI::detail::lexical_cast(text, value) && holds(value)
                       ? std::string()
                       : text + " must be " + must_be;
          },
          name};
}

constexpr int kAnyNumber = -1;

bool print_page(const CLI::App& app, int argc, char** argv) {
  const std::string_view wanted = argc == 2 ? argv[1] : "";
  if (wanted == "--man" || wanted == "--completion") {
    fmt::print("{}", wanted == "--man" ? man_page(app) : bash_completion(app));
    return true;
  }
  return false;
}

int parse_and_run(CLI::App& app, int argc, char** argv) {
  const CommandWords line =
      command_words(std::vector<std::string>(argv + 1, argv + argc));
  for (const std::string& note : line.note) {
    std::fprintf(stderr, "%s: note: %s\n", app.get_name().c_str(), note.c_str());
  }
  try {
    app.parse(std::vector<std::string>(line.word.rbegin(), line.word.rend()));
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      return app.exit(error);  // --help, --version
    }
    std::string tool = app.get_name();
    for (const CLI::App* command = &app; !command->get_subcommands().empty();) {
      command = command->get_subcommands().front();
      tool += " " + command->get_name();
    }
    throw InputError(fmt::format("{} (see {} --help)", error.what(), tool));
  }
}

}  // namespace

CommandOption CommandOption::required() {
  option_->required();
  return *this;
}

CommandOption CommandOption::show_default() {
  option_->capture_default_str();
  return *this;
}

CommandOption CommandOption::separated_by(char comma) {
  option_->delimiter(comma);
  return *this;
}

CommandOption CommandOption::values(int count) {
  option_->expected(count);
  return *this;
}

CommandOption CommandOption::values_at_least(int count) {
  option_->expected(count, kAnyNumber);
  return *this;
}

CommandOption CommandOption::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

CommandOption CommandOption::in_range(double least, double most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

CommandOption CommandOption::in_range(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

CommandOption CommandOption::in_range(long least, long most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

CommandOption CommandOption::in_range(unsigned least, unsigned most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

CommandOption CommandOption::positive() {
  option_->check(number_that("positive", "POSITIVE", [](double x) {
    return x > 0.0;
  }));
  return *this;
}

CommandOption CommandOption::not_negative() {
  option_->check(number_that("at least 0", "NONNEGATIVE", [](double x) {
    return x >= 0.0;
  }));
  return *this;
}

CommandOption CommandOption::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}

Command Command::add_subcommand(const std::string& name,
                                const std::string& description) {
  // For the help: command_words() takes it out before anything is parsed.
  static std::string presets;
  CLI::App& command = *app_->add_subcommand(name, description);
  command.add_option("--config", presets,
                     "File of options (TOML), \"name = value\" for --name; those given "
                     "here go before");
  return Command(command);
}

Command Command::add_choice(const std::string& name) {
  CLI::App* group = app_->add_option_group(name);
  group->require_option(1);
  return Command(*group);
}

void Command::require_subcommand() {
  app_->require_subcommand(1);
}

template <class Value>
CommandOption Command::add_option(const std::string& names, Value& value,
                                  const std::string& description) {
  return CommandOption(*app_->add_option(names, value, description));
}

CommandOption Command::add_flag(const std::string& names, bool& value,
                                const std::string& description) {
  return CommandOption(*app_->add_flag(names, value, description));
}

CommandOption Command::option(const std::string& name) {
  return CommandOption(*app_->get_option(name));
}

std::size_t Command::count(const std::string& name) const {
  return app_->count(name);
}

void Command::callback(std::function<void()> work) {
  app_->callback(std::move(work));
}

int run_tool(const char* name, const char* description,
             std::initializer_list<AddCommand> commands, int argc, char** argv) {
  return run_reporting(name, [&] {
    CLI::App app(description, name);
    app.set_version_flag("--version", PALPATE_VERSION);
    app.require_subcommand(1);
    for (const AddCommand add : commands) {
      add(Command(app));
    }
    if (print_page(app, argc, argv)) {
      return 0;
    }
    return parse_and_run(app, argc, argv);
  });
}

// clang-format off
#define PALPATE_OPTION_VALUE(...)                                    \
  template CommandOption Command::add_option<__VA_ARGS__>(           \
      const std::string&, __VA_ARGS__&, const std::string&);         \
  template CommandOption Command::add_option<std::vector<__VA_ARGS__>>( \
      const std::string&, std::vector<__VA_ARGS__>&, const std::string&)
// clang-format on
template CommandOption Command::add_option<std::filesystem::path>(
    const std::string&, std::filesystem::path&, const std::string&);
template CommandOption Command::add_option<std::optional<double>>(
    const std::string&, std::optional<double>&, const std::string&);
PALPATE_OPTION_VALUE(std::string);
PALPATE_OPTION_VALUE(unsigned short);
PALPATE_OPTION_VALUE(double);
PALPATE_OPTION_VALUE(int);
PALPATE_OPTION_VALUE(unsigned);
PALPATE_OPTION_VALUE(long);
PALPATE_OPTION_VALUE(unsigned long);
#undef PALPATE_OPTION_VALUE

}  // namespace palpate

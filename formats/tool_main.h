// What every command-line tool does the same way: parse, run, report errors by kind.
#pragma once

#include <cstdio>
#include <exception>
#include <initializer_list>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "formats/error.h"
#include "formats/hdf5_io.h"
#include "formats/tool_pages.h"

namespace palpate {

/// Adds one subcommand to a tool.
using AddCommand = void (*)(CLI::App&);

namespace internal {

/// "--man" or "--completion" alone: what an installation keeps of the tool.
inline bool print_page(const CLI::App& app, int argc, char** argv) {
  const std::string_view wanted = argc == 2 ? argv[1] : "";
  if (wanted == "--man" || wanted == "--completion") {
    fmt::print("{}", wanted == "--man" ? man_page(app) : bash_completion(app));
    return true;
  }
  return false;
}

inline int parse_and_run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      return app.exit(error);  // --help, --version
    }
    throw InputError(fmt::format("{} (see {} --help)", error.what(), app.get_name()));
  }
}

}  // namespace internal

/// Runs the work; a failure is one line on stderr, "palpate-db: error: ...". @return
/// its exit code (formats/error.h), or that of the work.
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
/// stderr, "palpate-db: error: ...", and its exit code (formats/error.h); a command
/// line that cannot be parsed exits with 2.
inline int run_tool(const char* name, const char* description,
                    std::initializer_list<AddCommand> commands, int argc, char** argv) {
  return run_reporting(name, [&] {
    skip_hdf5_exit_cleanup();
    CLI::App app(description, name);
    app.set_version_flag("--version", PALPATE_VERSION);
    app.require_subcommand(1);
    for (const AddCommand add : commands) {
      add(app);
    }
    if (internal::print_page(app, argc, argv)) {
      return 0;
    }
    return internal::parse_and_run(app, argc, argv);
  });
}

}  // namespace palpate

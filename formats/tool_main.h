// What every command-line tool does the same way: parse, run, report errors by kind.
#pragma once

#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "formats/error.h"
#include "formats/hdf5_io.h"

namespace palpate {

/// Parses the command line and runs the callbacks of the chosen subcommand. A failure
/// is one line on stderr, "palpate-db: error: ...", and its exit code
/// (formats/error.h); a command line that cannot be parsed exits with 2.
inline int run_tool(CLI::App& app, int argc, char** argv) {
  skip_hdf5_exit_cleanup();
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : InputError("").exit_code();
  } catch (const Error& error) {
    fmt::print(stderr, "{}: error: {}\n", app.get_name(), error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: internal error: {}\n", app.get_name(), error.what());
    return 1;
  }
}

}  // namespace palpate

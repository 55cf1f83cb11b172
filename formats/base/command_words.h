// The words of a command line as they are meant: presets from a file, old names of
// options.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// An option that has another name since; the old one answers for one version.
struct RenamedOption {
  std::string_view before;
  std::string_view now;
};

inline constexpr RenamedOption kRenamedOptions[] = {
    {"--workers", "--threads"},
    {"--patience", "--patience-s"},
    {"--frame-stiffness", "--frame-stiffness-n-per-m"},
    {"--frame-stiffness-sd", "--frame-stiffness-sd-n-per-m"},
    {"--stream-budget", "--stream-budget-mib"},
    {"--wander", "--wander-mm-per-s"},
};

/// Verbs of the four tools, as `--config` takes them for names of tables.
inline constexpr std::string_view kTablesOfOptions[] = {
    "batch",     "bench",   "body",     "build",  "calibrate", "check",    "curve",
    "device",    "devices", "diff",     "driver", "export",    "indent",   "info",
    "insertion", "lateral", "material", "merge",  "pairs",     "picture",  "plan",
    "probe",     "remesh",  "replay",   "report", "serve",     "simulate", "slice",
    "spheres",   "submit",  "surface",  "sweep",  "trade",     "view"};

/// Options that have a letter, too: the line's "-n 4" goes before a file's "sets".
struct LetteredOption {
  std::string_view name;
  char letter;
};

inline constexpr LetteredOption kLetteredOptions[] = {{"--output", 'o'},
                                                      {"--sets", 'n'}};

struct CommandWords {
  std::vector<std::string> word;  ///< after the program's name
  std::vector<std::string> note;  ///< what to say on stderr, one line each
};

/// Replaces old names of options, and --config FILE by the options that it holds. FILE
/// is TOML. The file's keys are long names without dashes. The keys are those of all
/// verbs, or stand in a table named as the verb, which goes before. A key with true
/// gives a flag, one with false leaves the flag out, an array gives several values.
/// What the line gives itself goes before the file.
/// @throws InputError naming the file, and the key that is no option's value.
/// InputError too for a table that is none of kTablesOfOptions.
[[nodiscard]] CommandWords command_words(std::span<const std::string> given);

}  // namespace palpate

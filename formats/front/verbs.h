// Which tool does what: palpate VERB.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

struct Verb {
  std::string_view name;
  std::string_view tool;  ///< "palpate-run"
  /// The tool's own name of the verb; empty where the rest of the line has it.
  std::string_view command;
  std::string_view group;  ///< heading in the help; empty: not listed
  std::string_view what;
};

inline constexpr std::array kVerbs = {
    Verb{"check", "palpate-precompute", "check", "Bodies",
         "does a surface mesh bound a body, is a database whole"},
    Verb{"remesh", "palpate-precompute", "remesh", "Bodies",
         "a surface anew, with triangles of even size"},
    Verb{"spheres", "palpate-precompute", "spheres", "Bodies",
         "spheres by which a tool's mesh touches"},
    Verb{"body", "palpate-precompute", "body", "Bodies", "a generated body's surface"},
    Verb{"plan", "palpate-precompute", "plan", "Responses",
         "what a build will compute, its time and memory"},
    Verb{"build", "palpate-precompute", "build", "Responses",
         "from a scene to a response database"},
    Verb{"serve", "palpate-precompute", "serve", "Responses",
         "the same where a hand needs it first"},
    Verb{"submit", "palpate-precompute", "submit", "Responses",
         "share a build out among machines"},
    Verb{"indent", "palpate-precompute", "indent", "Responses", "one node's response"},
    Verb{"trade", "palpate-precompute", "trade", "Responses",
         "error beside cost, for a scene"},
    Verb{"sweep", "palpate-precompute", "sweep", "Responses",
         "nodes for a grid of material parameters"},
    Verb{"pairs", "palpate-precompute", "pairs", "Responses",
         "how right coupled contacts are"},
    Verb{"fit", "palpate-fit", "", "Measurements",
         "curve, insertion, batch, surface, material: from lab data"},
    Verb{"db", "palpate-db", "", "Databases",
         "info, check, diff, slice, merge, export, report, picture"},
    Verb{"view", "palpate-run", "view", "Rendering", "press a database in a browser"},
    Verb{"simulate", "palpate-run", "simulate", "Rendering",
         "render with a simulated device and hand"},
    Verb{"device", "palpate-run", "device", "Rendering", "render on a haptic device"},
    Verb{"devices", "palpate-run", "devices", "Rendering", "devices that are attached"},
    Verb{"calibrate", "palpate-run", "calibrate", "Rendering",
         "a device's force by a suspended mass"},
    Verb{"probe", "palpate-run", "probe", "Rendering",
         "what a probe of a device found"},
    Verb{"replay", "palpate-run", "replay", "Rendering", "a recorded run again"},
    Verb{"bench", "palpate-run", "bench", "Rendering", "the fast step, measured"},
    Verb{"driver", "palpate-run", "driver", "",
         "a device at the other end of a socket"},
};

/// The verb of that name; none: null.
[[nodiscard]] const Verb* find_verb(std::string_view name);

/// The tool that `palpate VERB ARGUMENTS..` runs: of a file that is a database
/// `check` is palpate-db's.
[[nodiscard]] std::string_view tool_for(const Verb& verb,
                                        std::span<const char* const> arguments);

[[nodiscard]] std::string front_help();
[[nodiscard]] std::string front_man_page();
[[nodiscard]] std::string front_completion();

}  // namespace palpate

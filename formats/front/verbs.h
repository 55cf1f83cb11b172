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
         "says whether a surface mesh bounds a body; can repair the mesh"},
    Verb{"remesh", "palpate-precompute", "remesh", "Bodies",
         "writes a surface with triangles of even size"},
    Verb{"spheres", "palpate-precompute", "spheres", "Bodies",
         "finds spheres by which a tool's mesh touches"},
    Verb{"body", "palpate-precompute", "body", "Bodies",
         "writes the surface of a generated body"},
    Verb{"plan", "palpate-precompute", "plan", "Responses",
         "says what a build will compute, with its time and memory"},
    Verb{"build", "palpate-precompute", "build", "Responses",
         "computes a response database from a scene"},
    Verb{"serve", "palpate-precompute", "serve", "Responses",
         "computes the same where a hand needs it first"},
    Verb{"submit", "palpate-precompute", "submit", "Responses",
         "writes job scripts that share a build out among machines"},
    Verb{"indent", "palpate-precompute", "indent", "Responses",
         "prints the response of one node"},
    Verb{"trade", "palpate-precompute", "trade", "Responses",
         "tabulates error and cost of several meshes"},
    Verb{"sweep", "palpate-precompute", "sweep", "Responses",
         "presses nodes for a grid of material parameters"},
    Verb{"pairs", "palpate-precompute", "pairs", "Responses",
         "measures the error of coupled contacts"},
    Verb{"fit", "palpate-fit", "", "Measurements",
         "curve, insertion, lateral, batch, surface, material: from lab data"},
    Verb{"db", "palpate-db", "", "Databases",
         "info, check, diff, slice, merge, export, report, picture"},
    Verb{"view", "palpate-run", "view", "Rendering",
         "shows a database, or a scene, in a browser"},
    Verb{"simulate", "palpate-run", "simulate", "Rendering",
         "renders with a simulated device and hand"},
    Verb{"device", "palpate-run", "device", "Rendering", "renders on a haptic device"},
    Verb{"devices", "palpate-run", "devices", "Rendering",
         "lists the attached devices"},
    Verb{"calibrate", "palpate-run", "calibrate", "Rendering",
         "finds the force factor of a device by a known mass"},
    Verb{"probe", "palpate-run", "probe", "Rendering",
         "prints what a probe of a device found"},
    Verb{"replay", "palpate-run", "replay", "Rendering",
         "renders a recorded run again"},
    Verb{"bench", "palpate-run", "bench", "Rendering", "measures the fast step"},
    Verb{"driver", "palpate-run", "driver", "",
         "drives a device for a renderer behind a socket"},
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

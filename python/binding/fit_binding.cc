// Fits of presses and of sessions: what palpate-fit says, as objects.
#include "python/binding/bind.h"
#include "python/binding/held_database.h"
#include "python/binding/number_array.h"
#include "python/binding/option.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "fitting/curve/fitted_response.h"
#include "fitting/curve/time_effects.h"
#include "fitting/material/indenter_options.h"
#include "fitting/session/batch.h"
#include "fitting/session/press_fit.h"
#include "fitting/session/relaxation_json.h"
#include "fitting/session/surface_session.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace py = pybind11;

namespace palpate {
namespace {

struct HeldFit {
  Measurement samples;
  Indenter indenter;
  PressFit fit;
};

py::object loads(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

// The flags' own check names flags; here they are arguments: "--radius-m", radius_m.
Indenter indenter_from(const IndenterOptions& options) {
  try {
    return indenter_of(options);
  } catch (const InputError& error) {
    std::string text = error.what();
    for (std::size_t at = text.find("--"); at != std::string::npos;
         at = text.find("--", at)) {
      text.erase(at, 2);
      const std::size_t end = text.find_first_of(" :;,", at);
      std::replace(text.begin() + static_cast<std::ptrdiff_t>(at),
                   end == std::string::npos
                       ? text.end()
                       : text.begin() + static_cast<std::ptrdiff_t>(end),
                   '-', '_');
    }
    throw InputError(text);
  }
}

Indenter take_indenter(const py::dict& given) {
  IndenterOptions options;
  take_option(given, "tool", options.shape);
  take_option(given, "radius_m", options.radius_m);
  take_option(given, "half_angle_deg", options.half_angle_deg);
  take_option(given, "height_m", options.height_m);
  take_option(given, "thickness_m", options.thickness_m);
  take_option(given, "poissons_ratio", options.poissons_ratio);
  take_option(given, "radius_sd_m", options.radius_sd_m);
  take_option(given, "half_angle_sd_deg", options.half_angle_sd_deg);
  take_option(given, "height_sd_m", options.height_sd_m);
  take_option(given, "thickness_sd_m", options.thickness_sd_m);
  take_option(given, "poissons_ratio_sd", options.poissons_ratio_sd);
  refuse_rest(given, "fit");
  return indenter_from(options);
}

std::vector<double> column(const py::handle& values, const char* what) {
  const Doubles array = doubles(values, what);
  if (array.ndim() != 1) {
    throw InputError(
        fmt::format("{} has {} dimensions, must have one", what, array.ndim()));
  }
  std::vector<double> numbers(array.data(), array.data() + array.size());
  const auto wrong = std::find_if(numbers.begin(), numbers.end(), [](double number) {
    return !std::isfinite(number);
  });
  if (wrong != numbers.end()) {
    throw InputError(fmt::format("{}[{}] is {}, must be finite", what,
                                 wrong - numbers.begin(), *wrong));
  }
  return numbers;
}

// (depth, force, time or None)
Measurement samples_of(const py::sequence& curve, bool with_time = true) {
  Measurement samples;
  samples.depth_m = column(py::object(curve[0]), "depth_m");
  samples.force_n = column(py::object(curve[1]), "force_n");
  if (const py::object time = curve[2]; with_time && !time.is_none()) {
    samples.time_s = column(time, "time_s");
  }
  const std::size_t n = samples.depth_m.size();
  if (samples.force_n.size() != n ||
      (!samples.time_s.empty() && samples.time_s.size() != n)) {
    throw InputError(
        fmt::format("{} depths, {} forces and {} times, must be as many (times: or "
                    "none)",
                    n, samples.force_n.size(), samples.time_s.size()));
  }
  return samples;
}

// As the command reads a file: times that the fit does without may be wrong, and tell
// no relaxation then.
std::optional<Measurement> timed_samples(const py::sequence& curve, bool drift) {
  try {
    return samples_of(curve);
  } catch (const InputError&) {
    if (drift) {
      throw;
    }
    return std::nullopt;
  }
}

// frame_stiffness_n_per_m with its frame_stiffness_sd_n_per_m, or a run on a plate.
std::optional<FrameRun> take_frame(const py::dict& given, const py::object& run) {
  std::optional<double> stiffness, sd;
  take_option(given, "frame_stiffness_n_per_m", stiffness);
  take_option(given, "frame_stiffness_sd_n_per_m", sd);
  if (stiffness && !run.is_none()) {
    throw InputError("frame_stiffness_n_per_m and frame_run: tell one of them");
  }
  if (sd && !stiffness) {
    throw InputError("frame_stiffness_sd_n_per_m goes with frame_stiffness_n_per_m");
  }
  if (!run.is_none()) {
    return frame_of_run(samples_of(run));
  }
  if (!stiffness) {
    return std::nullopt;
  }
  FrameRun frame;
  frame.frame =
      linear_frame(*stiffness, sd.value_or(std::numeric_limits<double>::quiet_NaN()));
  return frame;
}

std::unique_ptr<HeldFit> fit(const py::sequence& curve, bool drift,
                             const py::object& frame_run, const py::kwargs& given) {
  auto held = std::make_unique<HeldFit>();
  const std::optional<Measurement> timed = timed_samples(curve, drift);
  held->samples = samples_of(curve, drift);
  PressFitOptions options;
  take_option(given, "from_m", options.range.from_m);
  take_option(given, "to_m", options.range.to_m);
  std::optional<std::pair<double, double>> baseline;
  take_option(given, "baseline_m", baseline);
  if (baseline) {
    options.baseline = FitRange{baseline->first, baseline->second};
  }
  options.frame = take_frame(given, frame_run);
  options.indenter = take_indenter(given);
  held->indenter = options.indenter;
  const py::gil_scoped_release released;
  held->fit = fit_press(held->samples, options);
  if (timed) {
    held->fit.relaxation = find_stepwise_relaxation(*timed, held->fit.approach);
  }
  return held;
}

py::array_t<double> fitted_force(const HeldFit& held, const py::handle& depths) {
  const Doubles depth = doubles(depths, "depth_m");
  py::array_t<double> result(
      std::vector<py::ssize_t>(depth.shape(), depth.shape() + depth.ndim()));
  const FamilyFit& best = best_of(held.fit);
  for (py::ssize_t i = 0; i < depth.size(); ++i) {
    result.mutable_data()[i] = family_point(best, std::max(0.0, depth.data()[i])).force;
  }
  return result;
}

std::shared_ptr<HeldDatabase> database(
    const HeldFit& held, const std::optional<std::filesystem::path>& source) {
  const std::optional<ToolShape> tool = rendered_tool(held.indenter);
  if (!tool) {
    throw InputError(fmt::format(
        "a database needs the tool that pressed, and {}: sphere, flat-punch or cone",
        held.indenter.shape == "plate" ? "a plate on a cylinder is not rendered"
                                       : "none is given"));
  }
  return std::make_shared<HeldDatabase>(
      HeldDatabase{sample_patch(best_of(held.fit), held.samples, *tool,
                                source.value_or(std::filesystem::path()))});
}

Session session_of(const std::filesystem::path& file, const std::string& cycle) {
  Session session = read_session(file);
  if (!cycle.empty()) {
    session.fit.cycle = parse_cycle(cycle);
  }
  return session;
}

py::tuple fit_surface_of(const std::filesystem::path& file, const std::string& cycle) {
  std::shared_ptr<HeldDatabase> held;
  std::string report;
  {
    const py::gil_scoped_release released;
    std::vector<std::string> notes;
    SurfaceFit fit = fit_session_surface(session_of(file, cycle), notes);
    report = json_text(to_json(fit.report, notes));
    held = std::make_shared<HeldDatabase>(HeldDatabase{std::move(fit.database)});
  }
  return py::make_tuple(held, loads(report));
}

py::object fit_all(const std::filesystem::path& file, const std::string& cycle,
                   unsigned threads, const py::object& progress) {
  std::string report;
  {
    const py::gil_scoped_release released;
    const Session session = session_of(file, cycle);
    const auto tell = [&](std::size_t done) {
      const py::gil_scoped_acquire acquired;
      if (PyErr_CheckSignals() != 0) {  // in the main thread, which fits too
        throw py::error_already_set();
      }
      if (!progress.is_none()) {
        progress(done, session.run.size());
      }
    };
    report = batch_json(session, fit_session(session, threads, tell));
  }
  return loads(report);
}

void bind_press(py::module_& module) {
  py::class_<HeldFit> type(
      module, "Fit", "One press: contact point, law, modulus, what was taken off.");
  type.def(
      "to_dict",
      [](const HeldFit& held) {
        return loads(json_text(to_json(held.fit, held.indenter)));
      },
      "What `palpate-fit curve --json` says of the press; None: not known.");
  type.def_property_readonly(
      "relaxation",
      [](const HeldFit& held) -> py::object {
        return held.fit.relaxation
                   ? loads(json_text(relaxation_json(*held.fit.relaxation)))
                   : py::none();
      },
      "to_dict()['relaxation'] of a press with times and two holds or more, else None. "
      "Its\n'press_and_hold' is one law over all ramps and holds: terms g [-], tau_s "
      "[s] and\ng_inf [-] with their standard deviations, or 'refused', which says why "
      "not.");
  type.def_property_readonly("family", [](const HeldFit& held) {
    return best_of(held.fit).family;
  });
  type.def_property_readonly(
      "contact_point_m",
      [](const HeldFit& held) {
        return held.fit.contact.contact.m;
      },
      "[m] displacement at which contact begins");
  type.def_property_readonly(
      "youngs_modulus_pa",
      [](const HeldFit& held) {
        return held.fit.modulus.youngs_modulus_pa;
      },
      "[Pa], NaN where to_dict()['youngs_modulus_refused'] says why");
  type.def(
      "force", &fitted_force, py::arg("depth_m"),
      "Force [N] of the family that follows best, at depths [m] of any shape beyond "
      "the\ncontact point.");
  type.def("database", &database, py::arg("source") = py::none(),
           "A Database of a flat sample with this response; source: the file that was "
           "measured.");
}

}  // namespace

void bind_fit(py::module_& module) {
  bind_press(module);
  module.def("_fit", &fit, py::arg("curve"), py::arg("drift"), py::arg("frame_run"));
  module.def("_fit_surface", &fit_surface_of, py::arg("session"), py::arg("cycle"));
  module.def(
      "fit_session", &fit_all, py::arg("session"), py::kw_only(), py::arg("cycle") = "",
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "All presses of a session file (TOML, fitting/session/SESSION.md), a dict: "
      "what\n`palpate-fit batch` writes as results.json. A bad file is listed, "
      "not fatal.\nprogress(done, files): called from any thread; what it raises "
      "ends the work, as Ctrl-C does.");
}

}  // namespace palpate

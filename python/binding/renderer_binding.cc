// Passive rendering for loops that are written in Python.
#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"
#include "python/binding/number_array.h"
#include "python/binding/option.h"
#include "python/binding/scene_option.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace palpate {
namespace {

py::array_t<double> vector_array(const Eigen::Vector3d& vector) {
  return py::array_t<double>(py::ssize_t{3}, vector.data());
}

// The three numbers of an array that holds them as they are, else of anything.
Eigen::Vector3d triple_of(const py::handle& values, const char* what) {
  if (py::isinstance<py::array_t<double, py::array::c_style>>(values)) {
    const auto array = py::reinterpret_borrow<py::array>(values);
    if (array.ndim() == 1 && array.shape(0) == 3) {
      return Eigen::Map<const Eigen::Vector3d>(
          static_cast<const double*>(array.data()));
    }
  }
  Eigen::Vector3d triple;
  take_row(values, what, 3, triple.data());
  return triple;
}

// Rows of `width` numbers, one for each hand: of one hand (width,), of two (2, width).
template <int kWidth, typename Take>
void for_hands(const py::handle& values, const char* what, std::size_t hands,
               Take take) {
  using Row = Eigen::Matrix<double, kWidth, 1>;
  if (hands == 1) {
    Row row;
    if constexpr (kWidth == 3) {
      row = triple_of(values, what);
    } else {
      take_row(values, what, kWidth, row.data());
    }
    take(std::size_t{0}, row);
    return;
  }
  const py::sequence rows = py::reinterpret_borrow<py::sequence>(values);
  if (!py::isinstance<py::sequence>(values) && !py::isinstance<py::array>(values)) {
    throw InputError(fmt::format("{} must be an array of {} rows", what, hands));
  }
  if (py::len(rows) != hands) {
    throw InputError(fmt::format("{} has {} rows, must have one for each of {} hands",
                                 what, py::len(rows), hands));
  }
  for (std::size_t hand = 0; hand < hands; ++hand) {
    Row row;
    const py::object values_of_hand = rows[hand];
    take_row(values_of_hand, what, kWidth, row.data());
    take(hand, row);
  }
}

// One tick. @param orientation None: none.
const HostTick& tick_of(HeldRenderer& renderer, const py::handle& position,
                        const py::handle& orientation, double dt_s, bool torque_felt) {
  std::array<HostSample, kPortsMax> samples;
  for (HostSample& sample : samples) {
    sample.dt_s = dt_s;
    sample.torque_felt = torque_felt;
  }
  const std::size_t hands = renderer.hands();
  for_hands<3>(position, "position", hands,
               [&](std::size_t hand, const Eigen::Vector3d& row) {
                 samples[hand].position_m = row;
               });
  if (!orientation.is_none()) {
    for_hands<4>(orientation, "orientation", hands,
                 [&](std::size_t hand, const Eigen::Vector4d& row) {
                   samples[hand].quaternion = row;
                 });
  }
  return renderer.step(std::span(samples).first(hands));
}

// (3,) of one hand, (2, 3) of two.
py::array_t<double> of_hands(const HeldRenderer& renderer, const PortWrenches& wrench,
                             Vector3 Wrench::*member) {
  if (renderer.hands() == 1) {
    return vector_array(wrench[0].*member);
  }
  py::array_t<double> rows({py::ssize_t{2}, py::ssize_t{3}});
  for (py::ssize_t hand = 0; hand < 2; ++hand) {
    Eigen::Map<Eigen::Vector3d>(rows.mutable_data(hand, 0)) =
        wrench[static_cast<std::size_t>(hand)].*member;
  }
  return rows;
}

py::array_t<double> force_after(HeldRenderer& renderer, const py::handle& position,
                                double dt_s, const py::handle& orientation) {
  const HostTick& tick = tick_of(renderer, position, orientation, dt_s, false);
  return of_hands(renderer, tick.command.wrench, &Wrench::force_n);
}

void tell_delivered(HeldRenderer& renderer, const py::handle& force,
                    const py::handle& torque) {
  PortWrenches made = renderer.wanted();
  for_hands<3>(force, "force", renderer.hands(),
               [&](std::size_t hand, const Eigen::Vector3d& row) {
                 made[hand].force_n = row;
               });
  if (!torque.is_none()) {
    for_hands<3>(torque, "torque", renderer.hands(),
                 [&](std::size_t hand, const Eigen::Vector3d& row) {
                   made[hand].torque_n_m = row;
                 });
  }
  renderer.delivered(made);
}

py::tuple wrench_after(HeldRenderer& renderer, const py::handle& position,
                       const py::handle& orientation, double dt_s) {
  const HostTick& tick = tick_of(renderer, position, orientation, dt_s, true);
  return py::make_tuple(of_hands(renderer, tick.command.wrench, &Wrench::force_n),
                        of_hands(renderer, tick.command.wrench, &Wrench::torque_n_m));
}

void place_body(HeldRenderer& renderer, const py::handle& position,
                const py::handle& orientation) {
  Eigen::Vector4d turn(0.0, 0.0, 0.0, 1.0);
  if (!orientation.is_none()) {
    take_row(orientation, "orientation", 4, turn.data());
  }
  renderer.place(triple_of(position, "position"), turn);
}

// None of the options has a meaning of its own here: those of the C interface.
template <typename Source>
std::unique_ptr<HeldRenderer> make_renderer(const Source& source,
                                            const std::string& tool,
                                            const std::string& model,
                                            const py::kwargs& given) {
  HostOptions options;
  options.tool = tool;
  options.model = passive_model(model);
  take_option(given, "tick_s", options.tick_s);
  take_option(given, "slow_hz", options.slow_hz);
  take_option(given, "force_max_n", options.force_max_n);
  take_option(given, "stall_s", options.stall_s);
  take_option(given, "ramp_s", options.ramp_s);
  take_option(given, "position_gain", options.position_gain);
  take_option(given, "force_gain", options.force_gain);
  take_option(given, "damping_n_s_per_m", options.damping_n_s_per_m);
  take_option(given, "angular_damping_n_m_s", options.angular_damping_n_m_s);
  take_option(given, "delay_s", options.delay_s);
  take_option(given, "limit_stiffness", options.limit_stiffness);
  take_option(given, "streamed", options.streamed);
  if constexpr (std::is_same_v<Source, std::filesystem::path>) {
    take_scene(source, given, options);
  }
  std::string second;
  const bool two_hands =
      given.contains("second_tool") && !given["second_tool"].is_none();
  take_option(given, "second_tool", second);
  refuse_rest(given, "Renderer");
  const py::gil_scoped_release released;  // a scene's service may take its time
  return std::make_unique<HeldRenderer>(
      source, std::move(options), two_hands ? std::optional(second) : std::nullopt);
}

using Type = py::class_<HeldRenderer>;

// What Python sees of a number of the latest tick.
template <typename T>
auto as_python(const T& value) {
  if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
    return vector_array(value);
  } else {
    return value;
  }
}

// A member of the latest tick, or of one of its parts.
template <typename T>
void tell(Type& type, const char* name, T HostTick::*member, const char* text) {
  type.def_property_readonly(
      name,
      [member](const HeldRenderer& renderer) {
        return as_python(renderer.latest().*member);
      },
      text);
}

template <typename Part, typename Base, typename T>
void tell(Type& type, const char* name, Part HostTick::*part, T Base::*member,
          const char* text) {
  type.def_property_readonly(
      name,
      [part, member](const HeldRenderer& renderer) {
        return as_python(renderer.latest().*part.*member);
      },
      text);
}

void tell_wrench(Type& type, const char* name, Vector3 Wrench::*member,
                 const char* text) {
  type.def_property_readonly(
      name,
      [member](const HeldRenderer& renderer) {
        return of_hands(renderer, renderer.latest().command.wrench, member);
      },
      text);
}

void bind_account(Type& type) {
  tell(type, "work_j", &HostTick::work_j,
       "[J] put in by the tool since the start = stored + tank + dissipated + memory");
  tell(type, "stored_j", &HostTick::command, &TickAccount::stored_j,
       "[J] in the local model");
  tell(type, "tank_j", &HostTick::command, &TickAccount::tank_j,
       "[J] >= 0 that changes of the model freed");
  tell(type, "dissipated_j", &HostTick::command, &TickAccount::dissipated_j,
       "[J] >= 0 by friction, relaxing and discarded surplus");
  tell(type, "memory_j", &HostTick::command, &TickAccount::memory_j,
       "[J] >= 0 in dents that have not recovered");
  tell(type, "yielded_j", &HostTick::command, &TickAccount::yielded_j,
       "[J] >= 0 dissipated by dents that stay and by softening");
}

void bind_place(Type& type) {
  tell_wrench(type, "force", &Wrench::force_n,
              "(3,) [N] on the tool; of two hands (2, 3), so torque");
  tell_wrench(type, "torque", &Wrench::torque_n_m,
              "(3,) [N m] about the reference point; 0 of a tool of one contact");
  tell(type, "contact_point", &HostTick::contact, &FastContact::point_m,
       "(3,) [m] on the surface at rest");
  tell(type, "normal", &HostTick::contact, &FastContact::normal,
       "(3,) [-] there, outward; 0: no element yet");
  tell(type, "depth_m", &HostTick::command, &TickAccount::depth_m, "[m] penetration");
  tell(type, "dent_m", &HostTick::command, &TickAccount::dent_m,
       "[m] >= 0 that stays under the tool");
  tell(type, "tilt_rad", &HostTick::tilt_rad,
       "[rad] between the tool's orientation and that of the responses");
  tell(type, "triangle", &HostTick::contact, &FastContact::triangle,
       "of the database, in use; -1: none");
}

void bind_state(Type& type) {
  tell(type, "in_contact", &HostTick::command, &TickAccount::in_contact, "");
  tell(type, "contacts", &HostTick::command, &WrenchCommand::contacts,
       "that carry something, of a tool of several");
  tell(type, "coupling_scaled", &HostTick::command, &WrenchCommand::scaled,
       "whether some contacts lie too close to be coupled as they are");
  tell(type, "starved", &HostTick::command, &TickAccount::starved,
       "whether the element under the tool had not arrived");
  tell(type, "extrapolated", &HostTick::command, &TickAccount::extrapolated,
       "whether the tool is deeper than the response was computed");
  type.def_property_readonly(
      "fault",
      [](const HeldRenderer& renderer) {
        const HostTick& t = renderer.latest();
        return std::string(palpate::name(static_cast<Fault>(t.command.fault)));
      },
      "'none', 'not-finite', 'time-step', 'energy' or 'slow-stalled'");
  tell(type, "relaxed_n", &HostTick::command, &TickAccount::carried_n,
       "[N] >= 0 what has relaxed of the normal force");
  tell(type, "rest_offset_m", &HostTick::command, &TickAccount::rest_offset_m,
       "[m] >= 0 that the energy account had to take");
  tell(type, "ticks", &HostTick::ticks, "since the start or reset()");
}

void bind_body(Type& type) {
  type.def_property_readonly(
      "force_scale",
      [](const HeldRenderer& r) {
        return r.force_scale();
      },
      "[-] (0, 1], below 1 by limit_stiffness");
  type.def_property_readonly(
      "needed_damping_n_s_per_m",
      [](const HeldRenderer& r) {
        return r.body().needed_damping_n_s_per_m();
      },
      "viscous damping that the device must have at least");
  type.def_property_readonly("running", &HeldRenderer::runs,
                             "whether the slow thread runs");
}

void bind_slow(Type& type) {
  using Released = py::call_guard<py::gil_scoped_release>;
  type.def(
      "slow_step", &HeldRenderer::slow_step, Released(),
      "One turn of the slow process, about 100 times a second.\n\nReturns how many "
      "elements it sent. InputError while the thread runs; FormatError: a\n"
      "damaged file.");
  type.def("start", &HeldRenderer::start, "Starts the slow process in a thread.");
  type.def("stop", &HeldRenderer::stop, Released(), "Ends the thread.");
  type.def("__enter__", [](const py::object& self) {
    self.attr("start")();
    return self;
  });
  type.def("__exit__", [](HeldRenderer& renderer, const py::args& /*why*/) {
    const py::gil_scoped_release released;
    renderer.stop();
  });
}

constexpr const char* kStep =
    "Force (3,) [N] on the tool after dt [s] at position (3,) [m] of its reference "
    "point;\ndt 0: the nominal tick.\n\nThe tick of the C interface: passive, whatever "
    "the tool does and when elements come.\nAn orientation, as of wrench(), turns a "
    "tool "
    "of several contacts at no gain for the hand,\nwhich feels no torque. "
    "RenderingFault: the force is zero until "
    "reset(). InputError: not three numbers.";

constexpr const char* kWrench =
    "Force (3,) [N] and torque (3,) [N m] about the reference point, of a tool that "
    "touches\nat several places and turns. orientation (4,): quaternion x, y, z, w of "
    "any length; None: none.\nThe hand must feel the torque: a device that cannot give "
    "it calls step().";

constexpr const char* kDelivered =
    "What the device made of the latest force (3,) [N] and torque (3,) [N m], where "
    "that "
    "is not\nwhat was asked for: the account is then of what was felt. None: as it was "
    "asked for.\nInputError: not three finite numbers.";

constexpr const char* kMake =
    "Renders a Database, the file of one, or a scene (SCENE.toml) while it is "
    "computed. "
    "Options: model ('potential', 'facets', "
    "'element',\n'energy-tank', 'equal-energy'), tick_s [s] 0.001, slow_hz 100 of the "
    "thread, force_max_n [N] 8, stall_s [s] 0.5,\nramp_s [s] 0.1, position_gain, "
    "force_gain, "
    "and of a device damping_n_s_per_m, angular_damping_n_m_s,\ndelay_s, "
    "limit_stiffness; of a file streamed; of a scene "
    "output, the database that it becomes,\nand estimate, answers of a half space "
    "before any other. Meanings: palpate_options in palpate.h.\n"
    "second_tool: of a second hand that presses the body together with the first ('': "
    "the same tool);\npositions, orientations, forces and torques then have two rows.";

}  // namespace

void bind_renderer(py::module_& module) {
  Type type(module, "Renderer",
            "Position in, force out, at the haptic rate.\n\nWithout start() (or 'with "
            "Renderer(db) as r:') the caller calls slow_step() about 100 times\na "
            "second. One thread steps at a time.");
  type.def(py::init(&make_renderer<std::shared_ptr<HeldDatabase>>), py::arg("database"),
           py::arg("tool") = "", py::arg("model") = "potential", kMake);
  type.def(py::init(&make_renderer<std::filesystem::path>), py::arg("database"),
           py::arg("tool") = "", py::arg("model") = "potential", kMake);
  type.def("step", &force_after, py::arg("position"), py::arg("dt") = 0.0,
           py::arg("orientation") = py::none(), kStep);
  type.def("wrench", &wrench_after, py::arg("position"), py::arg("orientation"),
           py::arg("dt") = 0.0, kWrench);
  type.def("place", &place_body, py::arg("position"),
           py::arg("orientation") = py::none(),
           "Says how the body stands in the caller's world: its frame's origin [m] and "
           "orientation (x y z w).\nPoses, forces, torques, contact points and normals "
           "are the world's from then on.");
  type.def("delivered", &tell_delivered, py::arg("force"),
           py::arg("torque") = py::none(), kDelivered);
  type.def(
      "reset", &HeldRenderer::reset,
      "Clears a fault, the account and the tool's place, as after a jump. Dents stay.");
  type.def("save_surface", &HeldRenderer::save_surface, py::arg("file"),
           "Writes what the body keeps of the presses for good: dents, softening. Of a "
           "renderer\nof a file, while no thread runs.");
  type.def("load_surface", &HeldRenderer::load_surface, py::arg("file") = py::none(),
           "reset(), on a body that has yielded as the file says; without: a fresh "
           "one.\nInputError: of another body; nothing changes then.");
  bind_slow(type);
  bind_account(type);
  bind_place(type);
  bind_drawing(type);
  bind_needle(type);
  bind_service(type);
  bind_state(type);
  bind_body(type);
}

}  // namespace palpate

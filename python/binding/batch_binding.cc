// Many renderers stepped at once, on many threads.
#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"
#include "python/binding/number_array.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "formats/base/error.h"
#include "formats/base/on_threads.h"

namespace py = pybind11;

namespace palpate {
namespace {

// What one call of step_many() does to each renderer.
struct Ticks {
  py::ssize_t count = 0;
  double dt_s = 0.0;
  std::uint64_t slow_every = 0;
};

// The renderers of one call: nobody else steps them meanwhile.
class Stepped {
 public:
  explicit Stepped(std::vector<HeldRenderer*> renderers) {
    for (HeldRenderer* renderer : renderers) {
      try {
        renderer->begin_steps();
      } catch (...) {
        end();
        throw;
      }
      renderer_.push_back(renderer);
    }
  }
  ~Stepped() { end(); }
  Stepped(const Stepped&) = delete;
  Stepped& operator=(const Stepped&) = delete;

 private:
  void end() noexcept {
    for (HeldRenderer* renderer : renderer_) {
      renderer->end_steps();
    }
  }

  std::vector<HeldRenderer*> renderer_;
};

// @returns why the renderer faulted, empty: it did not. Forces from there on stay 0.
std::string run_ticks(HeldRenderer& renderer, const Ticks& ticks,
                      const double* position_m, double* force_n) {
  std::fill_n(force_n, 3 * ticks.count, 0.0);
  HostSample sample;
  sample.dt_s = ticks.dt_s;
  sample.torque_felt = false;
  try {
    for (py::ssize_t k = 0; k < ticks.count; ++k) {
      sample.position_m = Eigen::Map<const Eigen::Vector3d>(position_m + 3 * k);
      const HostTick& tick = renderer.tick(std::span(&sample, 1));
      Eigen::Map<Eigen::Vector3d>(force_n + 3 * k) = tick.command.wrench[0].force_n;
      if (ticks.slow_every > 0 && tick.ticks % ticks.slow_every == 0) {
        renderer.slow_step();
      }
    }
  } catch (const RenderingFault& fault) {
    return fault.what();
  }
  return {};
}

std::vector<HeldRenderer*> renderers_of(const py::tuple& given, bool slow_steps) {
  std::vector<HeldRenderer*> renderers;
  for (const py::handle& each : given) {
    if (!py::isinstance<HeldRenderer>(each)) {
      throw InputError("renderers must be a Renderer or a sequence of them");
    }
    auto* renderer = py::cast<HeldRenderer*>(each);
    const std::size_t number = renderers.size();
    if (renderer->hands() != 1) {
      throw InputError(fmt::format("renderer {} has two hands, must have one", number));
    }
    if (slow_steps && renderer->runs()) {
      throw InputError(fmt::format(
          "renderer {}: the slow thread runs, so slow_every must be 0", number));
    }
    renderers.push_back(renderer);
  }
  if (std::set(renderers.begin(), renderers.end()).size() != renderers.size()) {
    throw InputError("a renderer is there twice, must be there once");
  }
  return renderers;
}

// (n, 3) or (n, k, 3) of n renderers; of a Renderer alone (3,) or (k, 3).
py::ssize_t ticks_each(const Doubles& positions, std::size_t count, bool alone) {
  const py::ssize_t dimensions = positions.ndim() + (alone ? 1 : 0);
  const auto rows = static_cast<py::ssize_t>(count);
  const bool last = positions.ndim() > 0 && positions.shape(positions.ndim() - 1) == 3;
  const bool fits = last && (dimensions == 2 || dimensions == 3) &&
                    (alone || positions.shape(0) == rows);
  if (!fits) {
    throw InputError(fmt::format(
        "positions have {} dimensions and {} numbers, must have shape {}",
        positions.ndim(), positions.size(),
        alone ? "(3,) or (k, 3)" : fmt::format("({0}, 3) or ({0}, k, 3)", count)));
  }
  return dimensions == 2 ? 1 : positions.shape(positions.ndim() - 2);
}

py::object step_many(const py::object& given, const py::object& values, double dt_s,
                     std::uint64_t slow_every, unsigned threads,
                     const py::object& out) {
  const bool alone = py::isinstance<HeldRenderer>(given);
  const auto kept =
      alone ? py::make_tuple(given) : py::tuple(given);  // while they step
  const std::vector<HeldRenderer*> renderers = renderers_of(kept, slow_every > 0);
  Doubles positions = doubles(values, "positions");
  const Ticks ticks{ticks_each(positions, renderers.size(), alone), dt_s, slow_every};
  const Buffer forces = buffer_like(out, positions);
  std::vector<std::string> fault(renderers.size());
  {
    const Stepped stepped(renderers);
    const py::gil_scoped_release released;
    on_threads(threads, renderers.size(), [&](std::size_t i) {
      const auto begin = 3 * ticks.count * static_cast<py::ssize_t>(i);
      fault[i] = run_ticks(*renderers[i], ticks, positions.data() + begin,
                           forces.data + begin);
    });
  }
  const auto first = std::find_if(fault.begin(), fault.end(), [](const auto& why) {
    return !why.empty();
  });
  if (first != fault.end()) {
    const auto faulted = std::count_if(first, fault.end(), [](const auto& why) {
      return !why.empty();
    });
    throw RenderingFault(
        fmt::format("{} of {} renderers, the first of them renderer {}: {}", faulted,
                    fault.size(), first - fault.begin(), *first));
  }
  return forces.given;
}

}  // namespace

void bind_batch(py::module_& module) {
  // For tests of whose memory is read.
  module.def("_numbers", [](const py::object& values) {
    return doubles(values, "numbers");
  });
  module.def(
      "step_many", &step_many, py::arg("renderers"), py::arg("positions"),
      py::arg("dt") = 0.0, py::kw_only(), py::arg("slow_every") = 0,
      py::arg("threads") = 0, py::arg("out") = py::none(),
      "Forces (n, 3) [N] of n renderers, each after a tick of dt [s] at its row of "
      "positions (n, 3) [m];\nor (n, k, 3), k ticks each in turn; or of one Renderer "
      "(k, 3). The forces are those of step(), one\nafter the other, bit for bit, on "
      "`threads` threads (0: all processors) without Python's lock.\nslow_every: "
      "slow_step() after each tick whose number is a multiple of it; 0: never. out: a "
      "buffer\nthat gets the forces.\nRenderingFault: some renderer's force is zero "
      "from its fault on; all "
      "others have made their ticks.");
}

}  // namespace palpate

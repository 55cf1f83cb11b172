// What a Python program reads of a needle: where it is, and what it has cut open.
#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <pybind11/numpy.h>

namespace py = pybind11;

namespace palpate {
namespace {

NeedleSeen needle_in(const HeldRenderer& renderer) {
  const NeedleSeen seen = renderer.needle();
  if (!seen.punctures) {
    throw InputError(kNoNeedle);
  }
  return seen;
}

py::dict needle_of(const HeldRenderer& renderer) {
  const NeedleSeen seen = needle_in(renderer);
  py::dict all;
  all["channel"] =
      seen.state.active < 0 ? py::object(py::none()) : py::int_(seen.state.active);
  all["broken"] = seen.state.broken;
  all["refused"] = seen.state.refused;
  all["tip_m"] = seen.tip_m;
  all["inserted_m"] = seen.inserted_m;
  all["tip_n"] = seen.tip_n;
  all["shaft_n"] = seen.shaft_n;
  all["lateral_n"] = py::array_t<double>(3, seen.lateral_n.data());
  all["cut_j"] = seen.state.crack_j;
  all["released_j"] = seen.state.released_j;
  all["shaft_j"] = seen.state.shaft_j;
  return all;
}

py::dict channels_of(const HeldRenderer& renderer) {
  const py::ssize_t count = needle_in(renderer).state.channels;
  py::array_t<double> entry_m({count, py::ssize_t{3}}), axis({count, py::ssize_t{3}});
  py::array_t<double> depth_m(count), boundary_m(count);
  py::array_t<std::int32_t> layer(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const Channel channel = renderer.channel_at(static_cast<std::int32_t>(i));
    Eigen::Map<Eigen::Vector3d>(entry_m.mutable_data(i, 0)) = channel.entry_m;
    Eigen::Map<Eigen::Vector3d>(axis.mutable_data(i, 0)) = channel.axis;
    depth_m.mutable_at(i) = channel.depth_m;
    boundary_m.mutable_at(i) = palpate::boundary_m(channel);
    layer.mutable_at(i) = channel.layer;
  }
  py::dict all;
  all["entry_m"] = entry_m;
  all["axis"] = axis;
  all["depth_m"] = depth_m;
  all["boundary_m"] = boundary_m;
  all["layer"] = layer;
  return all;
}

}  // namespace

void bind_needle(py::class_<HeldRenderer>& type) {
  type.def("needle", &needle_of,
           "Of a tool that punctures, at the latest tick: channel (a row of "
           "channel_table(); None: in none), broken\nmembranes, refused ticks, tip_m "
           "along the axis, inserted_m, parts of the force before limits (tip_n and "
           "shaft_n\noutward, lateral_n across), works cut_j, released_j, shaft_j. "
           "InputError: no needle.");
  type.def("channel_table", &channels_of,
           "What the needle has cut open, as arrays of k rows: entry_m, axis, depth_m, "
           "boundary_m (of the next\nmembrane; inf: none), layer. Points and axes are "
           "the world's (place()). InputError: no needle.");
}

}  // namespace palpate

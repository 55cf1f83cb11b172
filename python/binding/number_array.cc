#include "python/binding/number_array.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace py = pybind11;

namespace palpate {
namespace {

// DLDeviceType: memory that the processor reads; CUDA's and ROCm's pinned.
constexpr std::array kHostMemory{1, 3, 11};

// numpy's view of another library's array.
py::array exported(const py::handle& values, const char* what) {
  try {
    const auto device = py::cast<py::tuple>(values.attr("__dlpack_device__")());
    const auto kind = py::cast<int>(device[0]);
    if (std::find(kHostMemory.begin(), kHostMemory.end(), kind) == kHostMemory.end()) {
      throw InputError(fmt::format(
          "{} lie on a device (DLPack type {}), must be moved to the CPU first", what,
          kind));
    }
    return py::module_::import("numpy").attr("from_dlpack")(values);
  } catch (const py::error_already_set& error) {
    throw InputError(fmt::format("{} are not given by __dlpack__(): {}", what,
                                 std::string(py::str(error.value()))));
  } catch (const py::cast_error&) {
    throw InputError(
        fmt::format("{}: __dlpack_device__() must give two integers", what));
  }
}

bool is_exported(const py::handle& values) {
  return !py::isinstance<py::array>(values) && py::hasattr(values, "__dlpack__") &&
         py::hasattr(values, "__dlpack_device__");
}

std::string shape_text(const py::ssize_t* shape, py::ssize_t dimensions) {
  std::string text;
  for (py::ssize_t i = 0; i < dimensions; ++i) {
    text += fmt::format("{}{}", i > 0 ? ", " : "", shape[i]);
  }
  return fmt::format("({}{})", text, dimensions == 1 ? "," : "");
}

}  // namespace

Doubles doubles(const py::handle& values, const char* what) {
  const py::array array =
      is_exported(values) ? exported(values, what) : py::array::ensure(values);
  if (!array || std::string("fiu").find(array.dtype().kind()) == std::string::npos) {
    PyErr_Clear();
    throw InputError(fmt::format("{} are not numbers, must be an array of them", what));
  }
  return Doubles(array);
}

void take_row(const py::handle& values, const char* what, py::ssize_t count,
              double* into) {
  const Doubles array = doubles(values, what);
  if (array.ndim() != 1 || array.shape(0) != count) {
    throw InputError(
        fmt::format("{} has {} dimensions and {} numbers, must have shape ({},)", what,
                    array.ndim(), array.size(), count));
  }
  std::copy_n(array.data(), count, into);
}

Buffer buffer_for(const py::object& out, const std::vector<py::ssize_t>& shape) {
  if (out.is_none()) {
    py::array_t<double> made(shape);
    double* data = made.mutable_data();
    return {made, made, data};
  }
  const bool foreign = is_exported(out);
  if (!foreign && !py::isinstance<py::array>(out)) {
    throw InputError("out must be an array of numpy, or of a library with __dlpack__");
  }
  const py::array view = foreign ? exported(out, "out") : py::array(out);
  const bool fits = view.ndim() == static_cast<py::ssize_t>(shape.size()) &&
                    std::equal(shape.begin(), shape.end(), view.shape()) &&
                    py::isinstance<py::array_t<double, py::array::c_style>>(view);
  if (!fits) {
    throw InputError(fmt::format(
        "out has shape {} and type {}, must be {}, float64 and contiguous",
        shape_text(view.shape(), view.ndim()), std::string(py::str(view.dtype())),
        shape_text(shape.data(), static_cast<py::ssize_t>(shape.size()))));
  }
  // Another library exports for writing what may be written to; numpy's view does not
  // say so.
  if (!foreign && !view.writeable()) {
    throw InputError("out is read-only, must be writable");
  }
  return {out, view, static_cast<double*>(const_cast<void*>(view.data()))};
}

Buffer buffer_like(const py::object& out, Doubles& values) {
  Buffer buffer = buffer_for(out, {values.shape(), values.shape() + values.ndim()});
  const double* from = values.data();
  if (from != buffer.data && from < buffer.data + values.size() &&
      buffer.data < from + values.size()) {
    values = Doubles(values.attr("copy")());
  }
  return buffer;
}

}  // namespace palpate

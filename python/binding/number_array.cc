#include "python/binding/number_array.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace py = pybind11;

namespace palpate {

Doubles doubles(const py::handle& values, const char* what) {
  const py::array array = py::array::ensure(values);
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

}  // namespace palpate

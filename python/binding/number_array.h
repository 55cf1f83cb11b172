// Numbers that Python hands over, as arrays of doubles, and buffers for results.
#pragma once

#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace palpate {

using Doubles =
    pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Contiguous, and without a copy where it is so already. Of an array of another
/// library, what its __dlpack__() exports.
/// @param what for the message, "positions". @throws InputError for what is no number,
/// or does not lie in the CPU's memory.
[[nodiscard]] Doubles doubles(const pybind11::handle& values, const char* what);

/// `count` numbers in one dimension. @throws InputError.
void take_row(const pybind11::handle& values, const char* what, pybind11::ssize_t count,
              double* into);

/// Where a result goes.
struct Buffer {
  pybind11::object given;  ///< what the caller gets: the own buffer, or a new array
  pybind11::array view;    ///< of its memory
  double* data = nullptr;
};

/// A new array, or the caller's `out` where that is not None: a numpy array, or one of
/// another library on the CPU. @throws InputError unless it is of that shape,
/// contiguous, of float64 and may be written to.
[[nodiscard]] Buffer buffer_for(const pybind11::object& out,
                                const std::vector<pybind11::ssize_t>& shape);

/// buffer_for() the shape of `values`, which are copied where the buffer shares some,
/// not all, of their memory.
[[nodiscard]] Buffer buffer_like(const pybind11::object& out, Doubles& values);

}  // namespace palpate

// Numbers that Python hands over, as arrays of doubles.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace palpate {

using Doubles =
    pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Contiguous, and without a copy where it is so already.
/// @param what for the message, "positions". @throws InputError for what is no number.
[[nodiscard]] Doubles doubles(const pybind11::handle& values, const char* what);

/// `count` numbers in one dimension. @throws InputError.
void take_row(const pybind11::handle& values, const char* what, pybind11::ssize_t count,
              double* into);

}  // namespace palpate

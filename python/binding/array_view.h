// Read-only numpy arrays that look into C++ memory and keep its owner alive.
#pragma once

#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace palpate {

template <typename T>
[[nodiscard]] pybind11::array looking_at(const T* data,
                                         std::vector<pybind11::ssize_t> shape,
                                         pybind11::handle owner) {
  pybind11::array_t<T> array(std::move(shape), data, owner);
  array.attr("setflags")(pybind11::arg("write") = false);
  return array;
}

template <typename T>
[[nodiscard]] pybind11::array looking_at(const std::vector<T>& rows,
                                         pybind11::handle owner) {
  return looking_at(rows.data(), {static_cast<pybind11::ssize_t>(rows.size())}, owner);
}

/// Of a row-major Eigen matrix.
template <typename Matrix>
[[nodiscard]] pybind11::array rows_of(const Matrix& matrix, pybind11::handle owner) {
  static_assert(Matrix::IsRowMajor);
  return looking_at(matrix.data(), {matrix.rows(), matrix.cols()}, owner);
}

}  // namespace palpate

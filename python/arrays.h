// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// NumPy arrays in and out: float64, one configuration a row.
#pragma once

#include "mneme/planning.h"

#include <pybind11/numpy.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Anything that NumPy makes an array of real numbers of. Raises TypeError if it is none; `what`
/// names it.
[[nodiscard]] Array to_numbers(const py::handle& value, const std::string& what);
/// The same as NumPy has them, before they become float64.
[[nodiscard]] py::array to_real_array(const py::handle& value, const std::string& what);
/// A 1-D array of `count` numbers, or of any number of them if `count` is negative.
[[nodiscard]] std::vector<double> to_vector(const py::handle& value, int count,
                                            const std::string& what);
/// A 2-D array of rows of `columns` numbers.
[[nodiscard]] Path to_rows(const py::handle& value, int columns, const std::string& what);
/// x, y, z in metres.
[[nodiscard]] Vec3 to_point(const py::handle& value, const std::string& what);

/// Makes an array that stands for what it was copied from: writing into it would be lost.
template <class T>
[[nodiscard]] py::array_t<T> read_only(py::array_t<T> array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

[[nodiscard]] py::array_t<double> to_array(std::span<const double> values);
/// An array of shape (rows, columns), also if there are no rows.
[[nodiscard]] py::array_t<double> to_array(const Path& rows, int columns);

}  // namespace mneme::python

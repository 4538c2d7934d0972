// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Conversion from and to NumPy arrays: float64, one configuration per row.
#pragma once

#include "mneme/planning.h"

#include <pybind11/numpy.h>

#include <span>
#include <string>
#include <vector>

namespace mneme::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Converts a value to an array of real numbers. Raises TypeError otherwise; `what` names the
/// value.
[[nodiscard]] Array to_numbers(const py::handle& value, const std::string& what);
/// As to_numbers(), in the type that NumPy chooses.
[[nodiscard]] py::array to_real_array(const py::handle& value, const std::string& what);
/// Converts a 1-D array of `count` numbers; any number if `count` is negative.
[[nodiscard]] std::vector<double> to_vector(const py::handle& value, int count,
                                            const std::string& what);
/// Converts a 2-D array with `columns` columns.
[[nodiscard]] Array to_matrix(const py::handle& value, int columns, const std::string& what);
/// The same as one vector per row.
[[nodiscard]] Path to_rows(const py::handle& value, int columns, const std::string& what);
/// Converts x, y, z in metres.
[[nodiscard]] Vec3 to_point(const py::handle& value, const std::string& what);

/// Makes an array read-only: it is a copy, so writing into it would be lost.
template <class T>
[[nodiscard]] py::array_t<T> read_only(py::array_t<T> array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

[[nodiscard]] py::array_t<double> to_array(std::span<const double> values);
/// Returns an array of shape (rows, columns), also without rows.
[[nodiscard]] py::array_t<double> to_array(const Path& rows, int columns);

}  // namespace mneme::python

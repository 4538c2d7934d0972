// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "arrays.h"

#include "errors.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::python {
namespace {

std::string shape_of(const Array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

[[noreturn]] void refuse_numbers(const py::handle& value, const std::string& what) {
  throw py::type_error(
      fmt::format("{}: expected an array of real numbers, got {}", what, shown(value)));
}

/// Converts to a kind of array. An exception such as KeyboardInterrupt passes.
template <class Made>
Made convert(const py::handle& value, const std::string& what) {
  try {
    return Made(py::reinterpret_borrow<py::object>(value));
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;
  }
  refuse_numbers(value, what);
}

}  // namespace

py::array to_real_array(const py::handle& value, const std::string& what) {
  if (value.is_none()) refuse_numbers(value, what);
  const auto raw = convert<py::array>(value, what);
  const char kind = raw.dtype().kind();
  const bool is_real = kind == 'f' || kind == 'i' || kind == 'u';
  if (!is_real && raw.size() > 0) refuse_numbers(value, what);
  return raw;
}

Array to_numbers(const py::handle& value, const std::string& what) {
  return convert<Array>(to_real_array(value, what), what);
}

std::vector<double> to_vector(const py::handle& value, int count, const std::string& what) {
  const Array array = to_numbers(value, what);
  if (array.ndim() != 1 || (count >= 0 && array.size() != count)) {
    raise_invalid(fmt::format("{}: expected an array of shape {}, got shape {}", what,
                              count >= 0 ? fmt::format("({},)", count) : "(n,)", shape_of(array)));
  }
  return {array.data(), array.data() + array.size()};
}

Array to_matrix(const py::handle& value, int columns, const std::string& what) {
  Array array = to_numbers(value, what);
  if (array.ndim() == 2 && array.shape(1) == columns) return array;
  raise_invalid(fmt::format("{}: expected an array of shape (n, {}), got shape {}", what, columns,
                            shape_of(array)));
}

Path to_rows(const py::handle& value, int columns, const std::string& what) {
  const Array array = to_matrix(value, columns, what);
  Path rows;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    rows.emplace_back(array.data(i, 0), array.data(i, 0) + columns);
  }
  return rows;
}

Vec3 to_point(const py::handle& value, const std::string& what) {
  const std::vector<double> point = to_vector(value, 3, what);
  return {point[0], point[1], point[2]};
}

py::array_t<double> to_array(std::span<const double> values) {
  py::array_t<double> array(static_cast<py::ssize_t>(values.size()));
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

py::array_t<double> to_array(const Path& rows, int columns) {
  py::array_t<double> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{columns}});
  double* data = array.mutable_data();
  for (const Configuration& row : rows) data = std::copy(row.begin(), row.end(), data);
  return array;
}

}  // namespace mneme::python

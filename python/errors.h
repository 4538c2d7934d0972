// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme's errors as Python exceptions.
#pragma once

#include "mneme/base.h"

#include <pybind11/pybind11.h>

#include <exception>
#include <string>
#include <string_view>
#include <utility>

namespace mneme::python {

namespace py = pybind11;

/// Carries an Error to Python, where it becomes a mneme.Error.
class RaisedError : public std::exception {
 public:
  explicit RaisedError(Error error) : error_(std::move(error)) {}
  [[nodiscard]] const Error& error() const { return error_; }
  [[nodiscard]] const char* what() const noexcept override { return error_.message.c_str(); }

 private:
  Error error_;
};

/// Returns text for Python, with bytes that are not UTF-8 as \xNN.
[[nodiscard]] inline py::str to_text(std::string_view text) {
  PyObject* decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

/// The same for each of a list.
template <class Texts>
[[nodiscard]] py::list to_texts(const Texts& texts) {
  py::list result;
  for (const std::string& text : texts) result.append(to_text(text));
  return result;
}

/// Returns the value of a result or raises its error.
template <class T>
[[nodiscard]] T unwrap(Result<T> result) {
  if (!result) throw RaisedError(std::move(result.error()));
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

[[noreturn]] inline void raise_invalid(std::string message) {
  throw RaisedError({ErrorCode::invalid, std::move(message)});
}

}  // namespace mneme::python

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

/// Returns the UTF-8 of a str, with lone surrogates as \udcXX.
[[nodiscard]] inline std::string to_utf8(const py::handle& text) {
  PyObject* encoded = PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace");
  if (encoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(encoded);
}

/// Returns repr(value) for a message, cut after 80 characters; the name of its type where repr()
/// fails, as for an int of 5000 digits. Exceptions such as KeyboardInterrupt pass.
[[nodiscard]] inline std::string shown(const py::handle& value) {
  constexpr Py_ssize_t kMostCharacters = 80;
  try {
    const py::str whole = py::repr(value);
    PyObject* begin = PyUnicode_Substring(whole.ptr(), 0, kMostCharacters);
    if (begin == nullptr) throw py::error_already_set();
    return to_utf8(py::reinterpret_steal<py::str>(begin));
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;
    return std::string("a value of type ") + Py_TYPE(value.ptr())->tp_name;
  }
}

/// Drops the pending exception, or throws it if it is none of a value, such as KeyboardInterrupt.
/// Returns false if there was none.
inline bool drop_exception() {
  if (PyErr_Occurred() == nullptr) return false;
  if (PyErr_ExceptionMatches(PyExc_Exception) == 0) throw py::error_already_set();
  PyErr_Clear();
  return true;
}

/// Returns the value of a result or raises its error.
template <class T>
[[nodiscard]] T unwrap(Result<T> result) {
  if (!result) throw RaisedError(std::move(result.error()));
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// Issues a UserWarning, which raises if the caller's filters say so.
inline void warn(std::string_view message) {
  const std::string text = to_text(message);
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

[[noreturn]] inline void raise_invalid(std::string message) {
  throw RaisedError({ErrorCode::invalid, std::move(message)});
}

}  // namespace mneme::python

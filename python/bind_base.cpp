// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/base.h"

#include "bindings.h"
#include "errors.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

namespace mneme::python {
namespace {

/// mneme.Error. Never destroyed, as all static types.
PyObject* error_type = nullptr;

void raise_in_python(const Error& error) {
  const py::object type = py::reinterpret_borrow<py::object>(error_type);
  const py::object value = type(to_text(error.message));
  value.attr("code") = to_string(error.code);
  PyErr_SetObject(error_type, value.ptr());
}

void bind_error(py::module_& module) {
  error_type = PyErr_NewExceptionWithDoc(
      "mneme.Error",
      "A file, an argument or a database is wrong.\n\n"
      "The message names the file, line or object and what was expected. `code` is one of:\n"
      "'io': a file cannot be read, written or created;\n"
      "'parse': malformed text;\n"
      "'unsupported': well-formed, but not handled;\n"
      "'invalid': out of range, or inputs do not fit together;\n"
      "'wrong_robot': a database of another robot;\n"
      "'corrupt': a damaged database.",
      nullptr, nullptr);
  if (error_type == nullptr) throw py::error_already_set();
  module.attr("Error") = py::reinterpret_borrow<py::object>(error_type);
  module.attr("Error").attr("code") = "invalid";
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const RaisedError& raised) {
      raise_in_python(raised.error());
    }
  });
}

}  // namespace

void bind_base(py::module_& module) {
  bind_error(module);
  module.attr("__version__") = std::string(version());
  module.def(
      "default_isa", [] { return std::string(to_string(default_isa())); },
      "Returns the default instruction set of the kernels: the environment variable MNEME_ISA, or\n"
      "the best of this machine.");
  module.def(
      "available_isas",
      [] {
        std::vector<std::string> names;
        for (const Isa isa : available_isas()) names.emplace_back(to_string(isa));
        return names;
      },
      "Returns the instruction sets that this machine can run, slowest first.");
  module.def(
      "find_scene",
      [](const std::filesystem::path& name) { return unwrap(find_scene(name.string())); },
      py::arg("name"),
      "Returns the path of a bundled scene or problem, such as 'planar/threaded_b2.yaml'.");
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/base.h"

#include "bindings.h"
#include "errors.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace mneme::python {
namespace {

/// mneme.Error. Lives as long as the process, like all static types.
PyObject* error_type = nullptr;

void raise_in_python(const Error& error) {
  const py::object type = py::reinterpret_borrow<py::object>(error_type);
  const py::object value = type(error.message);
  value.attr("code") = to_string(error.code);
  PyErr_SetObject(error_type, value.ptr());
}

void bind_error(py::module_& module) {
  error_type = PyErr_NewExceptionWithDoc(
      "mneme.Error",
      "Something is wrong with a file, an argument or a database.\n\n"
      "The message names the file, line or object and says what was expected. `code` is one of\n"
      "'io' (a file cannot be read, written or created), 'parse' (malformed text), 'unsupported'\n"
      "(well-formed, but not handled), 'invalid' (out of range, or inputs that do not fit\n"
      "together), 'wrong_robot' (a database of another robot) and 'corrupt'.",
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
      "The instruction set that kernels use unless told otherwise: the best of this machine, or\n"
      "the one that the environment variable MNEME_ISA names.");
  module.def(
      "available_isas",
      [] {
        std::vector<std::string> names;
        for (const Isa isa : {Isa::scalar, Isa::sse, Isa::avx2, Isa::avx512}) {
          if (is_available(isa)) names.emplace_back(to_string(isa));
        }
        return names;
      },
      "Instruction sets that this machine can run, from the worst to the best.");
  module.def(
      "find_scene", [](const std::string& name) { return unwrap(find_scene(name)); },
      py::arg("name"),
      "The file of a scene or problem that came with mneme, such as 'planar/threaded_b2.yaml'.");
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Classes that cannot be sent to another process.
#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <string>

namespace mneme::python {

namespace py = pybind11;

/// Makes pickling and copying of a class raise a TypeError. `instead` says what to do.
template <class Class>
void refuse_pickling(Class& type, const std::string& instead) {
  const auto name = type.attr("__name__").template cast<std::string>();
  type.def("__reduce_ex__", [name, instead](const py::object&, int) -> py::object {
    throw py::type_error(fmt::format("a mneme.{} cannot be pickled: {}", name, instead));
  });
}

}  // namespace mneme::python

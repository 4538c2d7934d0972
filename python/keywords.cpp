// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keywords.h"

#include <algorithm>

namespace mneme::python {

std::string keyword_of(std::string_view flag) {
  std::string keyword(flag);
  std::replace(keyword.begin(), keyword.end(), '-', '_');
  return keyword == "lambda" ? keyword + "_" : keyword;
}

void Keywords::apply_memory(MemorySettings& settings) {
  known_.push_back("kind");
  if (arguments_.contains("kind") && !arguments_["kind"].is_none()) {
    const py::object given = arguments_["kind"];
    if (!py::isinstance<py::str>(given)) fail_type("kind", given, "the name of a kind of memory");
    settings.kind = unwrap(find_memory_kind(to_utf8(given)))->name;
  }
  apply(settings);
}

void Keywords::apply_memory_mode(MemoryMode& mode) {
  known_.push_back("memory");
  if (!arguments_.contains("memory")) return;
  const py::object given = arguments_["memory"];
  if (!py::isinstance<py::str>(given)) fail_type("memory", given, "'auto', 'off' or 'paper'");
  mode = unwrap(parse_memory_mode(to_utf8(given)));
}

std::string describe_memory_keywords() {
  std::string names;
  for (const MemoryKind* kind : memory_kinds()) {
    names += (names.empty() ? "" : ", ") + std::string(kind->name);
  }
  return "kind: str = None\n    kind of memory: " + names +
         ". Default: every kind in the database, or the robot's default\n" +
         describe_keywords<MemorySettings>();
}

void Keywords::finish() const {
  for (const auto& [name, value] : arguments_) {
    const std::string keyword = to_utf8(name);
    if (std::find(known_.begin(), known_.end(), keyword) != known_.end()) continue;
    const auto close =
        py::module_::import("difflib").attr("get_close_matches")(keyword, py::cast(known_), 1);
    const std::string hint =
        py::len(close) > 0
            ? fmt::format("; did you mean '{}'?", py::str(close[py::int_(0)]).cast<std::string>())
            : fmt::format("; help(mneme.{}) lists the settings", function_);
    throw py::type_error(
        fmt::format("{}() got an unexpected keyword argument '{}'{}", function_, keyword, hint));
  }
}

void Keywords::read(const std::string& keyword, const py::object& given, bool& value, bool,
                    bool) const {
  const bool is_bool = py::isinstance<py::bool_>(given) ||
                       py::isinstance(given, py::module_::import("numpy").attr("bool_"));
  if (!is_bool) fail_type(keyword, given, "True or False");
  value = given.cast<bool>();
}

void Keywords::read(const std::string& keyword, const py::object& given, double& value,
                    double least, double most) const {
  if (py::isinstance<py::bool_>(given)) fail_type(keyword, given, "a number");
  const double number = PyFloat_AsDouble(given.ptr());
  if (PyErr_Occurred() != nullptr && PyErr_ExceptionMatches(PyExc_OverflowError) != 0) {
    PyErr_Clear();
    fail_range(keyword, given, describe(least, most));
  }
  if (drop_exception()) fail_type(keyword, given, "a number");
  // A NaN is out of range, too.
  if (!(number >= least && number <= most)) fail_range(keyword, given, describe(least, most));
  value = number;
}

py::object Keywords::whole_number(const std::string& keyword, const py::object& given) const {
  PyObject* number = py::isinstance<py::bool_>(given) ? nullptr : PyNumber_Index(given.ptr());
  if (number != nullptr) return py::reinterpret_steal<py::object>(number);
  static_cast<void>(drop_exception());
  fail_type(keyword, given, "a whole number");
}

void Keywords::fail_type(const std::string& keyword, const py::object& given,
                         std::string_view expected) const {
  throw py::type_error(
      fmt::format("{}: {}={} is not {}", function_, keyword, shown(given), expected));
}

void Keywords::fail_range(const std::string& keyword, const py::object& given,
                          const std::string& range) const {
  raise_invalid(fmt::format("{}: {}={} is out of range: expected {}", function_, keyword,
                            shown(given), range));
}

SolveSettings read_solve_settings(const std::string& function, const std::string& planner,
                                  const std::string& sampler, const std::string& isa,
                                  const py::kwargs& arguments) {
  SolveSettings settings;
  settings.planner = planner;
  settings.sampler = sampler;
  settings.isa = unwrap(parse_isa(isa));
  Keywords keywords(function, arguments);
  keywords.apply(settings);
  keywords.apply(settings.plan);
  keywords.apply_memory(settings.memory);
  keywords.apply_memory_mode(settings.memory_mode);
  keywords.apply(settings.learn);
  keywords.apply(settings.ik);
  keywords.finish();
  return settings;
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/memory.h"

#include "arrays.h"
#include "bindings.h"
#include "keywords.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace mneme::python {
namespace {

int key_size_for_arm(const MemoryKind& kind, const std::vector<double>& lengths) {
  return kind.key_size(unwrap(parse_robot(unwrap(planar_arm_urdf("arm", lengths)), "arm")));
}

/// Keys of whole paths have a fixed number of values per joint, for every robot.
PrimitiveKey to_key(const MemoryKind& kind, const py::object& value, const std::string& what) {
  PrimitiveKey key = to_vector(value, -1, what);
  const int size = static_cast<int>(key.size()), expected = key_size_for_arm(kind, {1});
  const int per_joint = key_size_for_arm(kind, {1, 1}) - expected;
  const bool is_key = per_joint == 0 ? size == expected
                                     : size > per_joint && size % per_joint == expected % per_joint;
  if (!is_key) {
    raise_invalid(
        fmt::format("{}: a key of the kind '{}' cannot have {} numbers", what, kind.name, size));
  }
  return key;
}

}  // namespace

void bind_primitive(py::module_& module) {
  py::class_<LocalPrimitive>(module, "Primitive",
                             "A pair of close obstacles, the unit of experience.")
      .def_static(
          "from_circles",
          [](const py::object& circles) {
            return make_primitive(to_vector(circles, 6, "circles"));
          },
          py::arg("circles"),
          "Returns the primitive of two circles (x_a, y_a, r_a, x_b, y_b, r_b), metres.")
      .def_property_readonly(
          "key", [](const LocalPrimitive& self) { return to_array(self.key); },
          "Its description in canonical form; metres.")
      .def_readonly("gap", &LocalPrimitive::gap, "Metres between the two obstacles.")
      .def_readonly("obstacles", &LocalPrimitive::obstacles,
                    "Indices of the obstacles in the scene.")
      .def("__repr__", [](const LocalPrimitive& self) {
        return fmt::format("<mneme.Primitive of {} numbers, gap {:.4f} m>", self.key.size(),
                           self.gap);
      });
  module.def(
      "decompose",
      [](const Robot& robot, const Scene& scene, const py::kwargs& arguments) {
        MemorySettings settings;
        Keywords keywords("decompose", arguments);
        keywords.apply_memory(settings);
        keywords.finish();
        return unwrap(decompose({robot, scene}, settings));
      },
      py::arg("robot"), py::arg("scene"),
      ("Returns the pairs of close obstacles of a scene, in scene order.\n\n" +
       describe_memory_keywords())
          .c_str());
  module.def(
      "kind_names",
      [] {
        std::vector<std::string> names;
        for (const MemoryKind* kind : memory_kinds()) names.emplace_back(kind->name);
        return names;
      },
      "Returns the names of all kinds of memory.");
  module.def(
      "similarity_error",
      [](const py::object& a, const py::object& b, const std::string& kind) {
        const MemoryKind& known = *unwrap(find_memory_kind(kind));
        const PrimitiveKey first = to_key(known, a, "a");
        return similarity_error(known, first, to_vector(b, static_cast<int>(first.size()), "b"));
      },
      py::arg("a"), py::arg("b"), py::arg("kind") = "pairs",
      "Returns the squared distance of two canonical keys of one kind of memory, m^2.");
}

}  // namespace mneme::python

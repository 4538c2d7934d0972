// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/spheres.h"
#include "mneme/scene.h"

#include "bindings.h"
#include "errors.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace mneme::python {
namespace {

Robot attach_objects(const Robot& robot, const std::string& link, const Scene& objects,
                     const std::vector<std::string>& touch) {
  std::vector<AttachedObject> attached;
  for (const Obstacle& object : objects.obstacles) {
    attached.push_back({object.name, link, object.shapes, {}, touch});
  }
  if (attached.empty()) raise_invalid("objects: expected at least one, got an empty scene");
  return unwrap(attach(robot, std::move(attached)));
}

}  // namespace

void bind_attached(py::class_<Robot>& robot) {
  robot.def("attach", &attach_objects, py::arg("link"), py::arg("objects"), py::kw_only(),
            py::arg("touch") = std::vector<std::string>(),
            "This robot carrying objects: a Scene in the frame of the link that carries them.\n\n"
            "touch: names of other links and attached objects that may touch them. What is\n"
            "attached is checked against obstacles, links and other objects. Experience of the\n"
            "robot applies, whatever it carries. Takes tens of microseconds.");
  robot.def(
      "detach",
      [](const Robot& self, const std::string& name) {
        return unwrap(self.without_attached(name));
      },
      py::arg("name"), "This robot without one of its attached objects.");
  robot.def_property_readonly(
      "attached",
      [](const Robot& self) {
        std::vector<std::string> names;
        for (const ApproximatedObject& object : self.attached())
          names.push_back(object.object.name);
        return names;
      },
      "Names of the attached objects.");
}

}  // namespace mneme::python

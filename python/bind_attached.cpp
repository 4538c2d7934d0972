// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/spheres.h"
#include "mneme/scene.h"

#include "bindings.h"
#include "errors.h"
#include "interruptible.h"

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
  return unwrap(run_interruptible([&] { return attach(robot, std::move(attached)); }));
}

}  // namespace

void bind_attached(py::class_<Robot>& robot) {
  robot.def("attach", &attach_objects, py::arg("link"), py::arg("objects"), py::kw_only(),
            py::arg("touch") = std::vector<std::string>(),
            "Returns this robot with attached objects.\n\n"
            "objects: a Scene in the frame of the link that carries them. touch: names of other\n"
            "links and attached objects that may touch them. Attached objects are checked against\n"
            "obstacles, links and each other. Memory of the robot still applies. Takes tens of\n"
            "microseconds.");
  robot.def(
      "detach",
      [](const Robot& self, const std::string& name) {
        return unwrap(self.without_attached(name));
      },
      py::arg("name"), "Returns this robot without one of its attached objects.");
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

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/problem.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

namespace mneme::python {
namespace {

/// One configuration or rows of them.
std::vector<Configuration> to_goals(const py::object& goals, int joint_count) {
  const Array array = to_numbers(goals, "goals");
  if (array.ndim() == 1) return {to_vector(array, joint_count, "goals")};
  std::vector<Configuration> rows = to_rows(array, joint_count, "goals");
  if (rows.empty()) raise_invalid("goals: expected at least one configuration");
  return rows;
}

Problem make_problem(const Robot& robot, const Scene& scene, const py::object& start,
                     const py::object& goals, std::string name, std::vector<PoseGoal> pose_goals) {
  if (goals.is_none() && pose_goals.empty()) {
    raise_invalid("goals: expected at least one configuration, or pose_goals");
  }
  for (const PoseGoal& goal : pose_goals) {
    if (const auto fault = describe_fault(robot, goal)) raise_invalid("pose_goals: " + *fault);
  }
  const int joints = robot.joint_count();
  std::vector<Configuration> rows;
  if (!goals.is_none()) rows = to_goals(goals, joints);
  return {std::move(name), robot, "", scene, to_vector(start, joints, "start"), std::move(rows), {},
          std::move(pose_goals)};
}

struct ProblemArguments {
  std::string where;
  std::string robot;
  py::object start;
  py::object goal;
  std::vector<PoseGoal> pose_goals;
  RobotOptions options;
};

Problem load(const ProblemArguments& arguments) {
  ProblemOptions options;
  options.robot = arguments.options;
  if (!arguments.robot.empty()) options.robot_path = unwrap(robot_file(arguments.robot));
  if (!arguments.start.is_none()) options.start = to_vector(arguments.start, -1, "start");
  if (!arguments.goal.is_none()) options.goal = to_vector(arguments.goal, -1, "goal");
  options.pose_goals = arguments.pose_goals;
  const py::gil_scoped_release released;
  return unwrap(load_problem(arguments.where, options));
}

void bind_factories(py::class_<Problem>& problem) {
  problem.def(py::init(&make_problem), py::arg("robot"), py::arg("scene"), py::arg("start"),
              py::arg("goals") = py::none(), py::arg("name") = "problem", py::kw_only(),
              py::arg("pose_goals") = std::vector<PoseGoal>(),
              "start: shape (joint_count,), radians. goals: one configuration, or several of\n"
              "shape (k, joint_count); any of these and of the pose_goals will do. The scene is\n"
              "copied.");
  problem.def_static(
      "load",
      [](const std::filesystem::path& where, const std::filesystem::path& robot, py::object start,
         py::object goal, std::vector<PoseGoal> pose_goals, const std::filesystem::path& srdf,
         std::string group, std::vector<std::string> package_paths) {
        RobotOptions options;
        options.srdf_path = srdf.string();
        options.group = std::move(group);
        options.package_paths = std::move(package_paths);
        return load({where.string(), robot.string(), std::move(start), std::move(goal),
                     std::move(pose_goals), std::move(options)});
      },
      py::arg("where"), py::kw_only(), py::arg("robot") = "", py::arg("start") = py::none(),
      py::arg("goal") = py::none(), py::arg("pose_goals") = std::vector<PoseGoal>(),
      py::arg("srdf") = "", py::arg("group") = "",
      py::arg("package_paths") = std::vector<std::string>(),
      "Reads a problem: a YAML file, FILE.json#NAME for one of a compact file, or a motion plan\n"
      "request of MoveIt. What is given besides replaces what the file says.");
}

}  // namespace

void bind_problem(py::module_& module) {
  module.def(
      "list_problems",
      [](const std::filesystem::path& path) { return unwrap(list_problems(path.string())); },
      py::arg("path"), "Names of the problems in a compact file, for Problem.load('PATH#NAME').");
  py::class_<Problem> problem(module, "Problem",
                              "A robot, a scene, a start and goals: the motion planning question.");
  bind_factories(problem);
  problem.def_readwrite("name", &Problem::name)
      .def_readonly("robot", &Problem::robot)
      .def_property_readonly(
          "scene", [](const Problem& self) { return self.scene; }, "A copy of the scene.")
      .def_property_readonly(
          "start", [](const Problem& self) { return to_array(self.start); },
          "Shape (joint_count,), radians.")
      .def_property_readonly(
          "goals",
          [](const Problem& self) { return to_array(self.goals, self.robot.joint_count()); },
          "Shape (k, joint_count), radians.")
      .def_readonly("pose_goals", &Problem::pose_goals)
      .def_readonly("warnings", &Problem::warnings, "What was left aside while reading.")
      .def(
          "to_yaml",
          [](const Problem& self, const std::string& robot) { return to_yaml(self, robot); },
          py::arg("robot"),
          "Text of a problem file with the scene inside; robot is written as "
          "given: a name or the path of a URDF.")
      .def("__repr__", [](const Problem& self) {
        return fmt::format("<mneme.Problem '{}', robot '{}', {} obstacles>", self.name,
                           self.robot.name(), self.scene.obstacles.size());
      });
}

}  // namespace mneme::python

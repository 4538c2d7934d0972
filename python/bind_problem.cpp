// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/problem.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "origins.h"
#include "pickling.h"
#include "prepare.h"
#include "problem.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace mneme::python {
namespace {

/// One configuration or rows of them; none only beside `pose_goals`.
std::vector<Configuration> to_goals(const py::object& goals, int joint_count,
                                    std::span<const PoseGoal> pose_goals) {
  const Array array = to_numbers(goals, "goals");
  if (array.size() == 0) {
    if (!pose_goals.empty()) return {};
    raise_invalid("goals: expected at least one configuration, got none");
  }
  if (array.ndim() == 1) return {to_vector(array, joint_count, "goals")};
  return to_rows(array, joint_count, "goals");
}

using Constraints = std::vector<OrientationConstraint>;

Constraints checked(const Robot& robot, Constraints constraints) {
  for (const OrientationConstraint& constraint : constraints) {
    if (const auto fault = describe_fault(robot, constraint)) {
      raise_invalid("constraints: " + *fault);
    }
  }
  return constraints;
}

/// Empty for None: at rest. Any number of values if `joints` is -1.
std::vector<double> to_velocity(const py::object& velocity, int joints, const char* name) {
  if (velocity.is_none()) return {};
  std::vector<double> values = to_vector(velocity, joints, name);
  if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
    raise_invalid(fmt::format("{}: expected finite numbers", name));
  }
  return values;
}

SharedProblem make_problem(const Robot& robot, const std::shared_ptr<Scene>& scene,
                           const py::object& start, const py::object& goals, std::string name,
                           std::vector<PoseGoal> pose_goals, Constraints constraints,
                           const py::object& start_velocity, const py::object& end_velocity) {
  if (goals.is_none() && pose_goals.empty()) {
    raise_invalid("goals: expected at least one configuration, or pose_goals");
  }
  const int joints = robot.joint_count();
  Configuration from = to_vector(start, joints, "start");
  place_goals(pose_goals, robot, from, "pose_goals");
  std::vector<Configuration> rows;
  if (!goals.is_none()) rows = to_goals(goals, joints, pose_goals);
  Problem problem{.name = std::move(name),
                  .robot = robot,
                  .start = std::move(from),
                  .goals = std::move(rows),
                  .pose_goals = std::move(pose_goals)};
  problem.constraints = checked(robot, std::move(constraints));
  problem.start_velocity = to_velocity(start_velocity, joints, "start_velocity");
  problem.end_velocity = to_velocity(end_velocity, joints, "end_velocity");
  return {std::move(problem), scene};
}

/// Converts a name or a path-like object.
std::string path_of(const py::object& robot) {
  try {
    return robot.cast<std::filesystem::path>().string();
  } catch (const py::cast_error&) {
    throw py::type_error(
        fmt::format("robot: expected a name, a path or a Robot, got {}", shown(robot)));
  }
}

/// Nothing for None. Planning checks the number of values.
std::optional<std::vector<double>> to_given(const py::object& values, const char* name) {
  if (values.is_none()) return std::nullopt;
  return to_vector(values, -1, name);
}

/// `options` have all arguments but the robot.
SharedProblem load(const std::string& where, const py::object& robot, ProblemOptions options) {
  if (py::isinstance<Robot>(robot)) {
    options.made_robot = robot.cast<Robot>();
    if (!(options.robot == RobotOptions())) {
      raise_invalid("robot: a Robot has its own SRDF, group and packages; pass only the Robot");
    }
  } else if (const auto named = path_of(robot); !named.empty()) {
    options.robot_path = unwrap(robot_file(named));
  }
  SharedProblem shared(unwrap(run_interruptible([&] {
    return load_problem(where, options).map([](Problem problem) {
      prepare(problem.robot);
      return problem;
    });
  })));
  std::vector<ReadFile> files;
  const Problem& rest = shared.rest();
  add_files("a file of the problem", rest.files, files);
  set_origin(shared.scene(), std::move(files));
  if (!rest.robot_path.empty()) {
    set_origin(rest.robot.without_attached().identity(),
               robot_files(rest.robot_path, options.robot.srdf_path));
  }
  return shared;
}

void bind_factories(py::class_<SharedProblem>& problem) {
  problem.def(py::init(&make_problem), py::arg("robot"), py::arg("scene").none(false),
              py::arg("start"), py::arg("goals") = py::none(), py::arg("name") = "problem",
              py::kw_only(), py::arg("pose_goals") = std::vector<PoseGoal>(),
              py::arg("constraints") = Constraints(), py::arg("start_velocity") = py::none(),
              py::arg("end_velocity") = py::none(),
              "start: shape (joint_count,), radians. goals: one configuration, or rows of shape\n"
              "(k, joint_count). A path may end at any of the goals and pose_goals. The scene is\n"
              "shared: later edits take effect. Pass scene.copy() to avoid that.\n"
              "start_velocity, end_velocity: a value per joint, rad/s or m/s; default: at rest.");
  problem.def_static(
      "load",
      [](const std::filesystem::path& where, const py::object& robot, const py::object& start,
         const py::object& goal, std::vector<PoseGoal> pose_goals, Constraints constraints,
         const std::filesystem::path& srdf, std::string group,
         const std::vector<std::filesystem::path>& package_paths, std::optional<double> self_filter,
         bool strict, bool hard_limits, const py::object& start_velocity,
         const py::object& end_velocity) {
        ProblemOptions options;
        options.robot.strict = strict;
        options.robot.hard_limits = hard_limits;
        options.robot.srdf_path = srdf.string();
        options.robot.group = std::move(group);
        for (const auto& path : package_paths) {
          options.robot.package_paths.push_back(path.string());
        }
        options.start = to_given(start, "start");
        options.goal = to_given(goal, "goal");
        options.start_velocity = to_given(start_velocity, "start_velocity");
        options.end_velocity = to_given(end_velocity, "end_velocity");
        options.pose_goals = std::move(pose_goals);
        options.constraints = std::move(constraints);
        options.self_filter = self_filter;
        return load(where.string(), robot, std::move(options));
      },
      py::arg("where"), py::kw_only(), py::arg("robot") = "", py::arg("start") = py::none(),
      py::arg("goal") = py::none(), py::arg("pose_goals") = std::vector<PoseGoal>(),
      py::arg("constraints") = Constraints(), py::arg("srdf") = "", py::arg("group") = "",
      py::arg("package_paths") = std::vector<std::filesystem::path>(),
      py::arg("self_filter") = py::none(), py::arg("strict") = false,
      py::arg("hard_limits") = false, py::arg("start_velocity") = py::none(),
      py::arg("end_velocity") = py::none(),
      "Reads a problem: a YAML file, FILE.json#NAME for one of a compact file, or a motion plan\n"
      "request of MoveIt. Other arguments replace values of the file.\n\n"
      "robot: a name, the path of a URDF, or a Robot, which is then shared. A Robot also replaces\n"
      "SRDF, group and joints of the file; requests of MoveIt need a URDF.\n"
      "self_filter: points of clouds within this many metres of the robot at its start are\n"
      "removed, with a warning.");
}

void bind_variations(py::class_<SharedProblem>& problem) {
  const auto joints = [](const SharedProblem& self) { return self.rest().robot.joint_count(); };
  problem.def(
      "with_start",
      [=](SharedProblem self, const py::object& start, const py::object& velocity) {
        self.rest().start = to_vector(start, joints(self), "start");
        self.rest().start_velocity = to_velocity(velocity, joints(self), "start_velocity");
        return self;
      },
      py::arg("start"), py::arg("start_velocity") = py::none(),
      "Returns this problem with another start, at rest unless there is a velocity. Robot and "
      "scene\nare shared. Pose goals stay where they are, also those with a frame.");
  problem.def(
      "with_goal",
      [=](SharedProblem self, const py::object& goal, const py::object& velocity) {
        self.rest().goals = to_goals(goal, joints(self), {});
        self.rest().pose_goals.clear();
        self.rest().end_velocity = to_velocity(velocity, joints(self), "end_velocity");
        return self;
      },
      py::arg("goal"), py::arg("end_velocity") = py::none(),
      "Returns this problem with another goal, or goals of shape (k, joint_count), instead of all\n"
      "goals and pose_goals; reached at rest unless there is a velocity. Robot and scene are "
      "shared.");
  problem.def(
      "with_constraints",
      [](SharedProblem self, Constraints constraints) {
        self.rest().constraints = checked(self.rest().robot, std::move(constraints));
        return self;
      },
      py::arg("constraints"),
      "Returns this problem with other constraints. Robot and scene are shared.");
  problem.def(
      "with_scene",
      [](const SharedProblem& self, const std::shared_ptr<Scene>& scene) {
        return SharedProblem(self.rest(), scene);
      },
      py::arg("scene").none(false), "Returns this problem in another scene, which is shared.");
}

void bind_functions(py::module_& module) {
  module.def(
      "drop_own_points",
      [](Scene& scene, const Robot& robot, const py::object& q, double distance) {
        const Configuration at = to_vector(q, robot.joint_count(), "q");
        Scene filtered = scene;
        auto notes = unwrap(
            run_interruptible([&] { return drop_own_points(filtered, robot, at, distance); }));
        scene = std::move(filtered);
        return notes;
      },
      py::arg("scene"), py::arg("robot"), py::arg("q"), py::arg("distance"),
      "Removes points of the robot itself from the scene's clouds: those within distance, metres,\n"
      "of the robot at q, shape (joint_count,). Returns a sentence for each changed obstacle.");
  module.def(
      "list_problems",
      [](const std::filesystem::path& path) { return unwrap(list_problems(path.string())); },
      py::arg("path"),
      "Returns the names of the problems in a compact file, for Problem.load('PATH#NAME').");
}

void bind_velocities(py::class_<SharedProblem>& problem) {
  problem
      .def_property_readonly(
          "start_velocity",
          [](const SharedProblem& self) { return read_only(to_array(self.rest().start_velocity)); },
          "Shape (joint_count,), or (0,) at rest; read-only: see with_start.")
      .def_property_readonly(
          "end_velocity",
          [](const SharedProblem& self) { return read_only(to_array(self.rest().end_velocity)); },
          "Shape (joint_count,), or (0,) at rest; read-only: see with_goal.");
}

}  // namespace

void bind_problem(py::module_& module) {
  bind_functions(module);
  py::class_<SharedProblem> problem(
      module, "Problem", "A motion planning problem: a robot, a scene, a start and goals.");
  bind_factories(problem);
  bind_variations(problem);
  bind_velocities(problem);
  refuse_pickling(problem,
                  "load it in each process, or make it there of a robot that was loaded there, and "
                  "of scene, start and goals, which can be pickled");
  problem
      .def_property(
          "name", [](const SharedProblem& self) { return self.rest().name; },
          [](SharedProblem& self, std::string name) { self.rest().name = std::move(name); })
      .def_property_readonly("robot", [](const SharedProblem& self) { return self.rest().robot; })
      .def_property_readonly(
          "scene", [](const SharedProblem& self) { return self.scene(); },
          "The scene, not a copy: the next plan sees edits.")
      .def_property_readonly(
          "start", [](const SharedProblem& self) { return read_only(to_array(self.rest().start)); },
          "Shape (joint_count,), radians; read-only: see with_start.")
      .def_property_readonly(
          "goals",
          [](const SharedProblem& self) {
            return read_only(to_array(self.rest().goals, self.rest().robot.joint_count()));
          },
          "Shape (k, joint_count), radians; read-only: see with_goal.")
      .def_property_readonly(
          "pose_goals", [](const SharedProblem& self) { return self.rest().pose_goals; },
          "Goals as regions of poses, in addition to goals.")
      .def_property_readonly(
          "constraints", [](const SharedProblem& self) { return self.rest().constraints; },
          "Constraints along the whole path; see with_constraints.")
      .def_property_readonly(
          "warnings", [](const SharedProblem& self) { return to_texts(self.rest().warnings); },
          "Parts of the input that were ignored.")
      .def(
          "to_yaml",
          [](const SharedProblem& self, const std::string& robot) {
            return run_interruptible([&, copy = self.get()] { return to_yaml(copy, robot); });
          },
          py::arg("robot"),
          "Returns the text of a problem file that contains the scene. robot: a name or the path "
          "of "
          "a URDF, written as given.")
      .def(
          "to_compact_json",
          [](const SharedProblem& self, const std::string& robot) {
            return run_interruptible(
                [&, copy = self.get()] { return to_compact_json(copy, robot); });
          },
          py::arg("robot"), "As to_yaml(), as a compact file, which is JSON.")
      .def("__repr__", [](const SharedProblem& self) {
        return fmt::format("<mneme.Problem '{}', robot '{}', {} obstacles>", self.rest().name,
                           self.rest().robot.name(), self.scene()->obstacles.size());
      });
}

}  // namespace mneme::python

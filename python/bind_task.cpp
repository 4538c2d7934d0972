// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/task.h"
#include "mneme/task_file.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "memory.h"
#include "timed_plan.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace mneme::python {
namespace {

/// A task with its plan.
struct PlannedTask {
  Task task;
  SolveSettings settings;
  TaskResult result;
};

Task make_task(const Robot& robot, const Scene& scene, const py::object& start,
               const py::object& stages, const std::string& name) {
  Task task{name, robot, "", scene, to_vector(start, robot.joint_count(), "start"), {}};
  const py::module_ json = py::module_::import("json");
  // NumPy's arrays and numbers become lists and numbers.
  const py::cpp_function plain([](const py::object& value) -> py::object {
    if (py::hasattr(value, "tolist")) return value.attr("tolist")();
    throw py::type_error(
        fmt::format("Task: stages: {} is no number, text, list, dict or array", shown(value)));
  });
  const auto text = json.attr("dumps")(stages, py::arg("default") = plain).cast<std::string>();
  task.stages = unwrap(parse_stages(text, "stages", robot, task.start));
  unwrap(check_task(task));
  return task;
}

PlannedTask plan_task(const Task& task, const Memory* memory, const std::string& planner,
                      const std::optional<std::string>& sampler, const std::string& isa,
                      py::kwargs arguments) {
  auto settings = take_keywords<TaskSettings>("plan_task", arguments);
  settings.solve = read_solve_settings(
      "plan_task", planner, sampler.value_or(memory == nullptr ? "uniform" : "gl"), isa, arguments);
  const std::shared_ptr<Database> database = memory == nullptr ? nullptr : memory->get();
  if (memory == nullptr) check_without_memory("plan_task", settings.solve);
  std::atomic<bool> cancel = false;
  settings.solve.plan.cancel = &cancel;
  TaskResult result =
      unwrap(run_interruptible(cancel, [&] { return solve_task(task, database.get(), settings); }));
  settings.solve.plan.cancel = nullptr;
  return {task, settings.solve, std::move(result)};
}

/// From and to, by joint.
py::dict gripper_of(const StageResult& stage) {
  py::dict moved;
  if (!stage.gripper) return moved;
  const std::vector<std::string> names = stage.gripper->world->robot.joint_names();
  const Configuration &from = stage.gripper->path.front(), &to = stage.gripper->path.back();
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (from[j] != to[j]) moved[to_text(names[j])] = py::make_tuple(from[j], to[j]);
  }
  return moved;
}

py::list stages_of(const PlannedTask& plan) {
  py::list rows;
  for (const StageResult& stage : plan.result.stages) {
    py::list dropped;
    for (const Dropped& each : stage.dropped) {
      py::dict one;
      one["reason"] = to_text(to_string(each.reason));
      one["count"] = each.count;
      one["what"] = to_text(each.what);
      dropped.append(one);
    }
    py::dict row;
    row["name"] = to_text(stage.name);
    row["kind"] = to_text(to_string(stage.kind));
    row["path_time_s"] = stage.path_time_s;
    row["path"] = read_only(to_array(stage.path, plan.task.robot.joint_count()));
    row["alternative"] =
        stage.alternative < 0 ? py::object(py::none()) : py::int_(stage.alternative);
    row["alternatives"] = stage.alternatives;
    row["dropped"] = dropped;
    row["gripper"] = gripper_of(stage);
    rows.append(row);
  }
  return rows;
}

TimedPlan trajectory_of(const PlannedTask& plan, const py::object& dt, const py::object& limits,
                        const py::kwargs& arguments) {
  const TrajectorySettings timing = read_trajectory_settings("TaskPlan.trajectory", dt, arguments);
  if (!plan.result.is_solved()) {
    raise_invalid("trajectory: there is no plan: " + plan.result.message);
  }
  const Robot& robot = plan.task.robot;
  const RateLimits rates = find_limits(robot, timing, limits);
  const std::string file = file_name(limits);
  const TaskMotion motion = unwrap(run_interruptible(
      [&] { return time_task(plan.task, plan.result, plan.settings, rates, timing, file); }));
  return {robot, unwrap(motion.trajectory.sample(timing.dt)), stage_begins(plan.result, motion)};
}

void bind_plan(py::module_& module) {
  py::class_<PlannedTask>(module, "TaskPlan", "The plan of a task.")
      .def_property_readonly(
          "status", [](const PlannedTask& self) { return to_text(to_string(self.result.status)); },
          "'solved', 'timeout', 'iteration_limit', 'cancelled', 'invalid_start' or "
          "'invalid_goal'.")
      .def_property_readonly("is_solved",
                             [](const PlannedTask& self) { return self.result.is_solved(); })
      .def_property_readonly(
          "message", [](const PlannedTask& self) { return to_text(self.result.message); },
          "The stage that fails and what is in its way; empty if solved.")
      .def_property_readonly("stages", &stages_of,
                             "A dict per stage: name, kind, path_time_s, path, alternative,\n"
                             "alternatives, dropped and gripper.")
      .def_property_readonly(
          "path_time_s", [](const PlannedTask& self) { return self.result.path_time_s; },
          "Seconds at the velocity limits; the motion's are trajectory().duration.")
      .def_property_readonly(
          "planning_time_s", [](const PlannedTask& self) { return self.result.first_plan_time_s; },
          "Seconds until the first plan, without preparation.")
      .def_property_readonly(
          "preparation_time_s",
          [](const PlannedTask& self) { return self.result.preparation_time_s; },
          "Seconds for the collision checker of the scene, outside of the time limit.")
      .def_property_readonly("states_checked",
                             [](const PlannedTask& self) { return self.result.states_checked; })
      .def("trajectory", &trajectory_of, py::arg("dt") = py::none(), py::arg("limits") = py::none(),
           "Returns the motion of the whole task. Keywords are those of Plan.trajectory().")
      .def("to_json", [](const PlannedTask& self) { return to_json(self.task, self.result); });
}

}  // namespace

void bind_task(py::module_& module) {
  py::class_<Task>(module, "Task", "A robot, a scene, a start, and stages (docs/tasks.md).")
      .def(py::init(&make_task), py::arg("robot"), py::arg("scene"), py::arg("start"),
           py::arg("stages"), py::arg("name") = "task",
           "`stages`: a list of dicts with the keys of a task file.")
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            return unwrap(run_interruptible([&] { return load_task(path.string()); }));
          },
          py::arg("path"), "Reads a task file.")
      .def_readonly("name", &Task::name)
      .def_readonly("robot", &Task::robot)
      .def_property_readonly("stage_count", [](const Task& self) { return self.stages.size(); });
  bind_plan(module);
  module.def("plan_task", &plan_task, py::arg("task"), py::arg("database") = py::none(),
             py::kw_only(), py::arg("planner") = "rrt_connect", py::arg("sampler") = py::none(),
             py::arg("isa") = "automatic",
             ("Chooses among alternatives and plans all stages. A task with a start velocity stops "
              "within the limits of the URDF. Further keywords are the settings of plan().\n\n" +
              describe_keywords<TaskSettings>())
                 .c_str());
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/pipeline.h"
#include "mneme/report.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "memory.h"
#include "origins.h"
#include "pickling.h"
#include "problem.h"
#include "timed_plan.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace mneme::python {

std::string file_name(const py::object& path) {
  if (path.is_none()) return {};
  return py::module_::import("os").attr("fsencode")(path).cast<std::string>();
}

TrajectorySettings read_trajectory_settings(const std::string& method, const py::object& dt,
                                            const py::kwargs& arguments,
                                            TrajectorySettings timing) {
  py::kwargs all(arguments);
  if (!dt.is_none()) all["dt"] = dt;
  return read_keywords(method, all, timing);
}

RateLimits find_limits(const Robot& robot, const TrajectorySettings& timing,
                       const py::object& limits) {
  RateLimits rates = unwrap(find_rate_limits(robot, timing, file_name(limits)));
  for (const std::string& warning : rates.warnings) warn(warning);
  return rates;
}

namespace {

/// Input and result of a call of solve().
struct Plan {
  SharedProblem shared;
  Problem problem;                     ///< a copy at the time of the call
  std::vector<ReadFile> memory_files;  ///< of the database
  SolveSettings settings;
  std::shared_ptr<PlanRecorder> recorder;  ///< null unless the search was recorded
  SolveResult result;
  TrajectorySettings timing = {};  ///< of the trajectory that was announced, or defaults
  std::string limits_file = {};    ///< of the trajectory that was announced; may be empty
};

/// Takes a dict of keywords of Plan.trajectory() for the trajectory that will be made.
void read_timing(const py::object& keywords, Plan& plan) {
  bool is_named = py::isinstance<py::dict>(keywords);
  if (is_named) {
    for (const auto& entry : py::reinterpret_borrow<py::dict>(keywords)) {
      is_named &= py::isinstance<py::str>(entry.first);
    }
  }
  if (!is_named) {
    throw py::type_error(fmt::format(
        "plan: trajectory={}: expected a dict of keywords of Plan.trajectory(), such as {{}} or "
        "{{'dt': 0.01}}",
        shown(keywords)));
  }
  auto arguments = py::reinterpret_borrow<py::kwargs>(keywords.attr("copy")());
  py::object limits = py::none();
  if (arguments.contains("limits")) limits = arguments.attr("pop")("limits");
  plan.timing = read_keywords<TrajectorySettings>("Plan.trajectory", arguments);
  if (!limits.is_none()) {
    plan.limits_file = file_name(py::module_::import("os.path").attr("abspath")(limits));
  }
  plan.problem.robot = unwrap(narrow_positions(plan.problem.robot, plan.limits_file));
  plan.settings.plan.limits =
      std::make_shared<const RateLimits>(find_limits(plan.problem.robot, plan.timing, limits));
}

Plan plan(const SharedProblem& problem, const Memory* memory, const std::string& planner,
          const std::optional<std::string>& sampler, const std::string& isa, bool is_recorded,
          const py::object& trajectory, const py::kwargs& arguments) {
  const std::string source = sampler.value_or(memory == nullptr ? "uniform" : "gl");
  const std::shared_ptr<Database> database = memory == nullptr ? nullptr : memory->get();
  Plan made{problem,
            problem.get(),
            origin_of(database),
            read_solve_settings("plan", planner, source, isa, arguments),
            is_recorded ? std::make_shared<PlanRecorder>() : nullptr,
            {}};
  if (database == nullptr) check_without_memory("plan", made.settings);
  if (!trajectory.is_none()) read_timing(trajectory, made);
  std::atomic<bool> cancel = false;
  made.settings.plan.cancel = &cancel;
  made.settings.plan.observer = made.recorder.get();
  auto result =
      run_interruptible(cancel, [&] { return solve(made.problem, database.get(), made.settings); });
  made.settings.plan.cancel = nullptr;
  made.settings.plan.observer = nullptr;
  made.result = unwrap(std::move(result));
  return made;
}

py::array_t<double> path_of(const Plan& plan) {
  return read_only(to_array(plan.result.plan.path, plan.problem.robot.joint_count()));
}

/// The retrieved components in the scene's frame.
py::array_t<float> components_of(const Plan& plan) {
  const GaussianMixture* mixture = plan.result.gl.mixture.get();
  const py::ssize_t rows = mixture == nullptr ? 0 : mixture->component_count();
  py::array_t<float> means({rows, py::ssize_t{plan.problem.robot.joint_count()}});
  if (rows > 0) std::copy(mixture->means.begin(), mixture->means.end(), means.mutable_data());
  return read_only(std::move(means));
}

py::list primitives_of(const Plan& plan) {
  py::list rows;
  for (const PrimitiveRetrieval& found : plan.result.gl.primitives) {
    py::list names;
    for (const int index : found.primitive.obstacles) {
      names.append(plan.problem.scene.obstacles.at(static_cast<std::size_t>(index)).name);
    }
    py::list errors;
    for (const Match& match : found.matches) errors.append(match.similarity_error);
    py::dict row;
    row["obstacles"] = names;
    row["key"] = to_array(found.primitive.key);
    row["gap"] = found.primitive.gap;
    row["similarity_errors"] = errors;
    row["is_learned"] = found.is_learned;
    rows.append(row);
  }
  return rows;
}

py::array_t<double> rows_of(const TimedPlan& timed,
                            std::vector<double> Trajectory::Point::*quantity) {
  Path values;
  for (const Trajectory::Point& point : timed.points) values.push_back(point.*quantity);
  return to_array(values, timed.robot.joint_count());
}

py::list begins_of(const TimedPlan& timed) {
  py::list stages;
  for (const StageBegin& stage : timed.stages) {
    py::dict one;
    one["name"] = to_text(stage.name);
    one["begin_s"] = stage.begin_s;
    stages.append(one);
  }
  return stages;
}

TimedPlan time_plan(const Plan& plan, const py::object& dt, const py::object& limits,
                    const py::kwargs& arguments) {
  const TrajectorySettings timing =
      read_trajectory_settings("Plan.trajectory", dt, arguments, plan.timing);
  if (!plan.result.plan.is_solved()) {
    raise_invalid("trajectory: there is no path: " + plan.result.plan.message);
  }
  const Robot& robot = plan.problem.robot;
  const bool is_announced = limits.is_none() && arguments.empty() && plan.settings.plan.limits;
  py::object file = limits;
  if (limits.is_none()) file = py::bytes(plan.limits_file);
  const RateLimits rates =
      is_announced ? *plan.settings.plan.limits : find_limits(robot, timing, file);
  auto points = run_interruptible([&] {
    return make_trajectory(plan.problem, plan.settings, plan.result.plan.path, rates, timing)
        .and_then([&](const Trajectory& timed) { return timed.sample(timing.dt); });
  });
  return {robot, unwrap(std::move(points)), {}};
}

py::array_t<double> times_of(const TimedPlan& timed) {
  std::vector<double> times;
  for (const Trajectory::Point& point : timed.points) times.push_back(point.time_s);
  return to_array(times);
}

std::string svg_of(const Plan& plan) {
  return unwrap(to_svg(make_picture(plan.problem, plan.result)));
}

std::string trace_of(const Plan& plan) {
  return unwrap(run_interruptible([&] {
    return make_trace(plan.problem, plan.result, plan.recorder.get(), 0)
        .map([](const PlanTrace& trace) { return to_json(trace); });
  }));
}

std::string page_of(const Plan& plan) { return unwrap(to_page(trace_of(plan), plan.problem.name)); }

BenchmarkRow row_of(const Plan& plan, const std::string& set) {
  CheckerSettings checking;
  checking.resolution = plan.settings.resolution;
  checking.constraints = plan.problem.constraints;
  BenchmarkRow row = unwrap(run_interruptible([&] {
    return CollisionChecker::make(plan.problem.robot, plan.problem.scene, checking)
        .map([&](const CollisionChecker& checker) {
          return make_row(plan.problem, plan.settings, plan.result, checker);
        });
  }));
  row.set = set;
  return row;
}

void bind_answer(py::class_<Plan>& type) {
  const auto plan_of = [](const Plan& self) -> const PlanResult& { return self.result.plan; };
  type.def_property_readonly("problem", [](const Plan& self) { return self.shared; })
      .def_property_readonly(
          "status",
          [](const Plan& self) { return std::string(to_string(self.result.plan.status)); },
          "'solved', 'timeout', 'iteration_limit', 'node_limit', 'cancelled', 'invalid_start' or "
          "'invalid_goal'.")
      .def_property_readonly("is_solved",
                             [](const Plan& self) { return self.result.plan.is_solved(); })
      .def_property_readonly(
          "message", [=](const Plan& self) { return to_text(plan_of(self).message); },
          "The reason why there is no path; empty if solved.")
      .def_property_readonly(
          "path", &path_of,
          "Shape (n, joint_count), float64, radians, read-only; n is 0 unless solved.")
      .def_property_readonly(
          "path_length",
          [=](const Plan& self) { return path_length(self.problem.robot, plan_of(self).path); },
          "Sum of L2 joint distances, radians.")
      .def_property_readonly("primitives", &primitives_of,
                             "For each pair of close obstacles: names, key, gap (metres) and the "
                             "similarity errors (m^2) of the retrieved rows.")
      .def_property_readonly("means", &components_of,
                             "Retrieved components in the scene, shape (k, joint_count), float32.")
      .def_property_readonly(
          "checked_scene",
          [](const Plan& self) { return checked_scene(self.problem, self.result); },
          "A copy of the problem's scene as it was checked. If spheres of a link touch at the "
          "start "
          "or a goal but its exact geometry does not, the exact geometry is checked.")
      .def_property_readonly(
          "notes", [](const Plan& self) { return to_texts(self.result.notes); },
          "Goals that were dropped in favour of others, with reasons.")
      .def_property_readonly(
          "remembered", [](const Plan& self) { return self.result.remembered.is_queued; },
          "True if the path is being stored meanwhile: see remember_after and Database.flush().")
      .def_property_readonly(
          "remember_failure", [](const Plan& self) { return self.result.remembered.failure; },
          "The error that kept the path from being remembered; empty without one.")
      .def_property_readonly(
          "replayed", [](const Plan& self) { return self.result.replay.row; },
          "The row of the database whose path was replayed; 0 if none was.")
      .def_property_readonly(
          "replay",
          [](const Plan& self) { return describe_replay(self.problem, self.result.replay); },
          "Says whether a known task was replayed, and if not, why. Empty if no memory of whole "
          "paths was queried.");
}

void bind_numbers(py::class_<Plan>& type) {
  type.def_property_readonly("total_time_s",
                             [](const Plan& self) { return self.result.total_time_s; })
      .def_property_readonly(
          "preparation_time_s", [](const Plan& self) { return self.result.preparation_time_s; },
          "Time to make the collision checker of a new scene. Outside of the time limit.")
      .def_property_readonly(
          "planning_time_s", [](const Plan& self) { return self.result.planning_time_s; },
          "total_time_s without preparation, simplification and verification.")
      .def_property_readonly("retrieval_time_s",
                             [](const Plan& self) { return self.result.gl.retrieval_time_s; })
      .def_property_readonly("learning_time_s",
                             [](const Plan& self) { return self.result.gl.learning_time_s; })
      .def_property_readonly(
          "simplification_time_s",
          [](const Plan& self) { return self.result.plan.simplification_time_s; })
      .def_property_readonly("verification_time_s",
                             [](const Plan& self) { return self.result.plan.verification_time_s; })
      .def_property_readonly(
          "iterations", [](const Plan& self) { return self.result.plan.iterations; },
          "Number of samples.")
      .def_property_readonly("states_checked",
                             [](const Plan& self) { return self.result.plan.states_checked; })
      .def_property_readonly("motions_checked",
                             [](const Plan& self) { return self.result.plan.motions_checked; })
      .def_property_readonly("planner", [](const Plan& self) { return self.result.planner; })
      .def_property_readonly("sampler", [](const Plan& self) { return self.result.sampler; })
      .def_property_readonly("seed", [](const Plan& self) { return self.result.seed; })
      .def_property_readonly(
          "isa", [](const Plan& self) { return std::string(to_string(self.result.isa)); });
}

std::string trajectory_help() {
  return "Returns the time-optimal motion along the path with rounded corners, sampled every dt "
         "seconds.\n\nlimits: a YAML file of velocity and acceleration limits, as MoveIt's\n"
         "joint_limits.yaml. Default: the limits of the URDF.\n"
         "What plan(trajectory=) announced is the default of each keyword.\n\n" +
         describe_keywords<TrajectorySettings>();
}

void bind_trajectory(py::module_& module) {
  using Point = Trajectory::Point;
  py::class_<TimedPlan> type(
      module, "Trajectory",
      "A sampled motion of n points, from rest to rest. Continuous joints do not wrap.");
  refuse_pickling(type, "send its times, positions and velocities, or its to_json()");
  type.def_property_readonly(
          "duration", [](const TimedPlan& self) { return self.points.back().time_s; }, "Seconds.")
      .def_property_readonly("times", &times_of, "Shape (n,), seconds; the last is the duration.")
      .def_property_readonly(
          "positions", [](const TimedPlan& self) { return rows_of(self, &Point::position); },
          "Shape (n, joint_count), radians and metres.")
      .def_property_readonly(
          "velocities", [](const TimedPlan& self) { return rows_of(self, &Point::velocity); },
          "Shape (n, joint_count), per second.")
      .def_property_readonly(
          "accelerations",
          [](const TimedPlan& self) { return rows_of(self, &Point::acceleration); },
          "Shape (n, joint_count), per second squared; from each time on.")
      .def_property_readonly("stages", &begins_of,
                             "Of a task: a dict per stage, name and begin_s. Otherwise empty.")
      .def_property_readonly(
          "is_of_box", [](const TimedPlan& self) { return self.is_of_box; },
          "From CellMotions: True for the box's motion, bent; False where the answer's own path\n"
          "was timed. None for other motions.")
      .def(
          "to_csv",
          [](const TimedPlan& self) { return to_csv(self.robot, self.points, self.stages); },
          "Returns the text of `mneme plan --trajectory FILE.csv`.")
      .def(
          "to_yaml",
          [](const TimedPlan& self) { return to_yaml(self.robot, self.points, self.stages); },
          "Returns the text of FILE.yaml, in the form of trajectory_msgs/JointTrajectory.")
      .def(
          "to_json",
          [](const TimedPlan& self) { return to_json(self.robot, self.points, self.stages); },
          "Returns the text of FILE.json.")
      .def("__repr__", [](const TimedPlan& self) {
        return fmt::format("<mneme.Trajectory: {:.3f} s, {} points>", self.points.back().time_s,
                           self.points.size());
      });
}

std::string plan_help() {
  return "Solves a problem; with a database, from memory. Control-C ends it.\n\n"
         "planner: one of planner_names().\n"
         "sampler: one of sampler_names(). Default: 'gl' with a database, 'uniform' without.\n"
         "isa: instruction set of the kernels.\n"
         "memory: str = 'auto', or 'off', or 'paper': all settings as in the paper.\n"
         "trajectory: a dict of keywords of Plan.trajectory(), which become its defaults: the path "
         "is\n    the fastest within these limits, not the shortest.\n"
         "record: keep samples and edges for view(). Costs a little time.\n\n" +
         describe_keywords<SolveSettings>() + describe_keywords<PlanSettings>() +
         describe_memory_keywords() + describe_keywords<LearnSettings>() +
         describe_keywords<IkSettings>();
}

}  // namespace

void bind_pipeline(py::module_& module) {
  bind_trajectory(module);
  py::class_<Plan> type(module, "Plan", "The result of plan(). Times in seconds.");
  bind_answer(type);
  bind_numbers(type);
  refuse_pickling(type, "send its path, which is an array, or its to_json()");
  type.def("trajectory", &time_plan, py::arg("dt") = py::none(), py::kw_only(),
           py::arg("limits") = py::none(), trajectory_help().c_str())
      .def(
          "to_json",
          [](const Plan& self) {
            const PathMeasures measures = run_interruptible([&] {
              return measure_path(self.problem.robot, checked_scene(self.problem, self.result),
                                  self.result.plan.path);
            });
            return to_json(self.problem, self.result, 0, &measures);
          },
          "Returns the JSON that `mneme plan --json` prints.")
      .def("to_svg", &svg_of, "Returns a picture of a planar robot's plan as SVG.")
      .def("to_trace", &trace_of,
           "Returns the plan as geometry: JSON for `mneme view` (docs/file_formats.md).")
      .def("to_page", &page_of, "Returns an HTML page that shows the plan without a network.")
      .def("_check_output",
           [](const Plan& self, const std::string& path) {
             check_output(path, {&self.shared, 1}, self.memory_files, "a file of the problem");
           })
      .def("to_row", &row_of, py::arg("set") = "",
           "Returns the row of a benchmark. Independent code checks the path again.")
      .def("__repr__", [](const Plan& self) {
        return fmt::format("<mneme.Plan '{}': {}, {} configurations, {:.3f} ms>", self.problem.name,
                           to_string(self.result.plan.status), self.result.plan.path.size(),
                           1e3 * self.result.planning_time_s);
      });
  module.def("plan", &plan, py::arg("problem"), py::arg("database") = py::none(), py::kw_only(),
             py::arg("planner") = "rrt_connect", py::arg("sampler") = py::none(),
             py::arg("isa") = "automatic", py::arg("record") = false,
             py::arg("trajectory") = py::none(), plan_help().c_str());
}

}  // namespace mneme::python

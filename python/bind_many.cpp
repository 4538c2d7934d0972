// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/pipeline.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "memory.h"
#include "pickling.h"
#include "problem.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

namespace mneme::python {
namespace {

/// The result of plan_many(), in columns.
struct Plans {
  std::vector<Result<TimedSolution>> solutions;
  int joint_count = 0;

  [[nodiscard]] const SolveResult* find(std::size_t i) const {
    return solutions[i] ? &solutions[i]->result : nullptr;
  }
};

/// A column with a number per problem; problems with an error have `missing`.
template <class T, class ValueOf>
py::array_t<T> column(const Plans& plans, T missing, const ValueOf& value_of) {
  py::array_t<T> array(static_cast<py::ssize_t>(plans.solutions.size()));
  for (std::size_t i = 0; i < plans.solutions.size(); ++i) {
    const SolveResult* result = plans.find(i);
    array.mutable_data()[i] = result == nullptr ? missing : static_cast<T>(value_of(*result));
  }
  return read_only(std::move(array));
}

py::array_t<double> seconds(const Plans& plans, double SolveResult::*time) {
  return column(plans, 0.0, [=](const SolveResult& result) { return result.*time; });
}

/// Rows of all problems below each other; those of problem i are offsets[i] to offsets[i + 1].
template <class RowsOf>
py::array_t<std::int64_t> offsets(const Plans& plans, const RowsOf& rows_of) {
  py::array_t<std::int64_t> array(static_cast<py::ssize_t>(plans.solutions.size() + 1));
  std::int64_t end = 0;
  array.mutable_data()[0] = 0;
  for (std::size_t i = 0; i < plans.solutions.size(); ++i) {
    if (plans.solutions[i]) end += std::ssize(rows_of(*plans.solutions[i]));
    array.mutable_data()[i + 1] = end;
  }
  return read_only(std::move(array));
}

/// `rows_of` has the rows of a solution, `row_of` the numbers of each.
template <class RowsOf, class RowOf>
py::array_t<double> rows(const Plans& plans, const RowsOf& rows_of, const RowOf& row_of) {
  py::ssize_t count = 0;
  for (const auto& solution : plans.solutions)
    count += solution ? std::ssize(rows_of(*solution)) : 0;
  py::array_t<double> array({count, py::ssize_t{plans.joint_count}});
  double* data = array.mutable_data();
  for (const auto& solution : plans.solutions) {
    if (!solution) continue;
    for (const auto& row : rows_of(*solution)) data = std::ranges::copy(row_of(row), data).out;
  }
  return read_only(std::move(array));
}

const Path& waypoints_of(const TimedSolution& solution) { return solution.result.plan.path; }
const std::vector<Trajectory::Point>& points_of(const TimedSolution& solution) {
  return solution.trajectory;
}

py::array_t<double> point_rows(const Plans& plans,
                               std::vector<double> Trajectory::Point::*quantity) {
  return rows(plans, points_of, [=](const Trajectory::Point& p) -> const std::vector<double>& {
    return p.*quantity;
  });
}

py::array_t<double> point_times(const Plans& plans) {
  std::vector<double> times;
  for (const auto& solution : plans.solutions) {
    if (!solution) continue;
    for (const Trajectory::Point& point : solution->trajectory) times.push_back(point.time_s);
  }
  return read_only(to_array(times));
}

std::vector<std::string> statuses(const Plans& plans) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < plans.solutions.size(); ++i) {
    const SolveResult* result = plans.find(i);
    texts.emplace_back(result == nullptr ? "error" : to_string(result->plan.status));
  }
  return texts;
}

py::list messages(const Plans& plans) {
  py::list texts;
  for (const auto& solution : plans.solutions) {
    texts.append(to_text(solution ? solution->result.plan.message : solution.error().message));
  }
  return texts;
}

py::dict columns(const py::object& self) {
  py::dict all;
  for (const char* name :
       {"is_solved", "seeds", "planning_times_s", "total_times_s", "path_offsets", "paths",
        "trajectory_offsets", "times", "positions", "velocities", "accelerations"}) {
    all[name] = self.attr(name);
  }
  all["status"] = py::module_::import("numpy").attr("array")(self.attr("status"));
  return all;
}

Plans plan_all(const std::vector<SharedProblem>& shared, const Memory* memory,
               const std::string& planner, const std::optional<std::string>& sampler,
               const std::string& isa, int jobs, const py::object& dt, py::kwargs arguments) {
  if (jobs < 0) raise_invalid(fmt::format("plan_many: jobs={} is out of range: 0 or more", jobs));
  ManySettings settings;
  settings.jobs = jobs;
  const std::size_t given = arguments.size();
  if (!dt.is_none()) arguments["dt"] = dt;
  const auto timing = take_keywords<TrajectorySettings>("plan_many", arguments);
  if (!dt.is_none()) {
    settings.timing = timing;
  } else if (arguments.size() < given) {
    raise_invalid("plan_many: settings of trajectories have no effect without dt: give a dt in s");
  }
  settings.solve = read_solve_settings(
      "plan_many", planner, sampler.value_or(memory == nullptr ? "uniform" : "gl"), isa, arguments);
  if (memory == nullptr) check_without_memory("plan_many", settings.solve);
  std::vector<Problem> problems;
  for (const SharedProblem& problem : shared) problems.push_back(problem.get());
  Plans plans;
  if (!problems.empty()) plans.joint_count = problems.front().robot.joint_count();
  for (const Problem& problem : problems) {
    if (problem.robot.joint_count() != plans.joint_count) {
      raise_invalid("plan_many: expected problems with the same number of joints");
    }
  }
  const std::shared_ptr<Database> database = memory == nullptr ? nullptr : memory->get();
  std::atomic<bool> cancel = false;
  settings.solve.plan.cancel = &cancel;
  plans.solutions = unwrap(
      run_interruptible(cancel, [&] { return plan_many(problems, database.get(), settings); }));
  return plans;
}

constexpr const char* kPlanManyHelp =
    "Solves many problems on all cores, each as plan() would alone: results do not depend on "
    "jobs. Control-C ends it.\n\n"
    "problems: Problem objects of robots with the same number of joints.\n"
    "jobs: threads; 0: one per core.\n"
    "dt: also time each path and sample its trajectory every dt seconds, within the limits of the "
    "URDF; then the keywords of Plan.trajectory() are allowed, too.\n"
    "settings: keywords of plan(). Not allowed: learn_budget, remember_after, record.";

void bind_columns(py::class_<Plans>& type) {
  type.def("__len__", [](const Plans& self) { return self.solutions.size(); })
      .def_property_readonly("status", &statuses,
                             "Per problem, as Plan.status; 'error' if it could not be planned.")
      .def_property_readonly("messages", &messages, "Why there is no path; empty if solved.")
      .def_property_readonly(
          "is_solved",
          [](const Plans& self) {
            return column(self, false, [](const SolveResult& r) { return r.plan.is_solved(); });
          })
      .def_property_readonly("seeds",
                             [](const Plans& self) {
                               return column<std::uint64_t>(
                                   self, 0, [](const SolveResult& r) { return r.seed; });
                             })
      .def_property_readonly(
          "planning_times_s",
          [](const Plans& self) { return seconds(self, &SolveResult::planning_time_s); })
      .def_property_readonly(
          "total_times_s",
          [](const Plans& self) { return seconds(self, &SolveResult::total_time_s); })
      .def_property_readonly("path_offsets",
                             [](const Plans& self) { return offsets(self, waypoints_of); })
      .def_property_readonly(
          "paths",
          [](const Plans& self) {
            return rows(self, waypoints_of,
                        [](const Configuration& q) -> const Configuration& { return q; });
          },
          "Shape (m, joint_count), radians.")
      .def_property_readonly("trajectory_offsets",
                             [](const Plans& self) { return offsets(self, points_of); })
      .def_property_readonly("times", &point_times, "Shape (k,), seconds from each start.")
      .def_property_readonly(
          "positions",
          [](const Plans& self) { return point_rows(self, &Trajectory::Point::position); },
          "Shape (k, joint_count), as in Trajectory.")
      .def_property_readonly(
          "velocities",
          [](const Plans& self) { return point_rows(self, &Trajectory::Point::velocity); })
      .def_property_readonly(
          "accelerations",
          [](const Plans& self) { return point_rows(self, &Trajectory::Point::acceleration); })
      .def("columns", &columns,
           "Returns all columns as a dict of arrays, for numpy.savez(file, **plans.columns()).")
      .def("__repr__", [](const Plans& self) {
        const auto solved = std::ranges::count_if(self.solutions, [](const auto& solution) {
          return solution && solution->result.plan.is_solved();
        });
        return fmt::format("<mneme.Plans: {} of {} solved>", solved, self.solutions.size());
      });
}

}  // namespace

void bind_many(py::module_& module) {
  py::class_<Plans> type(module, "Plans",
                         "The result of plan_many(), in columns: arrays with an entry per problem. "
                         "Rows of paths and trajectories stand below each other; those of problem "
                         "i are offsets[i] to offsets[i + 1].");
  bind_columns(type);
  refuse_pickling(type, "send its columns(), which are arrays");
  module.def("plan_many", &plan_all, py::arg("problems"), py::arg("database") = py::none(),
             py::kw_only(), py::arg("planner") = "rrt_connect", py::arg("sampler") = py::none(),
             py::arg("isa") = "automatic", py::arg("jobs") = 0, py::arg("dt") = py::none(),
             kPlanManyHelp);
}

}  // namespace mneme::python

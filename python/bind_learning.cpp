// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/learning.h"
#include "mneme/problem.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "memory.h"
#include "problem.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <exception>
#include <thread>

namespace mneme::python {
namespace {

/// The primitives to learn: keys, and a range to cover by further keys.
struct Lesson {
  std::vector<PrimitiveKey> keys;
  std::optional<PrimitiveGrid> grid;
};

/// Calls back into Python. An exception cancels the work and is stored.
class ProgressCallback {
 public:
  ProgressCallback(py::object function, std::atomic<bool>& cancel)
      : function_(std::move(function)), cancel_(cancel) {}

  void operator()(const LearnProgress& progress) {
    const py::gil_scoped_acquire acquired;
    if (raised_) return;
    try {
      function_(progress);
    } catch (py::error_already_set&) {
      raised_ = std::current_exception();
      cancel_ = true;
    }
  }
  void rethrow() {
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
  }

 private:
  py::object function_;
  std::atomic<bool>& cancel_;
  std::exception_ptr raised_;
};

void add_primitives(const py::object& primitives, const std::optional<int>& count, Lesson& lesson) {
  const bool is_path = py::isinstance<py::str>(primitives) || py::hasattr(primitives, "__fspath__");
  if (is_path) {
    lesson.grid = unwrap(load_grid(primitives.cast<std::filesystem::path>().string()));
    lesson.grid->count = count.value_or(lesson.grid->count);
    return;
  }
  for (const Configuration& circles : to_rows(primitives, 6, "primitives")) {
    lesson.keys.push_back(make_primitive(circles).key);
  }
}

void check_robot(const char* argument, const SharedProblem& problem, const Robot& robot) {
  if (problem.rest().robot.hash() == robot.hash()) return;
  raise_invalid(fmt::format("{}: the robot of problem '{}' differs from robot '{}'", argument,
                            problem.rest().name, robot.name()));
}

void add_scenes(const py::iterable& scenes, const Robot& robot, const MemorySettings& settings,
                Lesson& lesson) {
  for (const py::handle item : scenes) {
    const bool is_problem = py::isinstance<SharedProblem>(item);
    if (!is_problem && !py::isinstance<Scene>(item)) {
      throw py::type_error("scenes: expected mneme.Scene or mneme.Problem objects, got " +
                           shown(item));
    }
    if (is_problem) check_robot("scenes", item.cast<const SharedProblem&>(), robot);
    const Scene& scene =
        is_problem ? *item.cast<const SharedProblem&>().scene() : item.cast<const Scene&>();
    for (LocalPrimitive& primitive : unwrap(decompose({robot, scene}, settings))) {
      const bool is_new =
          std::find(lesson.keys.begin(), lesson.keys.end(), primitive.key) == lesson.keys.end();
      if (is_new) lesson.keys.push_back(std::move(primitive.key));
    }
  }
}

LearnSummary learn(const Robot& robot, const Memory& memory, Lesson lesson, LearnJob job,
                   const py::object& on_progress) {
  const std::shared_ptr<Database> database = memory.get();
  std::atomic<bool> cancel = false;
  ProgressCallback callback(on_progress, cancel);
  if (!on_progress.is_none()) job.on_progress = std::ref(callback);
  job.cancel = &cancel;
  auto summary = run_interruptible(cancel, [&] {
    if (lesson.grid) {
      const std::vector<PrimitiveKey> keys = cover(*lesson.grid, job.seed, &cancel);
      lesson.keys.insert(lesson.keys.end(), keys.begin(), keys.end());
    }
    return learn_primitives(robot, lesson.keys, *database, job);
  });
  callback.rethrow();
  return unwrap(std::move(summary));
}

/// Arguments of learning from problems.
struct PathLesson {
  int paths_per_problem = ProblemLesson{}.paths;
  double timeout_s = ProblemLesson{}.timeout_s;
};

LearnSummary learn_problems(const Robot& robot, const Memory& memory, const py::iterable& given,
                            const PathLesson& each, const LearnRun& run,
                            const MemorySettings& settings, const py::object& on_progress) {
  std::vector<Problem> problems;
  for (const py::handle item : given) {
    if (!py::isinstance<SharedProblem>(item)) {
      throw py::type_error("problems: expected mneme.Problem objects, got " + shown(item));
    }
    check_robot("problems", item.cast<const SharedProblem&>(), robot);
    problems.push_back(item.cast<const SharedProblem&>().get());
  }
  const std::shared_ptr<Database> database = memory.get();
  std::atomic<bool> cancel = false;
  ProgressCallback callback(on_progress, cancel);
  ProblemLesson lesson;
  static_cast<LearnRun&>(lesson) = run;
  lesson.paths = each.paths_per_problem;
  lesson.timeout_s = each.timeout_s;
  lesson.cancel = &cancel;
  if (!on_progress.is_none()) lesson.on_progress = std::ref(callback);
  auto summary = run_interruptible(
      cancel, [&] { return learn_from_problems(problems, settings, *database, lesson); });
  callback.rethrow();
  return unwrap(std::move(summary));
}

LearnSummary learn_with_keywords(const Robot& robot, const Memory& memory,
                                 const py::object& primitives, const py::object& scenes,
                                 const py::object& problems, int paths, double timeout,
                                 const std::optional<int>& count, std::uint64_t seed, int jobs,
                                 const py::object& on_progress, const py::kwargs& arguments) {
  const bool has_keys = !primitives.is_none() || !scenes.is_none();
  if (has_keys != problems.is_none()) {
    throw py::type_error("learn() needs problems, or else primitives or scenes");
  }
  if (paths < 1 || paths > 1000) raise_invalid("paths: expected 1 to 1000");
  // Written so that a NaN is out of range.
  if (!(timeout >= 0 && timeout <= 1e6)) raise_invalid("timeout: expected 0 to 1e6 seconds");
  if (count && *count < 0) raise_invalid("count: expected 0 or more");
  if (jobs < 0 || jobs > 4096) raise_invalid("jobs: expected 1 to 4096, or 0 for all processors");
  LearnJob job;
  MemorySettings wanted;
  Keywords keywords("learn", arguments);
  keywords.apply(job.settings);
  keywords.apply_memory(wanted);
  keywords.finish();
  job.seed = seed;
  job.jobs = jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  if (!problems.is_none()) {
    if (!wanted.kind) wanted.kind = default_kind_of_paths(robot).name;
    return learn_problems(robot, memory, problems, {paths, timeout}, job, wanted, on_progress);
  }
  Lesson lesson;
  if (!scenes.is_none()) add_scenes(scenes, robot, memory.to_learn(wanted), lesson);
  if (!primitives.is_none()) add_primitives(primitives, count, lesson);
  return learn(robot, memory, std::move(lesson), job, on_progress);
}

std::int64_t learn_paths(const Robot& robot, const Memory& memory, const Scene& scene,
                         const py::iterable& paths, double reach, std::uint64_t seed,
                         const py::kwargs& arguments) {
  MemorySettings wanted;
  Keywords keywords("learn_from_paths", arguments);
  keywords.apply_memory(wanted);
  keywords.finish();
  if (!(reach > 0 && reach <= 100)) raise_invalid("reach: expected more than 0, at most 100 m");
  std::vector<Path> rows;
  for (const py::handle path : paths) rows.push_back(to_rows(path, robot.joint_count(), "paths"));
  const std::shared_ptr<Database> database = memory.get();
  unwrap(check_robot(robot.without_attached(), *database));
  wanted = memory.to_learn(wanted);
  auto learned = unwrap(run_interruptible([&, copy = scene] {
    return learn_from_paths({robot, copy}, rows, wanted, reach);
  }));
  for (Experience& row : learned) {
    row.provenance = {fmt::format("mneme {}", version()), "paths from Python", seed, {}};
  }
  std::vector<bool> is_new;
  static_cast<void>(
      unwrap(run_interruptible([&] { return database->insert(std::move(learned), &is_new); })));
  return std::ranges::count(is_new, true);
}

void bind_results(py::module_& module) {
  py::class_<LearnProgress>(module, "LearnProgress", "The progress of learning.")
      .def_readonly("done", &LearnProgress::done, "Requested primitives that are in the database.")
      .def_readonly("total", &LearnProgress::total)
      .def_readonly("components", &LearnProgress::components)
      .def_readonly("elapsed_s", &LearnProgress::elapsed_s);
  py::class_<LearnSummary>(module, "LearnSummary", "The result of learning.")
      .def_readonly("learned", &LearnSummary::learned, "Newly learned primitives.")
      .def_readonly("skipped", &LearnSummary::skipped,
                    "Already in the database with the same seed and settings.")
      .def_readonly("unsolved", &LearnSummary::unsolved, "Problems without a path, with reasons.")
      .def_readonly("rows", &LearnSummary::rows, "Rows added to the database.")
      .def_readonly("empty", &LearnSummary::empty,
                    "Learned primitives without any free configuration between the obstacles.")
      .def_readonly("components", &LearnSummary::components)
      .def_readonly("time_s", &LearnSummary::time_s)
      .def("__repr__", [](const LearnSummary& self) {
        return fmt::format("<mneme.LearnSummary: {} learned, {} skipped, {} components>",
                           self.learned, self.skipped, self.components);
      });
}

}  // namespace

void bind_learning(py::module_& module) {
  bind_results(module);
  module.def(
      "learn", &learn_with_keywords, py::arg("robot"), py::arg("database"), py::kw_only(),
      py::arg("primitives") = py::none(), py::arg("scenes") = py::none(),
      py::arg("problems") = py::none(), py::arg("paths") = ProblemLesson{}.paths,
      py::arg("timeout") = ProblemLesson{}.timeout_s, py::arg("count") = py::none(),
      py::arg("seed") = 1, py::arg("jobs") = 0, py::arg("on_progress") = py::none(),
      ("Learns local samplers into a database. Resumable, also after Control-C.\n\n"
       "primitives: planar arms only; a YAML file with a range to cover, or pairs of circles,\n"
       "shape (n, 6).\n"
       "scenes: planar arms only; scenes or problems whose primitives are learned.\n"
       "problems: any robot; problems that are solved `paths` times each; hard ones teach most.\n"
       "timeout: seconds per path.\n"
       "count: least number of primitives. Default: from the range.\n"
       "jobs: number of threads. 0: all processors. Does not change the result.\n"
       "on_progress: called with a LearnProgress about once a second. Its exceptions end "
       "learn().\n\n" +
       describe_keywords<LearnSettings>() + describe_memory_keywords())
          .c_str());
  module.def("learn_from_paths", &learn_paths, py::arg("robot"), py::arg("database"),
             py::arg("scene"), py::arg("paths"), py::kw_only(), py::arg("reach") = 0.12,
             py::arg("seed") = 0,
             ("Learns from solved paths, each of shape (n, joint_count): for each pair of close\n"
              "obstacles, the waypoints at which the robot is within reach, metres, of both.\n"
              "Returns the number of added rows.\n\n" +
              describe_memory_keywords())
                 .c_str());
}

}  // namespace mneme::python

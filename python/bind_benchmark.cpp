// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "bindings.h"
#include "interruptible.h"
#include "keywords.h"
#include "memory.h"
#include "origins.h"
#include "problem.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

namespace mneme::python {
namespace {

/// The runs of a benchmark.
struct Runs {
  std::vector<std::string> planners;
  std::vector<std::string> samplers;
  int seed_count = 1;
  std::uint64_t first_seed = 1;
};

BenchPlan make_bench_plan(const std::vector<SharedProblem>& problems, const Memory* memory,
                          const Runs& runs, const SolveSettings& settings) {
  BenchPlan plan;
  for (const SharedProblem& problem : problems) {
    plan.problems.push_back({"", problem.get()});
    if (memory != nullptr) plan.memories[{"", problem.rest().robot.hash()}] = memory->get();
  }
  BenchCase base;
  base.settings = settings;
  base.description = describe_settings(settings);
  append_cases(base, runs.planners, runs.samplers, plan.cases);
  plan.seed_count = runs.seed_count;
  plan.first_seed = runs.first_seed;
  plan.alternates = false;
  return plan;
}

/// Only solving runs in another thread, so that the caller's thread calls `on_row`.
void bench(const std::vector<SharedProblem>& problems, const Memory* memory, const Runs& runs,
           const SolveSettings& settings, const py::function& on_row) {
  if (std::ranges::none_of(runs.samplers, needs_memory)) {
    check_without_memory(memory == nullptr ? "bench" : "bench with samplers that use no database",
                         settings);
  }
  BenchPlan plan = make_bench_plan(problems, memory, runs, settings);
  std::atomic<bool> cancel = false;
  plan.cancel = &cancel;
  plan.solve = [&](const Problem& problem, Database* database, const BenchCase& bench_case) {
    return run_interruptible(cancel, [&] { return solve(problem, database, bench_case.settings); });
  };
  const auto take = [&](const BenchmarkRow& row, const SolveResult&) -> Result<void> {
    on_row(row);
    return {};
  };
  static_cast<void>(unwrap(run_bench(plan, {}, take)));
}

void bind_rows(py::module_& module) {
  py::class_<BenchmarkRow>(module, "BenchmarkRow", "One run of a benchmark.")
      .def_readonly("problem", &BenchmarkRow::problem)
      .def_readonly("set", &BenchmarkRow::set)
      .def_readonly("planner", &BenchmarkRow::planner)
      .def_readonly("sampler", &BenchmarkRow::sampler)
      .def_readonly("seed", &BenchmarkRow::seed)
      .def_property_readonly(
          "status", [](const BenchmarkRow& self) { return std::string(to_string(self.status)); })
      .def_readonly("is_solved", &BenchmarkRow::is_solved, "Result of the planner.")
      .def_readonly(
          "is_path_valid", &BenchmarkRow::is_path_valid,
          "Result of an independent check with exact distances at ten times the resolution.")
      .def_readonly("planning_time_s", &BenchmarkRow::planning_time_s,
                    "Seconds; the time limit if there is no path.")
      .def_readonly("total_time_s", &BenchmarkRow::total_time_s)
      .def_readonly("iterations", &BenchmarkRow::iterations)
      .def_readonly("states_checked", &BenchmarkRow::states_checked)
      .def_readonly("path_length", &BenchmarkRow::path_length, "Radians.")
      .def_readonly("duration_s", &BenchmarkRow::duration_s,
                    "Duration of the path's trajectory within the robot's own limits, seconds.")
      .def_readonly("components", &BenchmarkRow::components);
  module.def("_to_table", [](const std::vector<BenchmarkRow>& rows) {
    return to_table(std::span<const BenchmarkRow>(rows));
  });
  module.def("_csv_header", &csv_header);
  module.def("_to_csv_line", &to_csv_line);
}

}  // namespace

void bind_benchmark(py::module_& module) {
  bind_rows(module);
  module.def(
      "_bench",
      [](const std::vector<SharedProblem>& problems, const Memory* memory,
         const std::vector<std::string>& planners, const std::vector<std::string>& samplers,
         int seeds, std::uint64_t seed, const py::function& on_row, const std::string& isa,
         const py::kwargs& arguments) {
        bench(problems, memory, {planners, samplers, seeds, seed},
              read_solve_settings("bench", planners.front(), samplers.front(), isa, arguments),
              on_row);
      },
      py::arg("problems"), py::arg("database"), py::arg("planners"), py::arg("samplers"),
      py::arg("seeds"), py::arg("seed"), py::arg("on_row"), py::kw_only(),
      py::arg("isa") = "automatic");
  module.def("_check_output", [](const std::string& path,
                                 const std::vector<SharedProblem>& problems, const Memory* memory) {
    check_output(path, problems,
                 memory == nullptr ? std::vector<ReadFile>() : origin_of(memory->get()),
                 "a file of a problem");
  });
  module.def("planner_names", &planner_names,
             "Returns the names of all planners. Planners of OMPL begin with 'ompl:'.");
  module.def("sampler_names", &sampler_names, "Returns the names of all samplers.");
  module.def("_needs_memory", &needs_memory);
}

}  // namespace mneme::python

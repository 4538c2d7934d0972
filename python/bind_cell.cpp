// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/cell.h"
#include "mneme/cell_motion.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "timed_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace mneme::python {
namespace {

std::size_t start_of(const CellRegion& region, const std::string& name) {
  std::vector<std::string> names;
  for (const CellStart& start : region.starts) names.push_back(start.name);
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  raise_invalid(fmt::format("start: expected one of {}, got '{}'", fmt::join(names, ", "), name));
}

CellTask to_task(const py::object& task) {
  const std::vector<double> values = to_vector(task, static_cast<int>(kTaskSize), "task");
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (std::isfinite(values[k])) continue;
    raise_invalid(
        fmt::format("task: {} is {}, expected a finite number", kTaskNames[k], values[k]));
  }
  CellTask result;
  std::ranges::copy(values, result.begin());
  return result;
}

Cell build(const std::filesystem::path& path, const py::kwargs& arguments) {
  auto settings = read_keywords<CellSettings>("Cell.build", arguments);
  std::atomic<bool> cancel = false;
  settings.cancel = &cancel;
  return unwrap(run_interruptible(cancel, [&]() -> Result<Cell> {
    return load_region(path.string()).and_then([&](const CellRegion& region) {
      return build_cell(region, settings);
    });
  }));
}

py::dict to_dict(const CellCoverage& coverage) {
  py::dict gaps;
  for (int i = 0; i < kCellGaps; ++i) {
    const double share = coverage.gaps[static_cast<std::size_t>(i)];
    if (share > 0) gaps[to_text(to_string(static_cast<CellGap>(i)))] = share;
  }
  py::dict result;
  result["proven"] = coverage.proven;
  result["unproven"] = gaps;
  result["samples"] = coverage.samples;
  return result;
}

py::dict coverage_of(const Cell& cell, const std::string& start, int samples) {
  if (samples < 1) raise_invalid(fmt::format("samples: expected at least 1, got {}", samples));
  const std::size_t index = start_of(cell.region(), start);
  return to_dict(run_interruptible(
      [&, copy = cell] { return copy.coverage(index, samples); }));  // verify() may edit the cell
}

py::dict verify(Cell& cell, int samples, std::uint64_t seed, int threads) {
  if (samples < 0) raise_invalid(fmt::format("samples: expected 0 or more, got {}", samples));
  if (threads < 1) raise_invalid(fmt::format("threads: expected at least 1, got {}", threads));
  // Other threads may ask the cell meanwhile.
  Cell proven = cell;
  const CellVerification done =
      run_interruptible([&] { return proven.verify(samples, seed, threads); });
  cell = std::move(proven);
  py::dict result;
  result["boxes"] = done.checked;
  result["proven"] = done.proven;
  result["kept"] = done.kept;
  result["paths"] = done.paths;
  result["in_contact"] = done.in_contact;
  return result;
}

struct BoundAnswer : CellAnswer {
  int joint_count = 0;
};

BoundAnswer ask(const Cell& cell, const py::object& task, const std::string& start,
                double timeout) {
  constexpr double kLongest_s = 1e6;
  const CellTask offsets = to_task(task);
  const std::size_t index = start_of(cell.region(), start);
  // A NaN is out of range, too.
  if (!(timeout >= 0 && timeout <= kLongest_s)) {
    raise_invalid(fmt::format("timeout: expected 0 to 1e6 seconds, got {}", timeout));
  }
  const Cell asked = cell;  // verify() may replace what it holds
  const int joints = asked.region().problem.robot.joint_count();
  CellAnswer known;
  asked.look_up(offsets, known, index);
  // Another thread would take longer than the answer.
  if (known.tier == CellTier::certified) return {asked.ask(offsets, index, 0), joints};
  std::atomic<bool> cancel = false;
  return {run_interruptible(cancel, [&] { return asked.ask(offsets, index, timeout, &cancel); }),
          joints};
}

/// Motions of a cell's answers, and the robot that moves.
struct BoundMotions {
  Robot robot;
  CellMotions motions;

  explicit BoundMotions(const Cell& cell) : robot(cell.region().problem.robot), motions(cell) {}
};

TimedPlan time_answer(const BoundMotions& self, const BoundAnswer& answer, const py::object& dt,
                      const py::object& limits, const py::kwargs& arguments) {
  const TrajectorySettings timing =
      read_trajectory_settings("CellMotions.trajectory", dt, arguments);
  const RateLimits rates = find_limits(self.robot, timing, limits);
  bool is_of_box = false;
  auto points = run_interruptible([&] {
    return self.motions.time(answer, rates, timing).and_then([&](const CellMotion& timed) {
      is_of_box = timed.is_of_box;
      return timed.motion.sample(timing.dt);
    });
  });
  return {self.robot, unwrap(std::move(points)), {}, is_of_box};
}

void bind_motions(py::module_& module) {
  py::class_<BoundMotions>(module, "CellMotions",
                           "Times answers of a cell, as it is when this is made.")
      .def(py::init<const Cell&>(), py::arg("cell"))
      .def(
          "trajectory", &time_answer, py::arg("answer"), py::arg("dt") = py::none(),
          py::arg("limits") = py::none(),
          ("Returns the motion of an answer, sampled every dt seconds, as Plan.trajectory() does.\n"
           "A box is timed with its first certified answer; later ones bend its motion, and all\n"
           "take equally long. is_of_box is False where the answer's own path was timed. Keeps\n"
           "boxes for the last four limits.\n\n" +
           describe_keywords<TrajectorySettings>())
              .c_str());
}

void bind_answer(py::module_& module) {
  py::class_<BoundAnswer>(module, "CellAnswer", "The path of a task.")
      .def_property_readonly(
          "tier", [](const BoundAnswer& self) { return to_text(to_string(self.tier)); },
          "\"certified\": proven beforehand. \"verified\": a path of the cell, bent and verified\n"
          "now. \"planned\": a new plan. \"none\": no path.")
      .def_readonly("box", &BoundAnswer::box, "Index of the box whose path it is, or -1.")
      .def_property_readonly(
          "path", [](const BoundAnswer& self) { return to_array(self.path, self.joint_count); },
          "Waypoints, shape (n, joint_count).")
      .def_property_readonly(
          "message", [](const BoundAnswer& self) { return to_text(self.note); },
          "Why there is no path.");
}

}  // namespace

void bind_cell(py::module_& module) {
  bind_answer(module);
  bind_motions(module);
  py::class_<Cell>(module, "Cell", "Tasks of a region with motions that are proven beforehand.")
      .def_static("build", &build, py::arg("region"),
                  ("Builds the cell of a region file (docs/cells.md).\n\n" +
                   describe_keywords<CellSettings>())
                      .c_str())
      .def_static(
          "load",
          [](const std::filesystem::path& path, const std::filesystem::path& region) {
            return unwrap(
                run_interruptible([&] { return load_cell(path.string(), region.string()); }));
          },
          py::arg("path"), py::arg("region") = "",
          "Reads a cell, and its region's file: `region`, or the one that it was built from.")
      .def("ask", &ask, py::arg("task"), py::arg("start") = "start", py::arg("timeout") = 1.0,
           "Returns the path of a task: offsets x, y, z, yaw from the region's middle. Bends near\n"
           "paths where nothing is proven, then plans for at most `timeout` seconds.")
      .def("coverage", &coverage_of, py::arg("start") = "start", py::arg("samples") = 10000,
           "Returns shares of the region, by samples: what is proven, and why the rest is not.")
      .def("verify", &verify, py::arg("samples") = 1000, py::arg("seed") = 1,
           py::arg("threads") = 1,
           "Proves all boxes again, and checks `samples` paths by exact distances.")
      .def(
          "save",
          [](const Cell& self, const std::filesystem::path& path) {
            unwrap(self.save(path.string()));
          },
          py::arg("path"), "Writes a file for load(). A file that is no cell is not replaced.")
      .def_property_readonly("box_count", &Cell::box_count)
      .def_property_readonly("proven_count", &Cell::proven_count,
                             "Boxes that are proven for the present scene.")
      .def_property_readonly("is_of_this_world", &Cell::is_of_this_world,
                             "False after a change of robot, scene or allowed contacts: then\n"
                             "boxes are hints until verify().")
      .def_property_readonly("margin", &Cell::margin, "Metres.")
      .def("__repr__", [](const Cell& self) {
        return fmt::format("<mneme.Cell of {} boxes, {} proven>", self.box_count(),
                           self.proven_count());
      });
}

}  // namespace mneme::python

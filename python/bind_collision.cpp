// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/collision.h"
#include "mneme/report.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "pickling.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

namespace mneme::python {
namespace {

constexpr std::size_t kBatch = 4096;  // configurations between looks at the cancel flag

CollisionChecker make(const Robot& robot, const Scene& scene, std::optional<double> resolution,
                      double margin, const std::string& isa) {
  if (resolution && !(*resolution >= 1e-4 && *resolution <= 10)) {
    raise_invalid("resolution: expected 1e-4 to 10 radians, or None for the robot's default");
  }
  if (!(margin >= 0 && margin <= 10)) raise_invalid("margin: expected 0 to 10 metres");
  const CheckerSettings settings{resolution, margin, unwrap(parse_isa(isa))};
  // A copy, because other threads may edit the scene meanwhile.
  return unwrap(run_interruptible(
      [&, copy = scene] { return CollisionChecker::make(robot, copy, settings); }));
}

py::object is_valid(const CollisionChecker& checker, const py::object& q) {
  const int joint_count = checker.robot().joint_count();
  const Array array = to_numbers(q, "q");
  if (array.ndim() == 1) {
    return py::bool_(checker.is_valid(std::span<const double>(to_vector(array, joint_count, "q"))));
  }
  const Array rows = to_matrix(array, joint_count, "q");
  const double* const values = rows.data();
  const auto count = static_cast<std::size_t>(rows.shape(0));
  const auto joints = static_cast<std::size_t>(joint_count);
  std::vector<std::uint8_t> answers(count);
  std::atomic<bool> cancel = false;
  run_interruptible(cancel, [&] {
    std::vector<float> batch;
    for (std::size_t first = 0; first < count && !cancel; first += kBatch) {
      const std::size_t size = std::min(kBatch, count - first);
      batch.assign(values + first * joints, values + (first + size) * joints);
      checker.check_states(batch, std::span(answers).subspan(first, size));
    }
    return true;
  });
  py::array_t<bool> result(static_cast<py::ssize_t>(answers.size()));
  std::copy(answers.begin(), answers.end(), result.mutable_data());
  return result;
}

bool is_motion_valid(const CollisionChecker& checker, const py::object& from,
                     const py::object& to) {
  const int joint_count = checker.robot().joint_count();
  const Configuration start = to_vector(from, joint_count, "start");
  const Configuration end = to_vector(to, joint_count, "end");
  const py::gil_scoped_release released;
  return checker.is_motion_valid(std::span<const double>(start), std::span<const double>(end));
}

py::list contacts(const CollisionChecker& checker, const py::object& q) {
  const Configuration values = to_vector(q, checker.robot().joint_count(), "q");
  if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
    raise_invalid("q: expected finite numbers");
  }
  py::list found;
  for (const Contact& contact : checker.contacts(values)) {
    py::dict row;
    row["link"] = contact.link;
    row["other"] = contact.other;
    row["is_self"] = contact.is_self;
    row["distance"] = contact.distance;
    row["may_be_deeper"] = contact.may_be_deeper;
    found.append(row);
  }
  return found;
}

bool path_is_free(const CollisionChecker& checker, const py::object& path,
                  std::optional<double> resolution, double start_tolerance, double allow_at_ends) {
  if (resolution && !(*resolution >= 1e-5 && *resolution <= 10)) {
    raise_invalid("resolution: expected 1e-5 to 10 radians, or None for a tenth of the checker's");
  }
  const Path rows = to_rows(path, checker.robot().joint_count(), "path");
  const double step = resolution.value_or(checker.resolution() / kVerificationRefinement);
  SolveSettings settings;
  settings.start_tolerance = start_tolerance;
  settings.allow_at_ends = allow_at_ends;
  const EndTolerances tolerances = end_tolerances(settings);
  return run_interruptible(
      [&] { return is_path_free(checker.robot(), checker.scene(), rows, step, tolerances); });
}

}  // namespace

void bind_collision(py::module_& module) {
  py::class_<CollisionChecker> checker(
      module, "CollisionChecker",
      "Checks configurations and straight motions for contact. Does not check joint limits: see\n"
      "Robot.describe_violation.");
  refuse_pickling(checker, "make it in each process, of a robot that was loaded there");
  checker
      .def(py::init(&make), py::arg("robot"), py::arg("scene"), py::kw_only(),
           py::arg("resolution") = py::none(), py::arg("margin") = 0.0,
           py::arg("isa") = "automatic",
           "resolution: largest L2 joint distance between checked states of a motion, radians.\n"
           "Default: the robot's. margin: the robot is inflated by this many metres.")
      .def_property_readonly("resolution", &CollisionChecker::resolution)
      .def_property_readonly("margin", &CollisionChecker::margin)
      .def_property_readonly(
          "isa", [](const CollisionChecker& self) { return std::string(to_string(self.isa())); })
      .def("is_valid", &is_valid, py::arg("q"),
           "Returns True if q, shape (joint_count,), is free of contact; joint limits are not\n"
           "checked. For rows of shape (n, joint_count): an array of n booleans.")
      .def("is_motion_valid", &is_motion_valid, py::arg("start"), py::arg("end"),
           "Returns True if the straight motion from start to end is free of contact. start and "
           "joint\n"
           "limits are not checked.")
      .def("contacts", &contacts, py::arg("q"),
           "Returns all contacts at q: dictionaries with link, other, is_self, distance (metres,\n"
           "negative in contact) and may_be_deeper: depth ends at the center of a sphere of the\n"
           "robot, or at the axis of a capsule.")
      .def(
          "is_path_free", &path_is_free, py::arg("path"), py::arg("resolution") = py::none(),
          py::kw_only(), py::arg("start_tolerance") = SolveSettings().start_tolerance,
          py::arg("allow_at_ends") = SolveSettings().allow_at_ends,
          "Returns True if every state of path, shape (n, joint_count), is within limits and "
          "free.\n"
          "Uses exact distances that share no code with the kernels. resolution: radians.\n"
          "Default: a tenth of the checker's. The path's first and last motion may do what plan()\n"
          "allows with the same start_tolerance and allow_at_ends. For the path of a plan, make "
          "the\n"
          "checker of plan.checked_scene: where only spheres touch at an end, plan() goes on with\n"
          "exact geometry.");
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/line.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <optional>
#include <string>
#include <utility>

namespace mneme::python {
namespace {

/// A PoseGoal without a quaternion leaves the rotation open.
bool is_position(const PoseGoal& pose) { return pose.turn > 0; }

void take_link(const PoseGoal& pose, const char* what, Line& line) {
  if (!pose.frame.empty()) raise_invalid(fmt::format("{}: expected no frame; Line has one", what));
  if (!line.link.empty() && line.link != pose.link) {
    raise_invalid(
        fmt::format("{}: expected a pose of '{}', got one of '{}'", what, line.link, pose.link));
  }
  line.link = pose.link;
}

Line make_line(std::string link, const py::object& by, const std::optional<PoseGoal>& to,
               const std::optional<PoseGoal>& from, std::string frame, const std::string& free_axis,
               double position_tolerance, double rotation_tolerance) {
  Line line;
  line.link = std::move(link);
  line.frame = std::move(frame);
  line.position_tolerance = position_tolerance;
  line.rotation_tolerance = rotation_tolerance;
  if (by.is_none() == !to.has_value()) raise_invalid("by, to: expected one of both");
  if (to) {
    take_link(*to, "to", line);
    line.target = to->pose;
    line.keeps_rotation = is_position(*to);
  } else {
    line.displacement = to_point(by, "by");
  }
  if (from) {
    take_link(*from, "from_", line);
    if (is_position(*from)) raise_invalid("from_: expected a pose with quat_xyzw");
    line.start = from->pose;
  }
  if (free_axis.empty()) return line;
  line.free_axis = parse_axis(free_axis);
  if (!line.free_axis) {
    raise_invalid(fmt::format("free_axis: expected x, y or z, got '{}'", free_axis));
  }
  return line;
}

struct BoundLine : LineResult {
  int joint_count = 0;
};

BoundLine plan_on_line(const Robot& robot, const Line& line, const py::object& start,
                       const Scene& scene, const std::string& isa, const py::kwargs& arguments) {
  auto settings = read_keywords<LineSettings>("plan_line", arguments);
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  if (start.is_none() && !line.start) raise_invalid("start: expected one, or a line with from_");
  const Configuration from =
      start.is_none() ? robot.normalized(zero) : to_vector(start, robot.joint_count(), "start");
  const CheckerSettings checking{std::nullopt, 0, unwrap(parse_isa(isa))};
  std::atomic<bool> cancel = false;
  settings.cancel = &cancel;
  LineResult result = unwrap(run_interruptible(cancel, [&, copy = scene] {
    return CollisionChecker::make(robot, copy, checking)
        .and_then([&](const CollisionChecker& checker) {
          return plan_line(checker, line, from, settings);
        });
  }));
  return {std::move(result), robot.joint_count()};
}

std::string describe_line(const BoundLine& result) {
  return result.is_whole()
             ? fmt::format("<mneme.LineResult of {} configurations>", result.line.path.size())
             : fmt::format("<mneme.LineResult of {:.1f} %: {}>", 100 * result.line.fraction(),
                           result.reason);
}

void bind_result(py::module_& module) {
  py::class_<BoundLine>(module, "LineResult",
                        "A path along a line, or along the longest part that was found.")
      .def_property_readonly("is_whole", &BoundLine::is_whole)
      .def_property_readonly(
          "fraction", [](const BoundLine& self) { return self.line.fraction(); },
          "Share of the line that the path reaches, 0 to 1.")
      .def_property_readonly(
          "path", [](const BoundLine& self) { return to_array(self.line.path, self.joint_count); },
          "Shape (n, joint_count), radians.")
      .def_property_readonly(
          "fractions", [](const BoundLine& self) { return to_array(self.line.fractions); },
          "Share of the line at each configuration, shape (n,).")
      .def_property_readonly(
          "others",
          [](const BoundLine& self) {
            py::list all;
            for (const LinePath& line : self.others) {
              all.append(to_array(line.path, self.joint_count));
            }
            return all;
          },
          "Whole paths of further branches, if `line_paths` is more than 1.")
      .def_property_readonly(
          "position_deviation", [](const BoundLine& self) { return self.line.position_deviation; },
          "Proven bound on the distance from the line, also between configurations, metres.")
      .def_property_readonly(
          "rotation_deviation", [](const BoundLine& self) { return self.line.rotation_deviation; },
          "Proven bound on the deviation of the rotation, radians.")
      .def_readonly("reason", &BoundLine::reason,
                    "Why the rest of the line is not possible; empty for a whole line.")
      .def_readonly("branches", &BoundLine::branches, "Number of start configurations.")
      .def_readonly("steps", &BoundLine::steps)
      .def_readonly("is_timed_out", &BoundLine::is_timed_out)
      .def("__repr__", &describe_line);
}

}  // namespace

void bind_line(py::module_& module) {
  py::class_<Line>(module, "Line", "A straight motion of a link.")
      .def(py::init(&make_line), py::arg("link") = "", py::kw_only(), py::arg("by") = py::none(),
           py::arg("to") = py::none(), py::arg("from_") = py::none(), py::arg("frame") = "",
           py::arg("free_axis") = "", py::arg("position_tolerance") = Line().position_tolerance,
           py::arg("rotation_tolerance") = Line().rotation_tolerance,
           "link: default: the only tip of the planning group.\n"
           "by: motion of the link, metres; the link keeps its rotation.\n"
           "to: PoseGoal where the line ends, instead of `by`; without quat_xyzw the link keeps\n"
           "its rotation.\n"
           "from_: PoseGoal where the line starts, in the frame of the robot's root link: all\n"
           "branches of inverse kinematics are tried. Default: the line starts at `start`.\n"
           "frame: a link whose pose at the start is the frame of `by` and `to`; the moved link:\n"
           "along its own axes. Default: the robot's root link.\n"
           "free_axis: \"x\", \"y\" or \"z\": axis of the link about which it may turn freely.\n"
           "position_tolerance, rotation_tolerance: largest deviation, metres and radians.")
      .def_readonly("link", &Line::link)
      .def_readonly("frame", &Line::frame)
      .def_readonly("position_tolerance", &Line::position_tolerance, "Metres.")
      .def_readonly("rotation_tolerance", &Line::rotation_tolerance, "Radians.");
  bind_result(module);
  module.def(
      "plan_line", &plan_on_line, py::arg("robot"), py::arg("line"), py::arg("start") = py::none(),
      py::kw_only(), py::arg("scene") = Scene(), py::arg("isa") = "automatic",
      ("Finds a path whose link stays on a line, with a proven bound on the deviation. Where the\n"
       "line is only possible in part, the result has the longest part and the reason. With a\n"
       "line that has from_, branches near `start` (default: zeros) are tried first.\n\n" +
       describe_keywords<LineSettings>())
          .c_str());
}

}  // namespace mneme::python

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/check.h"
#include "mneme/goal.h"
#include "mneme/path.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "problem.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mneme::python {
namespace {

Eigen::Matrix3d to_rotation(const py::object& quaternion) {
  const std::vector<double> q = to_vector(quaternion, 4, "quat_xyzw");
  const auto rotation = rotation_from_unit_quaternion(std::span(q).first<4>());
  if (!rotation) raise_invalid("quat_xyzw: " + rotation.error().message);
  return *rotation;
}

Axis to_axis(const std::string& name) {
  if (const auto axis = parse_axis(name)) return *axis;
  raise_invalid(fmt::format("axis: expected x, y or z, got '{}'", name));
}

py::array_t<double> point_array(const Vec3& v) {
  return to_array(std::vector<double>{v.x(), v.y(), v.z()});
}

/// Radians, or "free".
using Angle = std::variant<double, std::string>;

double to_radians(const Angle& given, const char* name) {
  if (const auto* radians = std::get_if<double>(&given)) return *radians;
  if (std::get<std::string>(given) == "free") return std::numbers::pi;
  raise_invalid(
      fmt::format("{}: expected radians or 'free', got '{}'", name, std::get<std::string>(given)));
}

PoseGoal make_pose_goal(std::string link, const py::object& position, const py::object& quaternion,
                        const py::object& position_tolerance, const std::string& axis,
                        const Angle& cone, const Angle& turn, std::string frame) {
  PoseGoal goal;
  goal.link = std::move(link);
  goal.frame = std::move(frame);
  goal.pose.translation = to_point(position, "position");
  goal.axis = to_axis(axis);
  goal.cone = goal.turn = std::numbers::pi;
  if (!quaternion.is_none()) {
    goal.pose.rotation = to_rotation(quaternion);
    goal.cone = to_radians(cone, "cone");
    goal.turn = to_radians(turn, "turn");
  } else if (cone != Angle(0.0) || turn != Angle(0.0)) {
    raise_invalid("cone, turn: expected quat_xyzw, too, got none");
  }
  const Array tolerance = to_numbers(position_tolerance, "position_tolerance");
  goal.position_tolerance = tolerance.ndim() == 0 ? Vec3(Vec3::Constant(*tolerance.data()))
                                                  : to_point(tolerance, "position_tolerance");
  return goal;
}

py::array_t<double> to_quaternion(const PoseGoal& goal) {
  const Eigen::Quaterniond q(goal.pose.rotation);
  return to_array(std::vector<double>{q.x(), q.y(), q.z(), q.w()});
}

/// Returns the state for pickling.
py::tuple state_of(const PoseGoal& goal) {
  const Eigen::Matrix3d& rotation = goal.pose.rotation;
  return py::make_tuple(goal.link, point_array(goal.pose.translation),
                        to_array(std::vector<double>(rotation.data(), rotation.data() + 9)),
                        point_array(goal.position_tolerance), std::string(to_string(goal.axis)),
                        goal.cone, goal.turn, goal.frame);
}

PoseGoal goal_of(const py::tuple& state) {
  PoseGoal goal;
  goal.link = state[0].cast<std::string>();
  goal.pose.translation = to_point(state[1], "position");
  const std::vector<double> rotation = to_vector(state[2], 9, "rotation");
  goal.pose.rotation = Eigen::Map<const Eigen::Matrix3d>(rotation.data());
  goal.position_tolerance = to_point(state[3], "position_tolerance");
  goal.axis = to_axis(state[4].cast<std::string>());
  goal.cone = state[5].cast<double>();
  goal.turn = state[6].cast<double>();
  goal.frame = state[7].cast<std::string>();
  return goal;
}

std::string describe(const PoseGoal& goal) {
  const Vec3& at = goal.pose.translation;
  return fmt::format("<mneme.PoseGoal of '{}' at [{:.4g}, {:.4g}, {:.4g}]>", goal.link, at.x(),
                     at.y(), at.z());
}

OrientationConstraint make_constraint(std::string link, double angle, const py::object& axis,
                                      const py::object& up) {
  OrientationConstraint constraint{std::move(link), to_point(axis, "axis"), to_point(up, "up"),
                                   angle};
  for (const auto& [name, direction] :
       {std::pair{"axis", &constraint.axis}, {"up", &constraint.up}}) {
    const double length = direction->norm();
    if (!(length > 0 && std::isfinite(length))) {
      raise_invalid(fmt::format("{}: expected finite numbers, not all of them 0", name));
    }
    direction->normalize();
  }
  return constraint;
}

double tilt_at(const Robot& robot, const OrientationConstraint& constraint, const py::object& q) {
  if (const auto fault = describe_fault(robot, constraint)) raise_invalid("constraint: " + *fault);
  return tilt(robot, constraint, to_vector(q, robot.joint_count(), "q"));
}

void bind_constraint(py::module_& module) {
  using Constraint = OrientationConstraint;
  py::class_<Constraint>(module, "OrientationConstraint",
                         "A link that stays upright along the path.")
      .def(py::init(&make_constraint), py::arg("link"), py::arg("angle"), py::kw_only(),
           py::arg("axis") = py::make_tuple(0, 0, 1), py::arg("up") = py::make_tuple(0, 0, 1),
           "Limits the angle between `axis`, in the link's frame, and `up` to `angle` radians. "
           "`up`\n"
           "is in the frame of the robot's root link; for Problem.load() in the frame of the\n"
           "problem's scene.")
      .def_readonly("link", &Constraint::link)
      .def_readonly("angle", &Constraint::angle, "Radians.")
      .def_property_readonly(
          "axis", [](const Constraint& self) { return point_array(self.axis); },
          "Unit vector, shape (3,).")
      .def_property_readonly(
          "up", [](const Constraint& self) { return point_array(self.up); },
          "Unit vector, shape (3,).")
      .def(
          "tilt",
          [](const Constraint& self, const Robot& robot, const py::object& q) {
            return tilt_at(robot, self, q);
          },
          py::arg("robot"), py::arg("q"),
          "Returns the angle between axis and up at a configuration, radians.")
      .def(py::pickle(
          [](const Constraint& self) {
            return py::make_tuple(self.link, point_array(self.axis), point_array(self.up),
                                  self.angle);
          },
          [](const py::tuple& state) {
            return Constraint{state[0].cast<std::string>(), to_point(state[1], "axis"),
                              to_point(state[2], "up"), state[3].cast<double>()};
          }))
      .def("__repr__", [](const Constraint& self) {
        return fmt::format("<mneme.OrientationConstraint of '{}' within {:.4g} rad>", self.link,
                           self.angle);
      });
}

struct FoundConfigurations {
  std::vector<Configuration> rows;
  std::string message;  ///< why there are none
};

}  // namespace

void place_goals(std::vector<PoseGoal>& goals, const Robot& robot, const Configuration& q,
                 const std::string& what) {
  for (PoseGoal& goal : goals) {
    auto placed = in_root_frame(std::move(goal), robot, q);
    if (!placed) raise_invalid(what + ": " + placed.error().message);
    goal = *std::move(placed);
    if (const auto fault = describe_fault(robot, goal)) raise_invalid(what + ": " + *fault);
  }
}

namespace {

/// A mneme.Solutions.
py::object to_solutions(const FoundConfigurations& found, int joint_count) {
  const py::object type = py::module_::import("mneme._solutions").attr("Solutions");
  py::object rows = to_array(found.rows, joint_count).attr("view")(type);
  rows.attr("message") = to_text(found.message);
  return rows;
}

using OneOrMore = std::variant<PoseGoal, std::vector<PoseGoal>>;

py::object solve_ik(const Robot& robot, const OneOrMore& given, const py::object& near,
                    const Scene& scene, std::uint64_t seed, const std::string& isa,
                    const py::kwargs& arguments) {
  const auto* one = std::get_if<PoseGoal>(&given);
  std::vector<PoseGoal> goals = one ? std::vector{*one} : std::get<1>(given);
  auto settings = read_keywords<IkSettings>("inverse_kinematics", arguments);
  settings.seed = seed;
  if (goals.empty()) raise_invalid("goals: expected at least one, got none");
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  const Configuration from =
      near.is_none() ? robot.normalized(zero) : to_vector(near, robot.joint_count(), "near");
  if (const auto violation = robot.describe_violation(from, "near")) raise_invalid(*violation);
  place_goals(goals, robot, from, "goals");
  const CheckerSettings checking{std::nullopt, 0, unwrap(parse_isa(isa))};
  const CollisionChecker checker = unwrap(run_interruptible(
      [&, copy = scene] { return CollisionChecker::make(robot, copy, checking); }));
  std::atomic<bool> cancel = false;
  settings.is_over = [&] { return cancel.load(); };
  auto found = run_interruptible(cancel, [&] {
    return PoseGoalSource::make(checker, goals, from, settings, kVerificationMargin)
        .map([](PoseGoalSource source) {
          FoundConfigurations all{source.find_all(), {}};
          if (all.rows.empty()) all.message = source.describe_failure();
          return all;
        });
  });
  return to_solutions(unwrap(std::move(found)), robot.joint_count());
}

}  // namespace

void bind_goal(py::module_& module) {
  bind_constraint(module);
  py::class_<PoseGoal>(module, "PoseGoal", "A region of goal poses of a link.")
      .def(
          py::init(&make_pose_goal), py::arg("link"), py::arg("position"),
          py::arg("quat_xyzw") = py::none(), py::kw_only(), py::arg("position_tolerance") = 0.0,
          py::arg("axis") = "z", py::arg("cone") = 0.0, py::arg("turn") = 0.0,
          py::arg("frame") = "",
          "position: metres. quat_xyzw: orientation; without it any rotation is a goal.\n"
          "position_tolerance: metres along the axes of the pose, or one number for all.\n"
          "cone, turn: tolerances in radians: the link's `axis` may tilt by `cone`, and the link "
          "may\n"
          "turn about it by `turn`. pi or \"free\": any angle.\n"
          "frame: a link whose pose at the start is the frame of the goal; inverse_kinematics()\n"
          "takes its pose at `near`. Default: the robot's root link; for Problem.load() the frame\n"
          "of the problem's scene.")
      .def_readonly("link", &PoseGoal::link)
      .def_property_readonly(
          "position", [](const PoseGoal& self) { return point_array(self.pose.translation); },
          "Shape (3,), metres.")
      .def_property_readonly("quat_xyzw", &to_quaternion, "Shape (4,).")
      .def_property_readonly(
          "position_tolerance",
          [](const PoseGoal& self) { return point_array(self.position_tolerance); },
          "Shape (3,), metres along the axes of the pose.")
      .def_property_readonly("axis",
                             [](const PoseGoal& self) { return std::string(to_string(self.axis)); })
      .def_readonly("cone", &PoseGoal::cone)
      .def_readonly("turn", &PoseGoal::turn)
      .def_readonly(
          "frame", &PoseGoal::frame,
          "The link in whose frame the pose is. Empty: the root link. Goals of a Problem\n"
          "are always in the root link's frame.")
      .def(
          "to_json", [](const PoseGoal& self) { return to_json(self); },
          "Returns the goal as in JSON files and requests.")
      .def(py::pickle(&state_of, &goal_of))
      .def("__repr__", &describe);
  module.def("inverse_kinematics", &solve_ik, py::arg("robot"), py::arg("goals"), py::kw_only(),
             py::arg("near") = py::none(), py::arg("scene") = Scene(), py::arg("seed") = 1,
             py::arg("isa") = "automatic",
             ("Returns free configurations that reach any of the goals, nearest to `near` "
              "(default: zeros)\n"
              "first: shape (k, joint_count), radians. If k is 0, `message` says why.\n\n" +
              describe_keywords<IkSettings>())
                 .c_str());
}

}  // namespace mneme::python

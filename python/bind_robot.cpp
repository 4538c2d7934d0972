// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/spheres.h"
#include "mneme/robot.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "keywords.h"
#include "origins.h"
#include "pickling.h"
#include "prepare.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>

namespace mneme::python {
namespace {

Robot load(const std::string& robot, const RobotOptions& options, const py::kwargs& settings) {
  const auto spheres = read_keywords<SphereSettings>("Robot.load", settings);
  const std::string path = unwrap(robot_file(robot));
  const Robot loaded = unwrap(run_interruptible([&] {
    return load_approximated_robot(path, options, spheres).map([](ApproximatedRobot made) {
      prepare(made.robot);
      return std::move(made.robot);
    });
  }));
  set_origin(loaded.identity(), robot_files(path, options.srdf_path));
  return loaded;
}

Robot make_planar(const py::object& lengths, double thickness, const std::string& name) {
  const std::vector<double> values = to_vector(lengths, -1, "lengths");
  const std::string chosen = name.empty() ? fmt::format("planar{}", values.size()) : name;
  const std::string urdf = unwrap(planar_arm_urdf(chosen, values, thickness));
  return unwrap(parse_robot(urdf, chosen));
}

std::vector<std::string> link_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const Link& link : robot.links()) names.push_back(link.name);
  return names;
}

py::array_t<double> limits(const Robot& robot) {
  Path rows;
  for (int i = 0; i < robot.joint_count(); ++i) {
    rows.push_back({robot.group_joint(i).lower, robot.group_joint(i).upper});
  }
  return read_only(to_array(rows, 2));
}

py::array_t<double> link_poses(const Robot& robot, const py::object& q) {
  const std::vector<Transform> poses = robot.link_poses(to_vector(q, robot.joint_count(), "q"));
  py::array_t<double> array(
      {static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  auto out = array.mutable_unchecked<3>();
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const Transform& pose = poses[static_cast<std::size_t>(i)];
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        const bool is_rotation = row < 3 && column < 3;
        out(i, row, column) = is_rotation   ? pose.rotation(row, column)
                              : row < 3     ? pose.translation(row)
                              : column == 3 ? 1
                                            : 0;
      }
    }
  }
  return array;
}

void bind_factories(py::class_<Robot>& robot) {
  robot.def_static(
      "load",
      [](const std::filesystem::path& robot_path, const std::filesystem::path& srdf,
         const std::string& group, const std::vector<std::string>& joints,
         const std::vector<std::filesystem::path>& package_paths,
         const std::map<std::string, double>& fixed_values, bool strict, bool hard_limits,
         const py::kwargs& settings) {
        if (!group.empty() && !joints.empty()) {
          raise_invalid("group and joints: expected one of them; joints names all to plan for");
        }
        RobotOptions options;
        options.strict = strict;
        options.hard_limits = hard_limits;
        options.srdf_path = srdf.string();
        options.group = group;
        options.joints = joints;
        for (const auto& path : package_paths) {
          options.package_paths.push_back(path.string());
        }
        options.fixed_values = fixed_values;
        return load(robot_path.string(), options, settings);
      },
      py::arg("robot"), py::kw_only(), py::arg("srdf") = "", py::arg("group") = "",
      py::arg("joints") = std::vector<std::string>(),
      py::arg("package_paths") = std::vector<std::filesystem::path>(),
      py::arg("fixed_values") = std::map<std::string, double>(), py::arg("strict") = false,
      py::arg("hard_limits") = false,
      ("Reads a robot: a URDF file, or the name of a bundled robot.\n\n"
       "srdf: file with groups and allowed collisions. Default: the one beside the URDF.\n"
       "group: a group of the SRDF, or the chain 'base_link:tip_link'.\n"
       "joints: instead of a group, names of the joints to plan for, in the order of a "
       "configuration.\n"
       "package_paths: directories to search for packages of package:// URLs.\n"
       "fixed_values: radians or metres of joints outside the group, by name. A planar joint J has "
       "J/x, J/y and J/theta; a floating one J/trans_x .. J/trans_z and J/rot_x .. J/rot_w.\n"
       "strict: refuses unknown elements and attributes, missing limits and shapes without size, "
       "which are otherwise named in one warning.\n"
       "hard_limits: uses the limits of <limit>, not the narrower ones of <safety_controller>.\n\n"
       "Settings of the sphere approximation of boxes, cylinders and meshes:\n\n" +
       describe_keywords<SphereSettings>())
          .c_str());
  robot.def_static("planar", &make_planar, py::arg("lengths"), py::kw_only(),
                   py::arg("thickness") = 0.001, py::arg("name") = "",
                   "A planar arm: links along x in the plane z = 0, joints about z.\n\n"
                   "lengths: metres, one per link, each > 0. thickness: diameter of the links, "
                   "metres.");
}

void bind_properties(py::class_<Robot>& robot) {
  robot.def_property_readonly("name", &Robot::name)
      .def_property_readonly(
          "joint_count", &Robot::joint_count,
          "Number of joints in the planning group, the length of a configuration.")
      .def_property_readonly("joint_names", &Robot::joint_names,
                             "Names of the group's joints, in the order of a configuration.")
      .def_property_readonly("link_names", &link_names, "Names of all links, parents first.")
      .def_property_readonly("limits", &limits,
                             "Lower and upper limits, shape (joint_count, 2): radians, or metres "
                             "for prismatic joints; -pi and pi for continuous ones.")
      .def_property_readonly("hash", &Robot::hash,
                             "16 hexadecimal digits over all data of the robot that decide whether "
                             "a\nconfiguration is valid. Attached objects do not count.")
      .def_property_readonly("kinematics_hash", &Robot::kinematics_hash,
                             "16 hexadecimal digits over the joints of the group, their frames and "
                             "limits. Memory applies to all robots with the same value.")
      .def_property_readonly("is_planar", &Robot::is_planar)
      .def_property_readonly(
          "warnings", [](const Robot& self) { return to_texts(self.warnings()); },
          "Parts of the input that were ignored.");
}

void bind_functions(py::class_<Robot>& robot) {
  const auto configuration = [](const Robot& self, const py::object& q, const char* what) {
    return to_vector(q, self.joint_count(), what);
  };
  robot.def("link_poses", &link_poses, py::arg("q"),
            "Returns the poses of all links in the root link's frame, shape (links, 4, 4), in the\n"
            "order of link_names. q: shape (joint_count,), radians.");
  robot.def(
      "describe_violation",
      [](const Robot& self, const py::object& q) {
        return self.describe_violation(to_vector(q, -1, "q"), "q");
      },
      py::arg("q"),
      "Says why q is no configuration of this robot (count, NaN, limits). None if it is one.");
  robot.def(
      "normalized",
      [=](const Robot& self, const py::object& q) {
        return to_array(self.normalized(configuration(self, q, "q")));
      },
      py::arg("q"),
      "Returns q with continuous joints wrapped to [-pi, pi) and others clamped to their limits.");
  robot.def(
      "difference",
      [=](const Robot& self, const py::object& a, const py::object& b) {
        return to_array(self.difference(configuration(self, a, "a"), configuration(self, b, "b")));
      },
      py::arg("a"), py::arg("b"),
      "Returns the displacement from a to b, shape (joint_count,). Continuous joints take the "
      "shorter\n"
      "direction.");
  robot.def(
      "distance",
      [=](const Robot& self, const py::object& a, const py::object& b) {
        return self.distance(configuration(self, a, "a"), configuration(self, b, "b"));
      },
      py::arg("a"), py::arg("b"), "Returns the L2 norm of difference(a, b), radians.");
  robot.def(
      "path_length",
      [](const Robot& self, const py::object& path) {
        return path_length(self, to_rows(path, self.joint_count(), "path"));
      },
      py::arg("path"),
      "Returns the sum of distances along a path of shape (n, joint_count), radians.");
  robot.def("__repr__", [](const Robot& self) {
    return fmt::format("<mneme.Robot '{}', {} joints, hash {}>", self.name(), self.joint_count(),
                       self.hash());
  });
}

}  // namespace

void bind_robot(py::module_& module) {
  py::class_<Robot> robot(module, "Robot",
                          "An immutable robot with the joints to plan for. Radians and metres.");
  bind_factories(robot);
  bind_properties(robot);
  bind_functions(robot);
  bind_attached(robot);
  refuse_pickling(robot, "load or make it in each process");
}

}  // namespace mneme::python

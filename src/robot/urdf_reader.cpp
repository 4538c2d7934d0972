// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/urdf_reader.h"

#include "base/as_index.h"
#include "base/text.h"
#include "geometry/tolerated.h"
#include "input/xml_reader.h"
#include "mesh/mesh_file.h"
#include "robot/robot_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {
namespace {

/// Radians or metres beyond which a limit counts as infinite.
constexpr double kFarthestLimit = 1e4;

/// Radians that a revolute joint is assumed to stay within if a limit is infinite.
constexpr double kFarthestTurn = 4 * std::numbers::pi;

/// Sizes of a solid. Returns false if all are 0: there is no shape.
bool has_size(XmlReader& xml, const XmlElement& shape, std::initializer_list<double*> sizes,
              const std::string& fault) {
  const auto is_zero = [](const double* size) { return *size == 0; };
  if (std::ranges::any_of(sizes, [](const double* size) { return *size < 0; })) {
    xml.fail(shape, fault);
  }
  if (std::ranges::none_of(sizes, is_zero)) return true;
  const bool is_nothing = std::ranges::all_of(sizes, is_zero);
  xml.tolerate(shape, is_nothing ? "the shape has no size and is ignored" : kThinFault, fault);
  for (double* size : sizes) *size = thickened(*size);
  return !is_nothing;
}

void add_box(XmlReader& xml, const XmlElement& box, const Transform& pose, Link& link) {
  xml.check_attributes(box, {"size"});
  xml.text(box, "size");
  Vec3 size = xml.vector(box, "size", Vec3::Zero());
  const std::string fault =
      fmt::format("size is {} {} {}, expected three numbers above 0", size.x(), size.y(), size.z());
  if (!has_size(xml, box, {&size.x(), &size.y(), &size.z()}, fault)) return;
  link.solids.push_back(Box{pose, 0.5 * size});
}

void add_cylinder(XmlReader& xml, const XmlElement& cylinder, const Transform& pose, Link& link) {
  xml.check_attributes(cylinder, {"radius", "length"});
  double radius = xml.number(cylinder, "radius"), length = xml.number(cylinder, "length");
  const bool is_radius = radius <= 0;
  const std::string fault =
      fmt::format("{} is {}, expected more than 0", is_radius ? "radius" : "length",
                  is_radius ? radius : length);
  if (!has_size(xml, cylinder, {&radius, &length}, fault)) return;
  link.solids.push_back(Cylinder{pose, radius, length});
}

/// Three factors, or one for all axes.
Vec3 read_scale(XmlReader& xml, const XmlElement& mesh) {
  if (xml.is_strict() || mesh.Attribute("scale") == nullptr) {
    return xml.vector(mesh, "scale", Vec3::Ones());
  }
  const auto n = xml.numbers(mesh, "scale", {1, 3}, "three finite numbers");
  return n.size() == 1 ? Vec3::Constant(n[0]) : Vec3(n[0], n[1], n[2]);
}

void add_mesh(XmlReader& xml, const MeshFinder& meshes, const XmlElement& mesh,
              const Transform& pose, Link& link) {
  xml.check_attributes(mesh, {"filename", "scale"});
  const Vec3 scale = read_scale(xml, mesh);
  if (scale.isZero(0)) {
    return xml.tolerate(mesh, "the shape has no size and is ignored", "a scale is 0");
  }
  if ((scale.array() == 0).any()) xml.fail(mesh, "a scale is 0");
  const std::string name = xml.text(mesh, "filename");
  std::string unknown;
  auto path = meshes.find(name, xml.is_strict() ? nullptr : &unknown);
  if (!path) {
    xml.fail(mesh, fmt::format("'{}': {}", name, path.error().message), path.error().code);
  }
  if (!unknown.empty()) {
    xml.tolerate(mesh, fmt::format("no package '{}', took files above the URDF", unknown), name);
  }
  if (is_empty_mesh(*path)) {
    return xml.tolerate(mesh, "the mesh has no surface and is ignored", name);
  }
  link.solids.push_back(MeshFile{*std::move(path), scale, pose});
}

void add_sphere(XmlReader& xml, const XmlElement& sphere, const Transform& pose, Link& link) {
  xml.check_attributes(sphere, {"radius"});
  double radius = xml.non_negative_number(sphere, "radius");
  if (!has_size(xml, sphere, {&radius}, "radius is 0, expected more than 0")) return;
  link.spheres.push_back({pose.translation, radius});
}

void add_capsule(XmlReader& xml, const XmlElement& capsule, const Transform& pose, Link& link) {
  xml.check_attributes(capsule, {"radius", "length"});
  double radius = xml.non_negative_number(capsule, "radius");
  double length = xml.non_negative_number(capsule, "length");
  const bool is_ball = length == 0 && radius > 0;
  const char* fault = "radius is 0, expected more than 0";
  if (!is_ball && !has_size(xml, capsule, {&radius, &length}, fault)) return;
  const Vec3 half(0, 0, 0.5 * length);
  link.capsules.push_back({pose * Vec3(-half), pose * half, radius});
}

/// A turn, and what rounding adds. Larger angles are probably degrees.
constexpr double kMostAngle = 2 * std::numbers::pi + 1e-3;

/// Returns the pose of the child <origin> of `element`; the identity without one.
Transform read_origin(XmlReader& xml, const XmlElement& element) {
  const XmlElement* origin = element.FirstChildElement("origin");
  if (origin == nullptr) return {};
  xml.check_attributes(*origin, {"xyz", "rpy", "quat_xyzw"});
  const Vec3 xyz = xml.vector(*origin, "xyz", Vec3::Zero());
  if (origin->Attribute("quat_xyzw") == nullptr) {
    const Vec3 rpy = xml.vector(*origin, "rpy", Vec3::Zero());
    if (rpy.cwiseAbs().maxCoeff() > kMostAngle) {
      xml.tolerate(*origin, "an angle of rpy exceeds a turn; expected radians",
                   "an angle of rpy exceeds a turn; expected radians");
    }
    return {rotation_from_rpy(rpy), xyz};
  }
  if (origin->Attribute("rpy")) xml.fail(*origin, "expected either rpy or quat_xyzw, got both");
  const auto q = xml.numbers(*origin, "quat_xyzw", {4}, "four finite numbers");
  const QuaternionLength length = judge_length({q[0], q[1], q[2], q[3]});
  if (length == QuaternionLength::wrong) {
    xml.fail(*origin, "quat_xyzw is {}, expected a quaternion of length 1",
             origin->Attribute("quat_xyzw"));
  }
  if (length == QuaternionLength::tolerated) xml.tolerate(*origin, kScaledFault, kScaledFault);
  return {rotation_from_quaternion(q[3], q[0], q[1], q[2]), xyz};
}

void add_shape(XmlReader& xml, const MeshFinder& meshes, const XmlElement& shape,
               const Transform& pose, Link& link) {
  const std::string_view kind = shape.Name();
  if (kind == "sphere") return add_sphere(xml, shape, pose, link);
  if (kind == "capsule" || kind == "drake:capsule") return add_capsule(xml, shape, pose, link);
  if (kind == "box") return add_box(xml, shape, pose, link);
  if (kind == "cylinder") return add_cylinder(xml, shape, pose, link);
  if (kind == "mesh") return add_mesh(xml, meshes, shape, pose, link);
  // A shape that is ignored would be a collision that is not checked.
  xml.fail(shape.GetLineNum(),
           "unknown element <{}> in <geometry>; expected one of: sphere, capsule, box, cylinder, "
           "mesh",
           kind);
}

}  // namespace

void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link) {
  xml.check_children(element, {"origin"}, {"geometry", "material"});
  const Transform pose = read_origin(xml, element);
  const auto geometries = children(element, "geometry");
  if (geometries.empty()) {
    xml.tolerate(element, "it has no shape", "the element <geometry> is missing");
  }
  if (geometries.size() > 1) {
    xml.tolerate(geometries[1]->GetLineNum(),
                 "a second <geometry> in <collision>, which is used as well",
                 "there is a second <geometry> in <collision>");
  }
  for (const XmlElement* geometry : geometries) {
    const auto shapes = children(*geometry);
    if (shapes.size() != 1) {
      xml.tolerate(*geometry,
                   shapes.empty() ? "it has no shape" : "several shapes, which are all used",
                   "expected exactly one shape");
    }
    for (const XmlElement* shape : shapes) add_shape(xml, meshes, *shape, pose, link);
  }
}

namespace {

/// Reads the parts of a robot and keeps their lines for messages.
class UrdfReader {
 public:
  UrdfReader(const std::string& source, const RobotOptions& options)
      : source_(source),
        options_(options),
        xml_(source, options.strict ? XmlReader::Mode::strict : XmlReader::Mode::lenient),
        meshes_(source, options.package_paths) {}

  Robot::Parts read(std::string_view urdf) {
    tinyxml2::XMLDocument document;
    const XmlElement& robot = xml_.read_root(document, urdf, "robot");
    read_name(robot);
    xml_.check_attributes(robot, {"name", "version", "xmlns"});
    xml_.check_children(
        robot, {},
        {"link", "joint", "material", "gazebo", "transmission", "ros2_control", "sensor"});
    for (const XmlElement* child : children(robot)) {
      if (child->Name() == std::string_view("link")) read_link(*child);
      if (child->Name() == std::string_view("joint")) read_joint(*child);
      xml_.set_context("");
    }
    connect_joints();
    parts_.warnings = xml_.warnings();
    if (!narrowed_.empty()) {
      parts_.warnings.push_back(fmt::format(
          "{}: <safety_controller> narrows the limits of {} (the limits of <limit> apply "
          "with --hard-limits, hard_limits)",
          source_, fmt::join(narrowed_, ", ")));
    }
    if (!standing_.empty()) {
      // Exporters write 0 and 0 where they were given none.
      parts_.warnings.push_back(
          fmt::format("{}: lower and upper are the same for {}, which cannot "
                      "move; expected the limits of the robot",
                      source_, fmt::join(standing_, ", ")));
    }
    auto sorted = sort_tree(std::move(parts_));
    if (sorted) return *std::move(sorted);
    const PartsFault& fault = sorted.error();
    int line = robot.GetLineNum();
    if (fault.link >= 0) line = link_lines_[as_index(fault.link)];
    if (fault.joint >= 0) line = joint_elements_[as_index(fault.joint)]->GetLineNum();
    xml_.fail(line, fault.message);
  }

 private:
  void read_name(const XmlElement& robot) {
    const char* name = robot.Attribute("name");
    if (name != nullptr && *name != '\0') {
      parts_.name = xml_.text(robot, "name");
      return;
    }
    const std::string stem = std::filesystem::path(source_).stem().string();
    parts_.name = stem.empty() ? "robot" : stem;
    xml_.tolerate(robot, fmt::format("no name, '{}' is used", parts_.name),
                  name == nullptr ? "attribute 'name' is missing" : "'name' is empty");
  }

  void read_link(const XmlElement& element) {
    Link link;
    link.name = xml_.text(element, "name");
    xml_.set_context(fmt::format("link '{}'", link.name));
    xml_.check_attributes(element, {"name"});
    // <contact> holds friction and damping.
    xml_.check_children(element, {}, {"collision", "visual", "inertial", "contact", "gazebo"});
    for (const XmlElement* collision : children(element, "collision")) {
      read_collision(xml_, meshes_, *collision, link);
    }
    link_indices_.emplace(link.name, static_cast<int>(parts_.links.size()));
    link_lines_.push_back(element.GetLineNum());
    parts_.links.push_back(std::move(link));
  }

  JointType read_type(const XmlElement& element) {
    const std::string type = xml_.text(element, "type");
    for (const JointType known :
         {JointType::fixed, JointType::revolute, JointType::continuous, JointType::prismatic}) {
      if (type == to_string(known)) return known;
    }
    constexpr std::string_view kExpected = "expected fixed, revolute, continuous or prismatic";
    if (type != "planar" && type != "floating") {
      xml_.fail(element, "type '{}' is unknown; {}, or planar or floating, which keep their values",
                type, kExpected);
    }
    xml_.tolerate(
        element,
        fmt::format("a {} joint cannot be planned for and stays at its fixed values", type),
        fmt::format("type '{}' is not supported; {}", type, kExpected), ErrorCode::unsupported);
    return JointType::fixed;
  }

  /// Reads a planar or floating joint. MoveIt, too, moves a planar joint without <axis> across z.
  void read_held(const XmlElement& element, Joint& joint) {
    const std::string type = xml_.text(element, "type");
    if (type != "planar" && type != "floating") return;
    joint.held = HeldPose{type == "planar", {}};
    joint.axis = Vec3::UnitZ();
    const XmlElement* axis = element.FirstChildElement("axis");
    if (axis != nullptr && type == "planar") joint.axis = xml_.vector(*axis, "xyz", joint.axis);
  }

  void read_joint(const XmlElement& element) {
    Joint joint;
    joint.name = xml_.text(element, "name");
    xml_.set_context(fmt::format("joint '{}'", joint.name));
    xml_.check_attributes(element, {"name", "type"});
    xml_.check_children(element, {"origin", "parent", "child", "axis", "limit", "mimic"},
                        {"dynamics", "safety_controller", "calibration", "gazebo"});
    joint.type = read_type(element);
    joint.origin = read_origin(xml_, element);
    read_held(element, joint);
    if (joint.type != JointType::fixed) {
      read_motion(element, joint);
      read_mimic(element, joint);
    }
    joint_elements_.push_back(&element);
    parts_.joints.push_back(std::move(joint));
  }

  void read_motion(const XmlElement& element, Joint& joint) {
    if (const XmlElement* axis = element.FirstChildElement("axis")) {
      xml_.check_attributes(*axis, {"xyz"});
      xml_.text(*axis, "xyz");
      joint.axis = xml_.vector(*axis, "xyz", joint.axis);
    }
    if (const XmlElement* limit = element.FirstChildElement("limit")) {
      xml_.check_attributes(*limit, {"lower", "upper", "effort", "velocity", "acceleration", "jerk",
                                     "drake:acceleration"});
      joint.velocity = read_rate(*limit, "velocity").value_or(joint.velocity);
      joint.acceleration = read_rate(*limit, "acceleration");
      if (!joint.acceleration) joint.acceleration = read_rate(*limit, "drake:acceleration");
      joint.jerk = read_rate(*limit, "jerk");
      if (joint.type == JointType::continuous) check_continuous(*limit);
    }
    if (joint.type != JointType::continuous) read_limits(element, joint);
    narrow_limits(element, joint);
    settle_endless(element, joint);
  }

  /// Notes limits of a continuous joint. Zeros and endless ones mean that there are none.
  void check_continuous(const XmlElement& limit) {
    std::vector<double> values;
    for (const char* attribute : {"lower", "upper"}) {
      if (limit.Attribute(attribute) == nullptr) continue;
      values.push_back(parse_number_or_infinity(limit.Attribute(attribute)).value_or(0));
    }
    const bool are_none = std::ranges::all_of(
        values, [](double value) { return value == 0 || std::abs(value) > kFarthestLimit; });
    if (are_none) return;
    xml_.tolerate(limit, "lower and upper of a continuous joint are ignored",
                  "a continuous joint has lower and upper; expected type 'revolute'");
  }

  /// A limit of velocity, acceleration or jerk: nothing if it is missing, infinite or negative.
  std::optional<double> read_rate(const XmlElement& limit, const char* attribute) {
    if (limit.Attribute(attribute) == nullptr) return std::nullopt;
    const std::string text = xml_.text(limit, attribute);
    const double rate =
        text == "nan" || text == "NaN" ? std::nan("") : xml_.number_or_infinity(limit, attribute);
    if (rate >= 0 && std::isfinite(rate)) return rate;
    const char* expected = std::isfinite(rate) ? "0 or more" : "a finite number";
    xml_.tolerate(limit, fmt::format("{} is {} and counts as none", attribute, rate),
                  fmt::format("{} is {}, expected {}", attribute, rate, expected));
    return std::nullopt;
  }

  void read_limits(const XmlElement& element, Joint& joint) {
    const bool is_revolute = joint.type == JointType::revolute;
    const XmlElement* limit = element.FirstChildElement("limit");
    if (limit == nullptr) {
      const bool is_follower = element.FirstChildElement("mimic") != nullptr;
      return xml_.tolerate(element,
                           is_follower ? "no limits" : "no limits, so that the joint stays at 0",
                           "the element <limit> is missing");
    }
    // Values that a joint is assumed to stay within if a limit is infinite.
    const double farthest = is_revolute ? kFarthestTurn : 100;
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    const bool turns = is_endless(*limit, joint);
    joint.lower = turns ? -kEndless : read_limit(*limit, "lower", farthest);
    joint.upper = turns ? kEndless : read_limit(*limit, "upper", farthest);
    if (joint.lower == joint.upper) standing_.push_back(fmt::format("'{}'", joint.name));
  }

  bool is_endless(const XmlElement& limit, const Joint& joint) const {
    if (joint.type != JointType::revolute || xml_.is_strict()) return false;
    const auto value = [&](const char* attribute) {
      return limit.Attribute(attribute) ? xml_.number_or_infinity(limit, attribute) : 0.0;
    };
    return value("lower") < -kFarthestLimit && value("upper") > kFarthestLimit;
  }

  /// A joint with endless limits that no soft limits narrow turns without end.
  void settle_endless(const XmlElement& element, Joint& joint) {
    if (!std::isinf(joint.lower)) return;
    joint.type = JointType::continuous;
    xml_.tolerate(*element.FirstChildElement("limit"),
                  "both limits are infinite, so that the joint counts as continuous", "");
  }

  double read_limit(const XmlElement& limit, const char* attribute, double farthest) {
    if (limit.Attribute(attribute) == nullptr) {
      xml_.tolerate(limit, fmt::format("{} is missing and taken for 0", attribute),
                    fmt::format("attribute '{}' is missing", attribute));
      return 0;
    }
    const double value = xml_.number_or_infinity(limit, attribute);
    if (std::abs(value) <= kFarthestLimit) return value;
    const double taken = std::copysign(farthest, value);
    xml_.tolerate(limit, fmt::format("{} is {:.4g} and taken for {:.4g}", attribute, value, taken),
                  fmt::format("{} is '{}', expected a finite number up to {}", attribute, value,
                              kFarthestLimit));
    return taken;
  }

  void narrow_limits(const XmlElement& element, Joint& joint) {
    const XmlElement* safety = element.FirstChildElement("safety_controller");
    if (safety == nullptr) return;
    xml_.check_attributes(*safety,
                          {"k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit"});
    const bool is_soft =
        safety->Attribute("soft_lower_limit") || safety->Attribute("soft_upper_limit");
    if (!is_soft || options_.hard_limits || element.FirstChildElement("mimic")) return;
    if (joint.type != JointType::continuous) return narrow_to_soft_limits(*safety, joint);
    xml_.tolerate(*safety, "soft limits of a continuous joint are ignored",
                  "a continuous joint has soft limits; expected type 'revolute'");
  }

  /// Soft limits are narrower than hard ones; where they leave no range, they are not meant.
  void narrow_to_soft_limits(const XmlElement& safety, Joint& joint) {
    double lower = joint.lower, upper = joint.upper;
    if (safety.Attribute("soft_lower_limit")) {
      lower = std::max(lower, xml_.number_or_infinity(safety, "soft_lower_limit"));
    }
    if (safety.Attribute("soft_upper_limit")) {
      upper = std::min(upper, xml_.number_or_infinity(safety, "soft_upper_limit"));
    }
    if (lower == joint.lower && upper == joint.upper) return;
    if (lower >= upper) {
      return xml_.tolerate(safety, "its soft limits leave no range and are ignored",
                           "expected soft limits that leave a range");
    }
    joint.lower = std::isinf(lower) ? -kFarthestTurn : lower;
    joint.upper = std::isinf(upper) ? kFarthestTurn : upper;
    narrowed_.push_back(
        fmt::format("'{}' to [{:.6g}, {:.6g}]", joint.name, joint.lower, joint.upper));
  }

  void read_mimic(const XmlElement& element, Joint& joint) {
    const XmlElement* mimic = element.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    xml_.check_attributes(*mimic, {"joint", "multiplier", "offset"});
    joint.mimic.emplace();
    if (mimic->Attribute("multiplier")) joint.mimic->multiplier = xml_.number(*mimic, "multiplier");
    if (mimic->Attribute("offset")) joint.mimic->offset = xml_.number(*mimic, "offset");
  }

  void connect_joints() {
    for (std::size_t i = 0; i < parts_.joints.size(); ++i) {
      joint_indices_.emplace(parts_.joints[i].name, static_cast<int>(i));
    }
    for (std::size_t i = 0; i < parts_.joints.size(); ++i) {
      Joint& joint = parts_.joints[i];
      const XmlElement& element = *joint_elements_[i];
      xml_.set_context(fmt::format("joint '{}'", joint.name));
      joint.parent_link = find_link(element, "parent");
      joint.child_link = find_link(element, "child");
      if (joint.mimic) joint.mimic->joint = find_leader(*element.FirstChildElement("mimic"));
    }
    xml_.set_context("");
  }

  int find_link(const XmlElement& joint, const char* end) {
    const XmlElement& element = xml_.required_child(joint, end);
    xml_.check_attributes(element, {"link"});
    const std::string name = xml_.text(element, "link");
    const auto found = link_indices_.find(name);
    if (found == link_indices_.end()) xml_.fail(element, "there is no link '{}'", name);
    return found->second;
  }

  int find_leader(const XmlElement& mimic) const {
    const std::string name = xml_.text(mimic, "joint");
    const auto found = joint_indices_.find(name);
    if (found == joint_indices_.end()) xml_.fail(mimic, "there is no joint '{}'", name);
    return found->second;
  }

  const std::string& source_;
  const RobotOptions& options_;
  XmlReader xml_;
  MeshFinder meshes_;
  Robot::Parts parts_;
  std::vector<int> link_lines_;
  std::vector<const XmlElement*> joint_elements_;
  std::map<std::string, int> link_indices_, joint_indices_;
  std::vector<std::string> standing_;  ///< joints with limits that leave one value
  std::vector<std::string> narrowed_;  ///< "joint [lower, upper]" of soft limits
};

}  // namespace

Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                               const RobotOptions& options) {
  return without_throwing([&] { return UrdfReader(source, options).read(urdf); });
}

}  // namespace mneme::internal

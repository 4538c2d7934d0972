// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/urdf_reader.h"

#include "base/as_index.h"
#include "robot/robot_tree.h"
#include "robot/xml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace mneme::internal {
namespace {

void add_box(XmlReader& xml, const XmlElement& box, const Transform& pose, Link& link) {
  xml.check_attributes(box, {"size"});
  xml.text(box, "size");
  const Vec3 size = xml.vector(box, "size", Vec3::Zero());
  if (size.minCoeff() <= 0) {
    xml.fail(box, "size is {} {} {}, expected three numbers above 0", size.x(), size.y(), size.z());
  }
  link.solids.push_back(Box{pose, 0.5 * size});
}

void add_cylinder(XmlReader& xml, const XmlElement& cylinder, const Transform& pose, Link& link) {
  xml.check_attributes(cylinder, {"radius", "length"});
  const double radius = xml.positive_number(cylinder, "radius");
  link.solids.push_back(Cylinder{pose, radius, xml.positive_number(cylinder, "length")});
}

void add_mesh(XmlReader& xml, const MeshFinder& meshes, const XmlElement& mesh,
              const Transform& pose, Link& link) {
  xml.check_attributes(mesh, {"filename", "scale"});
  const Vec3 scale = xml.vector(mesh, "scale", Vec3::Ones());
  if ((scale.array() == 0).any()) xml.fail(mesh, "a scale is 0");
  const std::string name = xml.text(mesh, "filename");
  auto path = meshes.find(name);
  if (!path) {
    xml.fail(mesh, fmt::format("'{}': {}", name, path.error().message), path.error().code);
  }
  link.solids.push_back(MeshFile{*std::move(path), scale, pose});
}

void add_sphere(XmlReader& xml, const XmlElement& sphere, const Transform& pose, Link& link) {
  xml.check_attributes(sphere, {"radius"});
  link.spheres.push_back({pose.translation, xml.non_negative_number(sphere, "radius")});
}

void add_capsule(XmlReader& xml, const XmlElement& capsule, const Transform& pose, Link& link) {
  xml.check_attributes(capsule, {"radius", "length"});
  const Vec3 half(0, 0, 0.5 * xml.non_negative_number(capsule, "length"));
  link.capsules.push_back(
      {pose * Vec3(-half), pose * half, xml.non_negative_number(capsule, "radius")});
}

}  // namespace

Transform read_origin(XmlReader& xml, const XmlElement& element) {
  const XmlElement* origin = element.FirstChildElement("origin");
  if (origin == nullptr) return {};
  xml.check_attributes(*origin, {"xyz", "rpy"});
  return {rotation_from_rpy(xml.vector(*origin, "rpy", Vec3::Zero())),
          xml.vector(*origin, "xyz", Vec3::Zero())};
}

void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link) {
  xml.check_children(element, {"origin", "geometry"}, {"material"});
  const Transform pose = read_origin(xml, element);
  const XmlElement& geometry = xml.required_child(element, "geometry");
  xml.check_children(geometry, {"sphere", "capsule", "box", "cylinder", "mesh"}, {});
  const XmlElement* shape = geometry.FirstChildElement();
  if (shape == nullptr || shape->NextSiblingElement() != nullptr) {
    xml.fail(geometry, "expected exactly one shape");
  }
  const std::string_view kind = shape->Name();
  if (kind == "sphere") add_sphere(xml, *shape, pose, link);
  if (kind == "capsule") add_capsule(xml, *shape, pose, link);
  if (kind == "box") add_box(xml, *shape, pose, link);
  if (kind == "cylinder") add_cylinder(xml, *shape, pose, link);
  if (kind == "mesh") add_mesh(xml, meshes, *shape, pose, link);
}

namespace {

/// Reads the parts of a robot and keeps their lines for messages.
class UrdfReader {
 public:
  UrdfReader(const std::string& source, const std::vector<std::string>& package_paths)
      : xml_(source), meshes_(source, package_paths) {}

  Robot::Parts read(std::string_view urdf);

 private:
  void read_link(const XmlElement& element);
  void read_joint(const XmlElement& element);
  JointType read_type(const XmlElement& element) const;
  void read_motion(const XmlElement& element, Joint& joint) const;
  void read_mimic(const XmlElement& element, Joint& joint) const;
  void connect_joints();
  int find_link(const XmlElement& joint, const char* end) const;
  int find_leader(const XmlElement& mimic) const;

  XmlReader xml_;
  MeshFinder meshes_;
  Robot::Parts parts_;
  std::vector<int> link_lines_;
  std::vector<const XmlElement*> joint_elements_;
  std::map<std::string, int> link_indices_;
};

Robot::Parts UrdfReader::read(std::string_view urdf) {
  tinyxml2::XMLDocument document;
  const XmlElement& robot = xml_.read_root(document, urdf, "robot");
  parts_.name = xml_.text(robot, "name");
  xml_.check_children(
      robot, {}, {"link", "joint", "material", "gazebo", "transmission", "ros2_control", "sensor"});
  for (const XmlElement* child : children(robot)) {
    if (child->Name() == std::string_view("link")) read_link(*child);
    if (child->Name() == std::string_view("joint")) read_joint(*child);
    xml_.set_context("");
  }
  connect_joints();
  auto sorted = sort_tree(std::move(parts_));
  if (sorted) return *std::move(sorted);
  const PartsFault& fault = sorted.error();
  int line = robot.GetLineNum();
  if (fault.link >= 0) line = link_lines_[as_index(fault.link)];
  if (fault.joint >= 0) line = joint_elements_[as_index(fault.joint)]->GetLineNum();
  xml_.fail(line, fault.message);
}

void UrdfReader::read_link(const XmlElement& element) {
  Link link;
  link.name = xml_.text(element, "name");
  xml_.set_context(fmt::format("link '{}'", link.name));
  // <contact> holds friction and damping.
  xml_.check_children(element, {}, {"collision", "visual", "inertial", "contact", "gazebo"});
  for (const XmlElement* collision : children(element, "collision")) {
    read_collision(xml_, meshes_, *collision, link);
  }
  link_indices_.emplace(link.name, static_cast<int>(parts_.links.size()));
  link_lines_.push_back(element.GetLineNum());
  parts_.links.push_back(std::move(link));
}

JointType UrdfReader::read_type(const XmlElement& element) const {
  const std::string type = xml_.text(element, "type");
  for (const JointType known :
       {JointType::fixed, JointType::revolute, JointType::continuous, JointType::prismatic}) {
    if (type == to_string(known)) return known;
  }
  const bool is_of_urdf = type == "planar" || type == "floating";
  xml_.fail(element,
            fmt::format("type '{}' is {}; expected fixed, revolute, continuous or prismatic", type,
                        is_of_urdf ? "not supported" : "unknown"),
            is_of_urdf ? ErrorCode::unsupported : ErrorCode::parse);
}

void UrdfReader::read_joint(const XmlElement& element) {
  Joint joint;
  joint.name = xml_.text(element, "name");
  xml_.set_context(fmt::format("joint '{}'", joint.name));
  xml_.check_children(element, {"origin", "parent", "child", "axis", "limit", "mimic"},
                      {"dynamics", "safety_controller", "calibration", "gazebo"});
  joint.type = read_type(element);
  joint.origin = read_origin(xml_, element);
  if (joint.type != JointType::fixed) {
    read_motion(element, joint);
    read_mimic(element, joint);
  }
  joint_elements_.push_back(&element);
  parts_.joints.push_back(std::move(joint));
}

void UrdfReader::read_motion(const XmlElement& element, Joint& joint) const {
  if (const XmlElement* axis = element.FirstChildElement("axis")) {
    xml_.check_attributes(*axis, {"xyz"});
    xml_.text(*axis, "xyz");
    joint.axis = xml_.vector(*axis, "xyz", joint.axis);
  }
  const bool is_continuous = joint.type == JointType::continuous;
  if (is_continuous && !element.FirstChildElement("limit")) return;
  const XmlElement& limit = xml_.required_child(element, "limit");
  xml_.check_attributes(limit, {"lower", "upper", "effort", "velocity", "acceleration", "jerk"});
  if (limit.Attribute("velocity")) joint.velocity = xml_.non_negative_number(limit, "velocity");
  if (limit.Attribute("acceleration")) {
    joint.acceleration = xml_.non_negative_number(limit, "acceleration");
  }
  if (is_continuous) return;
  joint.lower = xml_.number(limit, "lower");
  joint.upper = xml_.number(limit, "upper");
}

void UrdfReader::read_mimic(const XmlElement& element, Joint& joint) const {
  const XmlElement* mimic = element.FirstChildElement("mimic");
  if (mimic == nullptr) return;
  xml_.check_attributes(*mimic, {"joint", "multiplier", "offset"});
  joint.mimic.emplace();
  if (mimic->Attribute("multiplier")) joint.mimic->multiplier = xml_.number(*mimic, "multiplier");
  if (mimic->Attribute("offset")) joint.mimic->offset = xml_.number(*mimic, "offset");
}

void UrdfReader::connect_joints() {
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

int UrdfReader::find_link(const XmlElement& joint, const char* end) const {
  const XmlElement& element = xml_.required_child(joint, end);
  xml_.check_attributes(element, {"link"});
  const std::string name = xml_.text(element, "link");
  const auto found = link_indices_.find(name);
  if (found == link_indices_.end()) xml_.fail(element, "there is no link '{}'", name);
  return found->second;
}

int UrdfReader::find_leader(const XmlElement& mimic) const {
  const std::string name = xml_.text(mimic, "joint");
  const auto found = std::ranges::find(parts_.joints, name, &Joint::name);
  if (found == parts_.joints.end()) xml_.fail(mimic, "there is no joint '{}'", name);
  return static_cast<int>(found - parts_.joints.begin());
}

}  // namespace

Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                               const std::vector<std::string>& package_paths) {
  return without_throwing([&] { return UrdfReader(source, package_paths).read(urdf); });
}

}  // namespace mneme::internal

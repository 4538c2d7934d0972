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
    xml.note(box.GetLineNum(),
             fmt::format("<box>: size is {} {} {}, expected three numbers above 0", size.x(),
                         size.y(), size.z()));
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
  if ((scale.array() == 0).any()) xml.note(mesh.GetLineNum(), "<mesh>: a scale is 0");
  const std::string name = xml.text(mesh, "filename");
  if (xml.fault()) return;
  auto path = meshes.find(name);
  if (path) {
    link.solids.push_back(MeshFile{*std::move(path), scale, pose});
  } else {
    xml.note(mesh.GetLineNum(), fmt::format("<mesh>: '{}': {}", name, path.error().message),
             path.error().code);
  }
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
  const XmlElement* geometry = xml.required_child(element, "geometry");
  if (geometry == nullptr) return;
  xml.check_children(*geometry, {"sphere", "capsule", "box", "cylinder", "mesh"}, {});
  const XmlElement* shape = geometry->FirstChildElement();
  if (shape == nullptr || shape->NextSiblingElement() != nullptr) {
    xml.note(geometry->GetLineNum(), "<geometry>: expected exactly one shape");
    return;
  }
  const std::string_view kind = shape->Name();
  if (kind == "sphere") add_sphere(xml, *shape, pose, link);
  if (kind == "capsule") add_capsule(xml, *shape, pose, link);
  if (kind == "box") add_box(xml, *shape, pose, link);
  if (kind == "cylinder") add_cylinder(xml, *shape, pose, link);
  if (kind == "mesh") add_mesh(xml, meshes, *shape, pose, link);
}

namespace {

/// Reads the parts of a robot from URDF, and remembers the lines on which they stand.
class UrdfReader {
 public:
  UrdfReader(const std::string& source, const std::vector<std::string>& package_paths)
      : xml_(source), meshes_(source, package_paths) {}

  Result<Robot::Parts> read(std::string_view urdf);

 private:
  void read_robot(const XmlElement& element);
  void read_link(const XmlElement& element);
  void read_joint(const XmlElement& element);
  JointType read_type(const XmlElement& element);
  void read_motion(const XmlElement& element, Joint& joint);
  void read_rates(const XmlElement& limit, Joint& joint);
  void read_mimic(const XmlElement& element, Joint& joint);
  void connect_joints();
  int find_link(const XmlElement& joint, const char* end);
  int find_leader(const XmlElement& mimic);
  Result<Robot::Parts> sorted();

  XmlReader xml_;
  MeshFinder meshes_;
  Robot::Parts parts_;
  int robot_line_ = 1;
  std::vector<int> link_lines_;
  std::vector<const XmlElement*> joint_elements_;
  std::map<std::string, int> link_indices_;
};

Result<Robot::Parts> UrdfReader::read(std::string_view urdf) {
  tinyxml2::XMLDocument document;
  if (urdf.size() > kMaxRobotTextSize) xml_.note(1, "the text is longer than 64 MB");
  const XmlElement* robot = xml_.fault() ? nullptr : xml_.read_root(document, urdf, "robot");
  if (robot != nullptr) read_robot(*robot);
  return xml_.fault() ? tl::unexpected(*xml_.fault()) : sorted();
}

void UrdfReader::read_robot(const XmlElement& element) {
  robot_line_ = element.GetLineNum();
  parts_.name = xml_.text(element, "name");
  xml_.check_children(
      element, {},
      {"link", "joint", "material", "gazebo", "transmission", "ros2_control", "sensor"});
  for (const auto* child = element.FirstChildElement(); child;
       child = child->NextSiblingElement()) {
    if (xml_.fault()) return;
    if (child->Name() == std::string_view("link")) read_link(*child);
    if (child->Name() == std::string_view("joint")) read_joint(*child);
    xml_.set_context("");
  }
  connect_joints();
}

void UrdfReader::read_link(const XmlElement& element) {
  Link link;
  link.name = xml_.text(element, "name");
  xml_.set_context(fmt::format("link '{}'", link.name));
  // <contact> holds friction and damping.
  xml_.check_children(element, {}, {"collision", "visual", "inertial", "contact", "gazebo"});
  for (const auto* collision = element.FirstChildElement("collision"); collision;
       collision = collision->NextSiblingElement("collision")) {
    read_collision(xml_, meshes_, *collision, link);
  }
  link_indices_.emplace(link.name, static_cast<int>(parts_.links.size()));
  link_lines_.push_back(element.GetLineNum());
  parts_.links.push_back(std::move(link));
}

JointType UrdfReader::read_type(const XmlElement& element) {
  const std::string type = xml_.text(element, "type");
  if (type == "fixed") return JointType::fixed;
  if (type == "revolute") return JointType::revolute;
  if (type == "continuous") return JointType::continuous;
  if (type == "prismatic") return JointType::prismatic;
  const bool is_known = type == "planar" || type == "floating";
  xml_.note(element.GetLineNum(),
            fmt::format("<joint>: type '{}' is {}; expected fixed, revolute, continuous or "
                        "prismatic",
                        type, is_known ? "not supported" : "unknown"),
            is_known ? ErrorCode::unsupported : ErrorCode::parse);
  return JointType::fixed;
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

void UrdfReader::read_motion(const XmlElement& element, Joint& joint) {
  if (const XmlElement* axis = element.FirstChildElement("axis")) {
    xml_.check_attributes(*axis, {"xyz"});
    xml_.text(*axis, "xyz");
    joint.axis = xml_.vector(*axis, "xyz", joint.axis);
  }
  const bool is_continuous = joint.type == JointType::continuous;
  const XmlElement* limit =
      is_continuous ? element.FirstChildElement("limit") : xml_.required_child(element, "limit");
  if (limit == nullptr) return;
  xml_.check_attributes(*limit, {"lower", "upper", "effort", "velocity", "acceleration", "jerk"});
  read_rates(*limit, joint);
  if (is_continuous) return;
  joint.lower = xml_.number(*limit, "lower");
  joint.upper = xml_.number(*limit, "upper");
}

void UrdfReader::read_rates(const XmlElement& limit, Joint& joint) {
  if (limit.Attribute("velocity")) joint.velocity = xml_.non_negative_number(limit, "velocity");
  if (limit.Attribute("acceleration")) {
    joint.acceleration = xml_.non_negative_number(limit, "acceleration");
  }
}

void UrdfReader::read_mimic(const XmlElement& element, Joint& joint) {
  const XmlElement* mimic = element.FirstChildElement("mimic");
  if (mimic == nullptr) return;
  xml_.check_attributes(*mimic, {"joint", "multiplier", "offset"});
  joint.mimic.emplace();
  if (mimic->Attribute("multiplier")) joint.mimic->multiplier = xml_.number(*mimic, "multiplier");
  if (mimic->Attribute("offset")) joint.mimic->offset = xml_.number(*mimic, "offset");
}

void UrdfReader::connect_joints() {
  for (std::size_t i = 0; i < parts_.joints.size() && !xml_.fault(); ++i) {
    xml_.set_context(fmt::format("joint '{}'", parts_.joints[i].name));
    parts_.joints[i].parent_link = find_link(*joint_elements_[i], "parent");
    parts_.joints[i].child_link = find_link(*joint_elements_[i], "child");
    if (parts_.joints[i].mimic) {
      parts_.joints[i].mimic->joint = find_leader(*joint_elements_[i]->FirstChildElement("mimic"));
    }
  }
  xml_.set_context("");
}

int UrdfReader::find_link(const XmlElement& joint, const char* end) {
  const XmlElement* element = xml_.required_child(joint, end);
  if (element == nullptr) return -1;
  xml_.check_attributes(*element, {"link"});
  const std::string name = xml_.text(*element, "link");
  const auto found = link_indices_.find(name);
  if (found != link_indices_.end()) return found->second;
  xml_.note(element->GetLineNum(), fmt::format("<{}>: there is no link '{}'", end, name));
  return -1;
}

int UrdfReader::find_leader(const XmlElement& mimic) {
  const std::string name = xml_.text(mimic, "joint");
  const auto found = std::ranges::find(parts_.joints, name, &Joint::name);
  if (found != parts_.joints.end()) return static_cast<int>(found - parts_.joints.begin());
  xml_.note(mimic.GetLineNum(), fmt::format("<mimic>: there is no joint '{}'", name));
  return -1;
}

Result<Robot::Parts> UrdfReader::sorted() {
  auto result = sort_tree(std::move(parts_));
  if (result) return std::move(*result);
  const PartsFault& fault = result.error();
  int line = robot_line_;
  if (fault.link >= 0) line = link_lines_[as_index(fault.link)];
  if (fault.joint >= 0) line = joint_elements_[as_index(fault.joint)]->GetLineNum();
  xml_.note(line, fault.message);
  return tl::unexpected(*xml_.fault());
}

}  // namespace

Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                               const std::vector<std::string>& package_paths) {
  return UrdfReader(source, package_paths).read(urdf);
}

}  // namespace mneme::internal

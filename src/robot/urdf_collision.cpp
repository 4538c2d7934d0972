// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/urdf_collision.h"

#include <string>

#include <fmt/format.h>

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

}  // namespace mneme::internal

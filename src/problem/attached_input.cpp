// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "problem/problem_input.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

namespace mneme::internal {
namespace {

constexpr std::array<std::string_view, 3> kObjectKeys{"name", "link", "touch"};

class AttachedReader {
 public:
  AttachedReader(const ObstacleSpelling& spelling, const std::string& directory, const Robot& robot)
      : object_spelling_(spelling),
        shape_spelling_(spelling),
        directory_(directory),
        robot_(robot) {
    object_spelling_.naming = kObjectKeys;
    shape_spelling_.naming = {};
    for (const Link& link : robot.links()) links_.insert(link.name);
  }

  std::vector<AttachedObject> read(const Input& list) {
    std::vector<AttachedObject> objects;
    for (const Input& item : list.items()) objects.push_back(read_object(item));
    for (const Input& item : list.items()) check_touching(item);
    return objects;
  }

 private:
  AttachedObject read_object(const Input& item) {
    AttachedObject object{read_name(item.at("name")), item.at("link").text(), {}};
    if (!links_.contains(object.link)) {
      item.at("link").fail(ErrorCode::invalid,
                           "expected a link of robot {} to carry \"{}\", got \"{}\"", robot_.name(),
                           object.name, object.link);
    }
    for (const Input& name : item.items("touch")) object.may_touch.push_back(name.text());
    if (const auto shapes = item.find("shapes")) {
      item.allow_keys({"name", "link", "touch", "shapes"});
      for (const Input& shape : shapes->items()) read_into(shape, shape_spelling_, object);
      if (shapes->items().empty()) shapes->fail_expecting("at least one shape");
    } else {
      read_into(item, object_spelling_, object);
    }
    return object;
  }

  std::string read_name(const Input& input) {
    std::string name = input.text();
    if (name.empty()) input.fail_expecting("a name");
    if (links_.contains(name) || !names_.insert(name).second) {
      input.fail(ErrorCode::invalid, "expected a unique name, got \"{}\", which names {}", name,
                 links_.contains(name) ? "a link" : "another attached object");
    }
    return name;
  }

  void read_into(const Input& input, const ObstacleSpelling& spelling, AttachedObject& object) {
    refuse_file(input, spelling);
    const Input type = input.at("type");
    if (type.is_text() && type.text() == "mesh" && !input.find("triangles")) {
      object.meshes.push_back(read_mesh(input, spelling));
    } else {
      object.shapes.push_back(read_shape(input, spelling));
    }
  }

  MeshFile read_mesh(const Input& input, const ObstacleSpelling& spelling) const {
    std::vector<std::string_view> keys = {"type", "file", "scale", spelling.position,
                                          spelling.quaternion};
    keys.insert(keys.end(), spelling.naming.begin(), spelling.naming.end());
    input.allow_keys(keys);
    MeshFile mesh;
    mesh.path = (std::filesystem::path(directory_) / input.at("file").text()).string();
    if (const auto scale = input.find("scale")) mesh.scale = read_scale(*scale);
    if (const auto position = input.find(spelling.position)) {
      mesh.pose.translation = read_point(*position);
    }
    if (const auto quaternion = input.find(spelling.quaternion)) {
      mesh.pose.rotation = read_rotation(*quaternion, spelling.is_scalar_first);
    }
    return mesh;
  }

  static Vec3 read_scale(const Input& input) {
    if (!input.is_list()) return Vec3::Constant(input.positive_number());
    for (const Input& factor : input.items()) static_cast<void>(factor.positive_number());
    return read_point(input);
  }

  void check_touching(const Input& item) const {
    for (const Input& name : item.items("touch")) {
      if (links_.contains(name.text()) || names_.contains(name.text())) continue;
      name.fail(ErrorCode::invalid, "expected a link of robot {} or an attached object, got \"{}\"",
                robot_.name(), name.text());
    }
  }

  ObstacleSpelling object_spelling_, shape_spelling_;
  const std::string& directory_;
  const Robot& robot_;
  std::set<std::string> links_, names_;
};

}  // namespace

std::vector<AttachedObject> read_attached(const Input& problem, const ObstacleSpelling& spelling,
                                          const std::string& directory, const Robot& robot) {
  const auto list = problem.find("attached");
  if (!list) return {};
  return AttachedReader(spelling, directory, robot).read(*list);
}

Robot attach_to(const Robot& robot, std::vector<AttachedObject> objects, const Input& place) {
  if (objects.empty()) return robot;
  return place.take(attach(robot, std::move(objects)));
}

}  // namespace mneme::internal

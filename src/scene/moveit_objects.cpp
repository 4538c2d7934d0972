// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_objects.h"

#include "scene/moveit_pose.h"
#include "scene/moveit_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace mneme::internal {
namespace {

std::vector<double> read_dimensions(const Input& primitive, std::size_t count,
                                    std::string_view what) {
  const Input dimensions = primitive.at("dimensions");
  const std::vector<double> values = dimensions.finite_numbers(count, what);
  for (const Input& value : dimensions.items()) {
    static_cast<void>(value.positive_number());
  }
  return values;
}

Shape read_shape(const Input& primitive, const Transform& pose, const std::string& object) {
  primitive.allow_keys({"type", "dimensions", "polygon"});
  const Input type = primitive.at("type");
  const std::string name = type.is_text() ? type.text() : "";
  if (name == "box" || name == "1") {
    const auto size = read_dimensions(primitive, 3, "full extents along x, y, z in metres");
    return Box{pose, 0.5 * Vec3(size[0], size[1], size[2])};
  }
  if (name == "sphere" || name == "2") {
    return Sphere{pose.translation, read_dimensions(primitive, 1, "a radius in metres")[0]};
  }
  if (name == "cylinder" || name == "3") {
    const auto size = read_dimensions(primitive, 2, "height and radius in metres");
    return Cylinder{pose, size[1], size[0]};
  }
  if (name == "cone" || name == "4" || name == "prism" || name == "5") {
    const bool is_cone = name == "cone" || name == "4";
    type.fail(ErrorCode::unsupported,
              fmt::format("object \"{}\" has a {}, which is not supported; expected box, sphere or "
                          "cylinder",
                          object, is_cone ? "cone" : "prism"));
  }
  type.fail_expecting("box, sphere or cylinder");
}

void refuse(const Input& object, std::string_view key, const std::string& id) {
  if (!items_if_any(object, key).empty()) {
    object.at(key).fail(ErrorCode::unsupported,
                        fmt::format("object \"{}\" has {}, which are not supported; expected "
                                    "primitives alone",
                                    id, key));
  }
}

void refuse_operation(const Input& object, const std::string& id) {
  const auto operation = object.find("operation");
  if (!operation) {
    return;
  }
  const std::string name = operation->is_text() ? operation->text() : "";
  if (name != "0" && name != "add" && name != "ADD") {
    operation->fail(ErrorCode::unsupported,
                    fmt::format("object \"{}\": expected the operation add, got \"{}\"", id, name));
  }
}

MoveitObject read_object(const Input& object) {
  object.allow_keys({"header", "id", "type", "pose", "primitives", "primitive_poses", "meshes",
                     "mesh_poses", "planes", "plane_poses", "subframe_names", "subframe_poses",
                     "operation"});
  const std::string id = object.at("id").text();
  if (id.empty()) {
    object.at("id").fail_expecting("a name");
  }
  refuse(object, "meshes", id);
  refuse(object, "planes", id);
  refuse_operation(object, id);
  const auto pose = object.find("pose");
  const Transform X_FO = pose ? read_moveit_pose(*pose) : Transform{};
  const std::vector<Input> primitives = items_if_any(object, "primitives");
  const std::vector<Input> poses = items_if_any(object, "primitive_poses");
  const bool is_posed_as_one = poses.empty() && pose.has_value();
  if (primitives.empty() || (poses.size() != primitives.size() && !is_posed_as_one)) {
    object.fail(ErrorCode::parse,
                fmt::format("object \"{}\": expected one pose per primitive and at least one "
                            "primitive, got {} primitives and {} poses",
                            id, primitives.size(), poses.size()));
  }
  MoveitObject result{{id, {}}, read_frame_id(object), object};
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Transform X_OS = poses.empty() ? Transform{} : read_moveit_pose(poses[i]);
    result.obstacle.shapes.push_back(read_shape(primitives[i], X_FO * X_OS, id));
  }
  return result;
}

}  // namespace

std::vector<MoveitObject> read_moveit_objects(const Input& world) {
  world.allow_keys({"collision_objects", "octomap"});
  if (const auto octomap = world.find("octomap"); octomap && octomap->is_map()) {
    const auto map = octomap->find("octomap");
    if (map && map->is_map() && !items_if_any(*map, "data").empty()) {
      octomap->fail(ErrorCode::unsupported, "expected no octomap: octomaps are not supported");
    }
  }
  std::vector<MoveitObject> objects;
  std::set<std::string> names;
  for (const Input& object : items_if_any(world, "collision_objects")) {
    objects.push_back(read_object(object));
    if (!names.insert(objects.back().obstacle.name).second) {
      object.fail(ErrorCode::parse, fmt::format("expected a name of its own, got \"{}\" again",
                                                objects.back().obstacle.name));
    }
  }
  return objects;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_messages.h"

#include "scene/moveit_compounds.h"
#include "scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>

namespace mneme::internal {

Vec3 read_moveit_point(const Input& input) {
  if (!input.is_map()) return read_point(input);
  input.allow_keys({"x", "y", "z"});
  return {input.at("x").finite_number(), input.at("y").finite_number(),
          input.at("z").finite_number()};
}

Eigen::Matrix3d read_moveit_rotation(const Input& input) {
  if (!input.is_map()) return read_rotation(input, false);
  input.allow_keys({"x", "y", "z", "w"});
  return rotation_of(input, {input.at("x").finite_number(), input.at("y").finite_number(),
                             input.at("z").finite_number(), input.at("w").finite_number()});
}

namespace {

Transform read(const Input& input, std::string_view vector, std::string_view quaternion) {
  input.allow_keys({vector, quaternion});
  Transform X;
  X.translation = read_moveit_point(input.at(vector));
  if (const auto rotation = input.find(quaternion)) X.rotation = read_moveit_rotation(*rotation);
  return X;
}

}  // namespace

Transform read_moveit_pose(const Input& input) { return read(input, "position", "orientation"); }

Transform read_moveit_transform(const Input& input) {
  return read(input, "translation", "rotation");
}

namespace {

void read_positions(const Input& input, MoveitState& state) {
  input.allow_keys({"header", "name", "position", "velocity", "effort"});
  const std::vector<Input> names = items_if_any(input, "name");
  const std::vector<Input> positions = items_if_any(input, "position");
  if (names.size() != positions.size()) {
    input.fail(ErrorCode::parse,
               fmt::format("expected one position per name, got {} names and {} positions",
                           names.size(), positions.size()));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_new =
        state.positions.emplace(names[i].text(), positions[i].finite_number()).second;
    if (!is_new) {
      names[i].fail(ErrorCode::parse,
                    fmt::format("expected each joint once, got {} again", names[i].text()));
    }
  }
}

void read_base(const Input& input, MoveitState& state) {
  input.allow_keys({"header", "joint_names", "transforms", "twist", "wrench"});
  const std::vector<Input> names = items_if_any(input, "joint_names");
  const std::vector<Input> transforms = items_if_any(input, "transforms");
  if (names.empty() && transforms.empty()) return;
  if (names.size() != 1 || transforms.size() != 1) {
    input.fail(names.size() == transforms.size() ? ErrorCode::unsupported : ErrorCode::parse,
               fmt::format("expected one virtual joint that carries the robot's root link, got {} "
                           "names and {} transforms",
                           names.size(), transforms.size()));
  }
  state.base = read_moveit_transform(transforms.front());
  state.base_frame = read_frame_id(input);
}

}  // namespace

std::vector<Input> items_if_any(const Input& input, std::string_view key) {
  const auto list = input.find(key);
  return list && !list->is_nothing() ? list->items() : std::vector<Input>();
}

std::string read_frame_id(const Input& input) {
  const auto header = input.find("header");
  const auto frame = header ? header->find("frame_id") : std::nullopt;
  if (!frame) {
    return {};
  }
  // Older files write the same frame with a slash in front.
  const std::string name = frame->text();
  return name.starts_with('/') ? name.substr(1) : name;
}

namespace {

std::vector<double> read_dimensions(const Input& primitive, std::size_t count,
                                    std::string_view what) {
  const Input dimensions = primitive.at("dimensions");
  const std::vector<double> values = dimensions.finite_numbers(count, what);
  for (const Input& value : dimensions.items()) static_cast<void>(value.positive_number());
  return values;
}

}  // namespace

Shape read_moveit_primitive(const Input& primitive, const Transform& pose, std::string_view owner) {
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
              fmt::format("{} has a {}, which is not supported; expected box, sphere or cylinder",
                          owner, is_cone ? "cone" : "prism"));
  }
  type.fail_expecting("box, sphere or cylinder");
}

namespace {

/// Adds the shapes of the list `key`, each at its pose of `pose_key`, or all at that of the object.
template <class Read>
void add_shapes(const Input& object, std::string_view key, std::string_view pose_key,
                const Transform& X_FO, const Read& read_one, MoveitObject& result) {
  const std::vector<Input> shapes = items_if_any(object, key);
  const std::vector<Input> poses = items_if_any(object, pose_key);
  const bool is_posed_as_one = poses.empty() && object.find("pose");
  if (poses.size() != shapes.size() && !is_posed_as_one) {
    object.fail(ErrorCode::parse,
                fmt::format("object \"{}\": expected one pose per shape, got {} {} and {} poses",
                            result.obstacle.name, shapes.size(), key, poses.size()));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Transform X_OS = poses.empty() ? Transform{} : read_moveit_pose(poses[i]);
    result.obstacle.shapes.push_back(read_one(shapes[i], X_FO * X_OS));
  }
}

void refuse_operation(const Input& object, const std::string& id) {
  const auto operation = object.find("operation");
  if (!operation) return;
  const std::string name = operation->is_text() ? operation->text() : "";
  if (name != "0" && name != "add" && name != "ADD") {
    operation->fail(ErrorCode::unsupported,
                    fmt::format("object \"{}\": expected the operation add, got \"{}\"", id, name));
  }
}

/// Without shapes only if it is that of an object elsewhere.
MoveitObject read_object(const Input& object, bool may_be_empty = false) {
  object.allow_keys({"header", "id", "type", "pose", "primitives", "primitive_poses", "meshes",
                     "mesh_poses", "planes", "plane_poses", "subframe_names", "subframe_poses",
                     "operation"});
  const std::string id = object.at("id").text();
  if (id.empty()) object.at("id").fail_expecting("a name");
  refuse_operation(object, id);
  const auto pose = object.find("pose");
  const Transform X_FO = pose ? read_moveit_pose(*pose) : Transform{};
  MoveitObject result{{id, {}}, read_frame_id(object), object};
  const auto primitive = [&](const Input& input, const Transform& X_FS) {
    return read_moveit_primitive(input, X_FS, fmt::format("object \"{}\"", id));
  };
  add_shapes(object, "primitives", "primitive_poses", X_FO, primitive, result);
  add_shapes(object, "meshes", "mesh_poses", X_FO, read_moveit_mesh, result);
  add_shapes(object, "planes", "plane_poses", X_FO, read_moveit_plane, result);
  result.plane_count = items_if_any(object, "planes").size();
  if (result.obstacle.shapes.empty() && !may_be_empty) {
    object.fail(ErrorCode::parse,
                fmt::format("object \"{}\": expected at least one primitive, mesh or plane", id));
  }
  return result;
}

MoveitAttached read_attached(const Input& attached) {
  attached.allow_keys({"link_name", "object", "touch_links", "detach_posture", "weight"});
  MoveitAttached result{
      read_object(attached.at("object"), true), attached.at("link_name").text(), {}};
  for (const Input& link : items_if_any(attached, "touch_links")) {
    result.touch_links.push_back(link.text());
  }
  return result;
}

/// The last one must not have the name of another.
void refuse_twice(const std::vector<MoveitAttached>& attached) {
  const MoveitObject& last = attached.back().object;
  for (const MoveitAttached& other : std::span(attached).first(attached.size() - 1)) {
    if (other.object.obstacle.name != last.obstacle.name) continue;
    last.place.fail(ErrorCode::parse, fmt::format("expected a name of its own, got \"{}\" again",
                                                  last.obstacle.name));
  }
}

}  // namespace

MoveitState read_moveit_state(const Input& input) {
  input.allow_keys(
      {"joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff"});
  MoveitState state;
  if (const auto joints = input.find("joint_state")) read_positions(*joints, state);
  if (const auto base = input.find("multi_dof_joint_state")) read_base(*base, state);
  for (const Input& attached : items_if_any(input, "attached_collision_objects")) {
    state.attached.push_back(read_attached(attached));
    refuse_twice(state.attached);
  }
  return state;
}

MoveitState overlaid(MoveitState state, const MoveitState& difference) {
  for (const auto& [joint, position] : difference.positions) state.positions[joint] = position;
  if (difference.base) {
    state.base = difference.base;
    state.base_frame = difference.base_frame;
  }
  for (const MoveitAttached& attached : difference.attached) {
    std::erase_if(state.attached, [&](const MoveitAttached& other) {
      return other.object.obstacle.name == attached.object.obstacle.name;
    });
    state.attached.push_back(attached);
  }
  return state;
}

std::vector<MoveitObject> read_moveit_objects(const Input& world) {
  world.allow_keys({"collision_objects", "octomap"});
  std::vector<MoveitObject> objects;
  std::set<std::string> names;
  if (const auto octomap = world.find("octomap")) {
    if (auto octree = read_moveit_octomap(*octomap)) {
      objects.push_back({{"octomap", {std::move(*octree)}}, read_frame_id(*octomap), *octomap});
      names.insert("octomap");
    }
  }
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

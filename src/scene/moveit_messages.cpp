// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "mesh/line_reader.h"
#include "scene/compound_files.h"
#include "scene/moveit_scene.h"
#include "scene/scene_input.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>

namespace mneme::internal {

Eigen::Matrix3d read_moveit_rotation(const Input& input) {
  if (!input.is_map()) return read_rotation(input, false);
  input.allow_keys({"x", "y", "z", "w"});
  const auto component = [&](std::string_view key) {
    const auto value = input.find(key);
    return value ? value->finite_number() : 0;  // {w: 1} is common
  };
  return rotation_of(
      input, {component("x"), component("y"), component("z"), input.at("w").finite_number()});
}

namespace {

/// A list of three numbers, or the keys x, y and z.
Vec3 read_vector(const Input& input) {
  if (!input.is_map()) return read_point(input);
  input.allow_keys({"x", "y", "z"});
  return {input.at("x").finite_number(), input.at("y").finite_number(),
          input.at("z").finite_number()};
}

/// An unset orientation of a pose in ROS 1 is all zeros; MoveIt reads it as the identity.
bool is_unset(const Input& rotation) {
  const auto is_zero = [&](std::string_view key) {
    const auto value = rotation.find(key);
    return value && value->is_number() && value->number() == 0;
  };
  return rotation.is_map() && is_zero("x") && is_zero("y") && is_zero("z") && is_zero("w");
}

Transform read(const Input& input, std::string_view vector, std::string_view quaternion) {
  input.allow_keys({vector, quaternion});
  Transform X;
  X.translation = read_vector(input.at(vector));
  const auto rotation = input.find(quaternion);
  if (rotation && !is_unset(*rotation)) X.rotation = read_moveit_rotation(*rotation);
  return X;
}

}  // namespace

Transform read_moveit_pose(const Input& input) { return read(input, "position", "orientation"); }

Transform read_moveit_transform(const Input& input) {
  return read(input, "translation", "rotation");
}

namespace {

/// Reads the lists of the keys `name` and `value` as a map from joints to values.
template <class Value, class Read>
void read_by_joint(const Input& input, std::string_view name, std::string_view value,
                   const Read& read_value, std::map<std::string, Value>& values) {
  const std::vector<Input> names = input.items(name), items = input.items(value);
  if (names.size() != items.size()) {
    input.fail(ErrorCode::parse, "expected as many entries in {} as in {}, got {} and {}", value,
               name, items.size(), names.size());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (values.emplace(names[i].text(), read_value(items[i])).second) continue;
    names[i].fail(ErrorCode::parse, "expected each joint once, got {} again", names[i].text());
  }
}

}  // namespace

std::string read_frame_id(const Input& input) {
  const auto header = input.find("header");
  const auto frame = header ? header->find("frame_id") : std::nullopt;
  if (!frame) {
    return {};
  }
  // Older files write a leading slash.
  const std::string name = frame->text();
  return name.starts_with('/') ? name.substr(1) : name;
}

namespace {

std::vector<double> read_dimensions(const Input& primitive, std::size_t count,
                                    std::string_view what) {
  const Input dimensions = primitive.at("dimensions");
  std::vector<double> values = dimensions.finite_numbers(count, what);
  std::ranges::transform(dimensions.items(), values.begin(), read_size);
  return values;
}

}  // namespace

Shape read_moveit_primitive(const Input& primitive, const Transform& pose, std::string_view owner) {
  primitive.allow_keys({"type", "dimensions", "polygon"});
  const Input type = primitive.at("type");
  const std::string name = type.is_text() ? lower_case(type.text()) : "";
  if (name == "box" || name == "1") {
    const auto size = read_dimensions(primitive, 3, "full extents along x, y, z in metres");
    return Box{pose, 0.5 * Vec3(size[0], size[1], size[2])};
  }
  if (name == "sphere" || name == "2") {
    return Sphere{pose.translation, read_dimensions(primitive, 1, "a radius in metres")[0]};
  }
  const bool is_cone = name == "cone" || name == "4";
  if (is_cone) type.warn(std::string(kConeFault));
  if (is_cone || name == "cylinder" || name == "3") {
    const auto size = read_dimensions(primitive, 2, "height and radius in metres");
    return Cylinder{pose, size[1], size[0]};
  }
  if (name == "prism" || name == "5") {
    type.fail(ErrorCode::unsupported,
              "{} has a prism, which is not supported; expected box, sphere, cylinder or cone",
              owner);
  }
  type.fail_expecting("box, sphere, cylinder or cone");
}

std::optional<Box> box_of_plane(const std::array<double, 4>& abcd, const Transform& pose) {
  constexpr double kHalfWidth = 100, kHalfThickness = 0.0005;  // metres
  const Vec3 normal(abcd[0], abcd[1], abcd[2]);
  if (!(normal.norm() > 1e-9)) return std::nullopt;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal.normalized());
  const Transform X_SP{turn.toRotationMatrix(), -abcd[3] / normal.squaredNorm() * normal};
  return Box{pose * X_SP, Vec3(kHalfWidth, kHalfWidth, kHalfThickness)};
}

Box centred_plane(Box plane) {
  const Vec3 normal = plane.pose.rotation.col(2);
  plane.pose.translation = normal.dot(plane.pose.translation) * normal;
  return plane;
}

namespace {

std::size_t read_index(const Input& input, std::size_t count) {
  const double value = input.finite_number();
  if (!(value >= 0 && value < static_cast<double>(count)) || value != std::floor(value)) {
    input.fail(ErrorCode::parse, "expected the index of one of {} vertices, got {}", count, value);
  }
  return static_cast<std::size_t>(value);
}

Mesh read_moveit_mesh(const Input& mesh, const Transform& pose) {
  mesh.allow_keys({"triangles", "vertices"});
  std::vector<Vec3> vertices;
  for (const Input& vertex : mesh.items("vertices")) {
    vertices.push_back(read_vector(vertex));
  }
  std::vector<Triangle> triangles;
  for (const Input& triangle : mesh.items("triangles")) {
    const Input indices = triangle.is_map() ? triangle.at("vertex_indices") : triangle;
    static_cast<void>(indices.finite_numbers(3, "indices of vertices"));
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = vertices[read_index(indices.items()[i], vertices.size())];
    }
    triangles.push_back({corners[0], corners[1], corners[2]});
    if (triangles.back().area() <= 0) triangles.pop_back();
  }
  if (triangles.empty()) {
    mesh.fail(ErrorCode::parse, "expected a mesh with a triangle that has an area");
  }
  return {pose, std::make_shared<Parts<Triangle>>(std::move(triangles)), 0};
}

Box read_moveit_plane(const Input& plane, const Transform& pose) {
  plane.allow_keys({"coef"});
  const Input coefficients = plane.at("coef");
  const std::vector<double> c = coefficients.finite_numbers(4, "a, b, c, d of a plane");
  const auto box = box_of_plane({c[0], c[1], c[2], c[3]}, pose);
  if (!box) coefficients.fail_expecting("a normal that is not zero");
  return *box;
}

std::optional<Octree> read_moveit_octomap(const Input& octomap) {
  if (!octomap.is_map()) return std::nullopt;
  const auto map = octomap.find("octomap");
  const auto data = map && map->is_map() ? map->find_value("data") : std::nullopt;
  if (!data) return std::nullopt;
  std::string bytes;
  for (const double value : data->numbers()) {
    if (!(value >= -128 && value <= 255) || value != std::floor(value)) {
      data->fail_expecting("bytes");
    }
    bytes += static_cast<char>(static_cast<int>(value));
  }
  if (bytes.empty()) return std::nullopt;
  const std::string id = map->at("id").text();
  if (id != "OcTree" && id != "ColorOcTree") map->at("id").fail_expecting("OcTree or ColorOcTree");
  const OctreeFormat format{map->at("binary").boolean(), id == "ColorOcTree",
                            map->at("resolution").positive_number()};
  auto cubes = data->take(parse_octree_data(bytes, format, {}, octomap.source()));
  if (cubes.empty()) {
    data->warn("no leaf is occupied, and the octomap is left out");
    return std::nullopt;
  }
  const auto origin = octomap.find("origin");
  return Octree{origin ? read_moveit_pose(*origin) : Transform{},
                std::make_shared<Parts<Cube>>(std::move(cubes)), 0};
}

/// Adds the shapes of the list `key`, each at its pose of `pose_key`, or all at that of the object.
template <class Read>
void add_shapes(const Input& object, std::string_view key, std::string_view pose_key,
                const Transform& X_FO, const Read& read_one, MoveitObject& result) {
  const std::vector<Input> shapes = object.items(key);
  const std::vector<Input> poses = object.items(pose_key);
  const bool is_posed_as_one = poses.empty() && object.find("pose");
  if (poses.size() != shapes.size() && !is_posed_as_one) {
    object.fail(ErrorCode::parse,
                "object \"{}\": expected one pose per shape, got {} {} and {} poses",
                result.obstacle.name, shapes.size(), key, poses.size());
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Transform X_OS = poses.empty() ? Transform{} : read_moveit_pose(poses[i]);
    result.obstacle.shapes.push_back(read_one(shapes[i], X_FO * X_OS));
  }
}

constexpr std::array<std::string_view, 4> kOperations = {"ADD", "REMOVE", "APPEND", "MOVE"};

/// The index among kOperations. ROS 2 prints this byte as text: as itself, escaped, or as Python
/// writes it.
std::optional<std::size_t> read_operation(const Input& operation) {
  if (operation.is_nothing()) return 0;
  const auto number = operation.is_number() ? operation.whole_number() : std::nullopt;
  const std::string text = operation.is_text() ? operation.text() : "";
  if (operation.is_text() && text.empty()) return 0;
  for (std::size_t i = 0; i < kOperations.size(); ++i) {
    const std::string byte(1, static_cast<char>(i));
    if (number == i || text == kOperations[i] || text == lower_case(kOperations[i]) ||
        text == byte || text == fmt::format("{}", i) || text == fmt::format("\\{}", i) ||
        text == fmt::format("\\x0{}", i) || text == fmt::format("b'\\x0{}'", i)) {
      return i;
    }
  }
  return std::nullopt;
}

void refuse_operation(const Input& object, const std::string& id) {
  const auto operation = object.find("operation");
  if (!operation) return;
  const auto read = read_operation(*operation);
  if (!read) operation->fail_expecting("the operation add of object \"{}\"", id);
  if (*read == 0) return;
  operation->fail(ErrorCode::unsupported, "object \"{}\": expected the operation add, got \"{}\"",
                  id, lower_case(kOperations[*read]));
}

/// `may_be_empty`: an attached object may refer to the world's object by its name.
MoveitObject read_object(const Input& object, bool may_be_empty = false) {
  object.allow_keys({"header", "id", "type", "pose", "primitives", "primitive_poses", "meshes",
                     "mesh_poses", "planes", "plane_poses", "subframe_names", "subframe_poses",
                     "operation"});
  const std::string id = object.at("id").text();
  if (id.empty()) object.at("id").fail_expecting("a name");
  if (!decode_utf8(id)) object.at("id").fail_expecting("a name that is UTF-8 text without NUL");
  refuse_operation(object, id);
  const auto pose = object.find("pose");
  const Transform X_FO = pose ? read_moveit_pose(*pose) : Transform{};
  // Read before: g++ 12 destroys what is within inner braces twice if what follows throws.
  std::string frame = read_frame_id(object);
  MoveitObject result{{id, {}}, std::move(frame), object};
  const auto primitive = [&](const Input& input, const Transform& X_FS) {
    return read_moveit_primitive(input, X_FS, fmt::format("object \"{}\"", id));
  };
  add_shapes(object, "primitives", "primitive_poses", X_FO, primitive, result);
  add_shapes(object, "meshes", "mesh_poses", X_FO, read_moveit_mesh, result);
  add_shapes(object, "planes", "plane_poses", X_FO, read_moveit_plane, result);
  result.plane_count = object.items("planes").size();
  if (result.obstacle.shapes.empty() && !may_be_empty) {
    object.fail(ErrorCode::parse, "object \"{}\": expected at least one primitive, mesh or plane",
                id);
  }
  return result;
}

MoveitAttached read_attached(const Input& attached) {
  attached.allow_keys({"link_name", "object", "touch_links", "detach_posture", "weight"});
  MoveitAttached result{
      read_object(attached.at("object"), true), attached.at("link_name").text(), {}};
  for (const Input& link : attached.items("touch_links")) {
    result.touch_links.push_back(link.text());
  }
  return result;
}

}  // namespace

MoveitState read_moveit_state(const Input& input) {
  input.allow_keys(
      {"joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff"});
  MoveitState state;
  if (const auto joints = input.find("joint_state")) {
    joints->allow_keys({"header", "name", "position", "velocity", "effort"});
    const auto read_position = [](const Input& position) {
      return position.taking_angles().finite_number();
    };
    read_by_joint(*joints, "name", "position", read_position, state.positions);
  }
  if (const auto joints = input.find("multi_dof_joint_state")) {
    joints->allow_keys({"header", "joint_names", "transforms", "twist", "wrench"});
    read_by_joint(*joints, "joint_names", "transforms", read_moveit_transform, state.poses);
    state.pose_frame = read_frame_id(*joints);
  }
  std::set<std::string> names;
  for (const Input& attached : input.items("attached_collision_objects")) {
    const MoveitObject& object = state.attached.emplace_back(read_attached(attached)).object;
    if (names.insert(object.obstacle.name).second) continue;
    object.place.fail(ErrorCode::parse, "expected a unique name, got \"{}\" again",
                      object.obstacle.name);
  }
  return state;
}

MoveitState overlaid(MoveitState state, const MoveitState& difference) {
  for (const auto& [joint, position] : difference.positions) state.positions[joint] = position;
  for (const auto& [joint, pose] : difference.poses) state.poses[joint] = pose;
  if (!difference.poses.empty()) state.pose_frame = difference.pose_frame;
  std::set<std::string> replaced;
  for (const MoveitAttached& attached : difference.attached) {
    replaced.insert(attached.object.obstacle.name);
  }
  std::erase_if(state.attached, [&](const MoveitAttached& attached) {
    return replaced.contains(attached.object.obstacle.name);
  });
  state.attached.insert(state.attached.end(), difference.attached.begin(),
                        difference.attached.end());
  return state;
}

std::vector<MoveitObject> read_moveit_objects(const Input& world) {
  if (world.find("id")) return {read_object(world)};
  world.allow_keys({"collision_objects", "octomap"});
  std::vector<MoveitObject> objects;
  std::set<std::string> names;
  if (const auto octomap = world.find("octomap")) {
    if (auto octree = read_moveit_octomap(*octomap)) {
      objects.push_back({{"octomap", {std::move(*octree)}}, read_frame_id(*octomap), *octomap});
      names.insert("octomap");
    }
  }
  for (const Input& object : world.items("collision_objects")) {
    objects.push_back(read_object(object));
    if (!names.insert(objects.back().obstacle.name).second) {
      object.fail(ErrorCode::parse, "expected a unique name, got \"{}\" again",
                  objects.back().obstacle.name);
    }
  }
  return objects;
}

}  // namespace mneme::internal

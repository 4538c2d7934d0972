// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/problem.h"
#include "mneme/scene.h"

#include "arrays.h"
#include "bindings.h"
#include "errors.h"
#include "interruptible.h"
#include "origins.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <variant>

namespace mneme::python {
namespace {

using SceneClass = py::class_<Scene, std::shared_ptr<Scene>>;

void check_size(const char* what, double value) {
  if (value > 0 && value < kFarthestShape) return;
  raise_invalid(fmt::format("{}: expected metres, more than 0 and less than {}, got {}", what,
                            kFarthestShape, value));
}

Transform pose_of(const py::object& position, const py::object& quat_xyzw) {
  Transform pose;
  pose.translation = to_point(position, "position");
  if (quat_xyzw.is_none()) return pose;
  const std::vector<double> q = to_vector(quat_xyzw, 4, "quat_xyzw");
  const auto scaled = rotation_from_scaled_quaternion(std::span(q).first<4>());
  if (!scaled) raise_invalid("quat_xyzw: " + scaled.error().message);
  if (scaled->is_scaled) {
    warn(fmt::format("quat_xyzw: the quaternion of length {:.6g} is scaled to length 1",
                     scaled->length));
  }
  pose.rotation = scaled->rotation;
  return pose;
}

/// Python takes bytes for text.
void check_text(const std::string& text, const char* what) {
  PyObject* decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), nullptr);
  if (decoded != nullptr) return Py_DECREF(decoded);
  static_cast<void>(drop_exception());
  raise_invalid(fmt::format("{}: expected UTF-8 text, got '{}'", what, text));
}

void check_place(const std::string& name, const Shape& shape) {
  const Sphere bounds = bounding_sphere(shape);
  if (!bounds.center.allFinite()) {
    raise_invalid(fmt::format("obstacle '{}': expected finite coordinates", name));
  }
  if (!(bounds.center.norm() + bounds.radius <= kFarthestShape)) {
    raise_invalid(fmt::format("obstacle '{}': expected a shape within {} m of the origin", name,
                              kFarthestShape));
  }
}

/// Shapes of one name are one body.
void add(Scene& scene, const std::string& name, const Shape& shape) {
  if (name.empty()) raise_invalid("name: expected one that is not empty");
  check_text(name, "name");
  check_place(name, shape);
  unwrap(scene.add_shape(name, shape));
}

/// Adds a shape with what the first plan would have to make. Control-C leaves the scene unchanged.
void add_prepared(Scene& scene, const std::string& name, const Shape& shape) {
  Scene own;  // other threads may edit the scene meanwhile
  add(own, name, shape);
  static_cast<void>(run_interruptible([&] {
    own.prepare(name);
    return true;
  }));
  add(scene, name, shape);
}

Obstacle& find(Scene& scene, const std::string& name) {
  if (Obstacle* found = scene.find(name)) return *found;
  raise_invalid(fmt::format("scene '{}': there is no obstacle '{}'", scene.name, name));
}

std::size_t add_points(Scene& scene, const std::string& name, const py::object& points,
                       double radius, const py::object& position, const py::object& quat_xyzw) {
  check_size("radius", radius);
  if (py::isinstance(points, py::module_::import("numpy.ma").attr("MaskedArray"))) {
    raise_invalid(
        "points: expected an array without a mask, such as points.filled(numpy.nan): rows with NaN "
        "are left out");
  }
  const py::array raw = to_real_array(points, "points");
  if (raw.ndim() > 0) unwrap(check_point_count(name, static_cast<std::size_t>(raw.shape(0))));
  const Array array = to_matrix(raw, 3, "points");
  const auto rows = array.unchecked<2>();
  std::vector<CloudPoint> finite;
  finite.reserve(static_cast<std::size_t>(rows.shape(0)));
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    CloudPoint p;
    for (py::ssize_t axis = 0; axis < 3; ++axis) {
      p[static_cast<std::size_t>(axis)] = static_cast<float>(rows(i, axis));
    }
    if (std::ranges::all_of(p, [](float x) { return std::isfinite(x); })) finite.push_back(p);
  }
  const std::size_t ignored = static_cast<std::size_t>(rows.shape(0)) - finite.size();
  if (finite.empty()) {
    warn(fmt::format("obstacle '{}' is not added: no point of {} is finite", name, rows.shape(0)));
    return ignored;
  }
  const auto parts = std::make_shared<Parts<CloudPoint>>(std::move(finite));
  add_prepared(scene, name, PointCloud{pose_of(position, quat_xyzw), parts, radius});
  return ignored;
}

void add_mesh(Scene& scene, const std::string& name, const py::object& vertices,
              const py::object& triangles, const py::object& position,
              const py::object& quat_xyzw) {
  const Array points = to_matrix(vertices, 3, "vertices"),
              faces = to_matrix(triangles, 3, "triangles");
  const auto corners = points.unchecked<2>(), indices = faces.unchecked<2>();
  const auto corner = [&](py::ssize_t face, py::ssize_t k) {
    const double index = indices(face, k);
    if (!(index >= 0 && index < static_cast<double>(corners.shape(0))) ||
        index != std::floor(index)) {
      raise_invalid(fmt::format("triangles: expected indices of {} vertices, got {}",
                                corners.shape(0), index));
    }
    const auto i = static_cast<py::ssize_t>(index);
    const Vec3 p(corners(i, 0), corners(i, 1), corners(i, 2));
    if (!p.allFinite()) raise_invalid("vertices: expected finite coordinates");
    return p;
  };
  std::vector<Triangle> list;
  for (py::ssize_t i = 0; i < indices.shape(0); ++i) {
    const Triangle triangle{corner(i, 0), corner(i, 1), corner(i, 2)};
    if (triangle.area() > 0) list.push_back(triangle);
  }
  if (list.empty()) raise_invalid("triangles: expected at least one with an area above 0");
  const auto parts = std::make_shared<Parts<Triangle>>(std::move(list));
  add_prepared(scene, name, Mesh{pose_of(position, quat_xyzw), parts, 0});
}

void replace_points(Scene& scene, const std::string& name, py::ssize_t first,
                    const py::object& points) {
  if (first < 0) raise_invalid(fmt::format("first: expected 0 or more, got {}", first));
  const Array array = to_matrix(points, 3, "points");
  const auto rows = array.unchecked<2>();
  const Obstacle& obstacle = find(scene, name);
  const auto* cloud =
      obstacle.shapes.size() == 1 ? std::get_if<PointCloud>(&obstacle.shapes.front()) : nullptr;
  std::vector<CloudPoint> list(static_cast<std::size_t>(rows.shape(0)));
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const Vec3 p(rows(i, 0), rows(i, 1), rows(i, 2));
    if (cloud != nullptr) check_place(name, Sphere{cloud->pose * p, cloud->radius});
    list[static_cast<std::size_t>(i)] = {static_cast<float>(rows(i, 0)),
                                         static_cast<float>(rows(i, 1)),
                                         static_cast<float>(rows(i, 2))};
  }
  unwrap(scene.replace_points(name, static_cast<std::size_t>(first), list));
}

/// Returns axes for a body without a shape with a pose: z from the first of `points` to the next at
/// another place, x towards the first beside that line. A body is symmetric about axes that this
/// leaves open.
Eigen::Matrix3d axes_of(const std::vector<Vec3>& points) {
  constexpr double kApart = 1e-9;  // metres
  const auto first_with = [&](const auto& part) -> Vec3 {
    for (const Vec3& p : points) {
      const Vec3 off = part(Vec3(p - points.front()));
      if (off.norm() > kApart) return off.normalized();
    }
    return Vec3::Zero();
  };
  const Vec3 z = first_with([](const Vec3& off) { return off; });
  if (z.isZero()) return Eigen::Matrix3d::Identity();
  Vec3 x = first_with([&](const Vec3& off) -> Vec3 { return off - off.dot(z) * z; });
  if (x.isZero()) x = z.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return axes;
}

/// Returns the pose that move() replaces: the place of the first shape, and the rotation of the
/// first shape with a pose.
Transform pose_of(const Obstacle& obstacle) {
  std::vector<Vec3> points;
  std::optional<Eigen::Matrix3d> rotation;
  std::optional<Vec3> place;
  for (const Shape& shape : obstacle.shapes) {
    std::visit(
        [&](const auto& own) {
          if constexpr (requires { own.pose; }) {
            if (!rotation) rotation = own.pose.rotation;
            if (!place) place = own.pose.translation;
          } else if constexpr (requires { own.center; }) {
            points.push_back(own.center);
          } else {
            points.insert(points.end(), {own.a, own.b});
          }
          if (!place) place = bounding_sphere(own).center;
        },
        shape);
  }
  return {rotation ? *rotation : axes_of(points), place.value()};
}

/// Sets the pose of a shape that has one, without the rounding of a motion.
void set_pose(Shape& shape, const Transform& pose) {
  std::visit(
      [&](auto& own) {
        if constexpr (requires { own.pose; }) {
          own.pose = pose;
        } else if constexpr (requires { own.center; }) {
          own.center = pose.translation;
        }
      },
      shape);
}

void move(Scene& scene, const std::string& name, const py::object& position,
          const py::object& quat_xyzw) {
  Obstacle& obstacle = find(scene, name);
  const Transform before = pose_of(obstacle);
  Transform after = pose_of(position, quat_xyzw);
  if (!after.translation.allFinite()) raise_invalid("position: expected finite coordinates");
  if (quat_xyzw.is_none()) after.rotation = before.rotation;
  if (after == before) return;
  const Transform motion = quat_xyzw.is_none() ? Transform{Eigen::Matrix3d::Identity(),
                                                           after.translation - before.translation}
                                               : after * before.inverse();
  Scene moved;
  moved.obstacles = {obstacle};
  unwrap(moved.move(name, motion));
  set_pose(moved.obstacles.front().shapes.front(), after);
  for (const Shape& shape : moved.obstacles.front().shapes) check_place(name, shape);
  obstacle = std::move(moved.obstacles.front());
}

void bind_edits(SceneClass& scene) {
  scene.def(
      "remove",
      [](Scene& self, const std::string& name) {
        find(self, name);
        unwrap(self.remove(name));
      },
      py::arg("name"), "Removes an obstacle. Raises mneme.Error if there is none of this name.");
  scene.def("replace_points", &replace_points, py::arg("name"), py::arg("first"), py::arg("points"),
            "Replaces points of a cloud from index first on. points: shape (n, 3), metres.");
  scene.def(
      "move", &move, py::arg("name"), py::arg("position"), py::arg("quat_xyzw") = py::none(),
      "Moves all shapes of an obstacle together. position: of its first shape, as for\n"
      "add_box; of a capsule, its middle. quat_xyzw: of its first shape that takes one; without\n"
      "quat_xyzw the orientation does not change. If there are spheres and capsules only, z\n"
      "runs from the first centre or end to the next, as from a to b of a capsule, and x points\n"
      "to the first beside that line.");
  const auto copy = [](const std::shared_ptr<Scene>& self) {
    auto made = std::make_shared<Scene>(*self);
    set_origin(made, origin_of(self));
    return made;
  };
  scene.def("copy", copy, "Returns an independent copy.");
  scene.def("__copy__", copy);
  scene.def(
      "__deepcopy__",
      [=](const std::shared_ptr<Scene>& self, const py::dict&) { return copy(self); },
      py::arg("memo"));
}

void bind_shapes(SceneClass& scene) {
  scene.def(
      "add_sphere",
      [](Scene& self, const std::string& name, const py::object& position, double radius) {
        check_size("radius", radius);
        add(self, name, Sphere{to_point(position, "position"), radius});
      },
      py::arg("name"), py::arg("position"), py::arg("radius"),
      "Adds a sphere, to the obstacle `name` if there is one. position: its centre, shape (3,),\n"
      "metres.");
  scene.def(
      "add_box",
      [](Scene& self, const std::string& name, const py::object& position, const py::object& size,
         const py::object& quat_xyzw) {
        const Vec3 extents = to_point(size, "size");
        for (const double extent : extents) check_size("size", extent);
        add(self, name, Box{pose_of(position, quat_xyzw), extents / 2});
      },
      py::arg("name"), py::arg("position"), py::arg("size"), py::arg("quat_xyzw") = py::none(),
      "Adds a box, to the obstacle `name` if there is one. position: its centre; size: full\n"
      "extents along x, y, z; shape (3,), metres.\n"
      "quat_xyzw: orientation; scaled to length 1, with a warning if it is up to 10 times off.");
  scene.def(
      "add_cylinder",
      [](Scene& self, const std::string& name, const py::object& position, double radius,
         double length, const py::object& quat_xyzw) {
        check_size("radius", radius);
        check_size("length", length);
        add(self, name, Cylinder{pose_of(position, quat_xyzw), radius, length});
      },
      py::arg("name"), py::arg("position"), py::arg("radius"), py::arg("length"),
      py::arg("quat_xyzw") = py::none(),
      "Adds a cylinder about its z axis, to the obstacle `name` if there is one. position: its\n"
      "centre; length: between the flat ends; metres.");
  scene.def(
      "add_capsule",
      [](Scene& self, const std::string& name, const py::object& a, const py::object& b,
         double radius) {
        check_size("radius", radius);
        add(self, name, Capsule{to_point(a, "a"), to_point(b, "b"), radius});
      },
      py::arg("name"), py::arg("a"), py::arg("b"), py::arg("radius"),
      "Adds a capsule, to the obstacle `name` if there is one: all points within radius of the\n"
      "segment from a to b, shape (3,), metres.");
  scene.def("add_points", &add_points, py::arg("name"), py::arg("points"), py::arg("radius"),
            py::arg("position") = std::array{0.0, 0.0, 0.0}, py::arg("quat_xyzw") = py::none(),
            "Adds a point cloud, to the obstacle `name` if there is one: balls of `radius`\n"
            "about points, shape (n, 3), metres, in a frame at position. Ignores rows that are\n"
            "not finite, and returns their number.");
  scene.def("add_mesh", &add_mesh, py::arg("name"), py::arg("vertices"), py::arg("triangles"),
            py::arg("position") = std::array{0.0, 0.0, 0.0}, py::arg("quat_xyzw") = py::none(),
            "Adds a triangle mesh, to the obstacle `name` if there is one. vertices: shape\n"
            "(n, 3), metres, in a frame at position. triangles: shape (m, 3), indices of\n"
            "vertices. Only the surface is checked: a body wholly inside is not in contact.");
}

std::shared_ptr<Scene> load_file(const std::filesystem::path& path,
                                 const std::optional<Robot>& robot) {
  FramedScene framed = unwrap(run_interruptible([&] { return load_framed_scene(path.string()); }));
  if (robot) {
    framed.scene = unwrap(in_root_frame(framed, *robot));
  } else if (!framed.frame.empty()) {
    framed.scene.warnings.push_back(
        fmt::format("{}: objects are in frame \"{}\", which is taken for the robot's root link; "
                    "with robot= they are moved to where it is",
                    path.string(), framed.frame));
  }
  auto scene = std::make_shared<Scene>(std::move(framed.scene));
  set_origin(scene, {{"a file of the scene", path.string()}});
  return scene;
}

Scene parse_text(const std::string& yaml, const std::string& source) {
  return unwrap(run_interruptible([&] { return parse_scene(yaml, source); }));
}

std::string write_yaml(const Scene& scene) {
  return run_interruptible([copy = scene] { return to_yaml(copy); });
}

void bind_text(SceneClass& scene) {
  scene.def("to_yaml", &write_yaml, "Returns text that Scene.parse reads back to the same scene.");
  scene.def(
      "to_compact_json",
      [](const Scene& self) {
        return run_interruptible([copy = FramedScene{self, ""}] { return to_compact_json(copy); });
      },
      "Returns the text of a compact file with this scene, without start and goal.");
  scene.def("_part_count", [](const Scene& self) {
    std::size_t count = 0;
    for (const Obstacle& obstacle : self.obstacles) {
      for (const Shape& shape : obstacle.shapes) {
        count += std::visit(
            [](const auto& one) -> std::size_t {
              if constexpr (requires { one.parts; }) return one.parts->list().size();
              return 1;
            },
            shape);
      }
    }
    return count;
  });
  scene.def(py::pickle([](const Scene& self) { return py::make_tuple(write_yaml(self)); },
                       [](const py::tuple& state) {
                         return parse_text(state[0].cast<std::string>(), "pickled scene");
                       }));
}

void bind_contacts(SceneClass& scene) {
  scene.def(
      "allow",
      [](Scene& self, const std::string& link, const std::string& obstacle,
         std::optional<double> at_ends) {
        Obstacle* found = self.find(obstacle);
        if (found == nullptr) {
          raise_invalid(fmt::format("obstacle: there is no obstacle '{}'", obstacle));
        }
        if (!at_ends) {
          found->may_touch.push_back(link);
        } else if (*at_ends > 0 && *at_ends <= 1) {
          self.end_contacts.push_back({link, obstacle, *at_ends});
        } else {
          raise_invalid(fmt::format("at_ends: expected metres in (0, 1], got {}", *at_ends));
        }
      },
      py::arg("link"), py::arg("obstacle"), py::arg("at_ends") = std::nullopt,
      "Allows contact of a link, or of an attached object, with an obstacle: the pair is not "
      "checked.\n\nat_ends: allows contact only at the start and goal of a path, within this "
      "distance of motion, metres.");
}

}  // namespace

void bind_scene(py::module_& module) {
  SceneClass scene(module, "Scene",
                   "Named obstacles of one or more shapes, in the frame of the robot's root link.\n"
                   "Metres. add_box() and the like add a shape to the obstacle of that name, if\n"
                   "there is one; remove() it first to replace it.");
  scene.def(py::init([](std::string name) {
              return Scene{std::move(name), {}};
            }),
            py::arg("name") = "scene");
  scene.def_static("load", &load_file, py::arg("path"), py::arg("robot") = py::none(),
                   "Reads a scene file of mneme or a planning scene of MoveIt (YAML). robot:\n"
                   "a Robot that has the frame of a planning scene as a link.");
  scene.def_static("parse", &parse_text, py::arg("yaml"), py::arg("source") = "scene",
                   "Reads YAML text. source names it in errors.");
  scene.def_static(
      "from_circles",
      [](const py::object& circles, std::string name) {
        std::vector<std::array<double, 3>> rows;
        for (const Configuration& row : to_rows(circles, 3, "circles")) {
          check_size("radius", row[2]);
          check_place(fmt::format("circle_{}", rows.size() + 1),
                      Sphere{Vec3(row[0], row[1], 0), row[2]});
          rows.push_back({row[0], row[1], row[2]});
        }
        return make_circle_scene(std::move(name), rows);
      },
      py::arg("circles"), py::arg("name") = "scene",
      "A planar scene. circles: shape (n, 3), rows x, y, radius, metres.");
  scene.def_readwrite("name", &Scene::name);
  scene.def_property_readonly(
      "obstacle_names",
      [](const Scene& self) {
        std::vector<std::string> names;
        for (const Obstacle& obstacle : self.obstacles) names.push_back(obstacle.name);
        return names;
      },
      "Names of the obstacles, in order.");
  scene.def_property_readonly(
      "warnings", [](const Scene& self) { return to_texts(self.warnings); },
      "Parts of the input that were ignored, such as points that are not finite.");
  bind_shapes(scene);
  bind_edits(scene);
  bind_contacts(scene);
  bind_text(scene);
  scene.def("__len__", [](const Scene& self) { return self.obstacles.size(); });
  scene.def("__repr__", [](const Scene& self) {
    return fmt::format("<mneme.Scene '{}', {} obstacles>", self.name, self.obstacles.size());
  });
}

}  // namespace mneme::python

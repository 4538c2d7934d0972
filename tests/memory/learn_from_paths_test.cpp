// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

#include <algorithm>

namespace mneme::test {
namespace {

std::vector<Experience> learn_rows(const Robot& robot, const Scene& scene,
                                   const std::vector<Path>& paths, double reach = 0.12) {
  return require(learn_from_paths({robot, scene}, paths, {}, reach));
}

/// Configurations that reach towards the shelf, as a path of their own.
Path reaching_path(const Robot& robot, int count, std::uint64_t seed) {
  Rng rng(seed);
  Path path;
  for (int i = 0; i < count; ++i) {
    Configuration q = random_configuration(robot, rng);
    q[0] = rng.uniform(0.2, 0.3);
    q[1] = rng.uniform(-0.6, 0.6);
    path.push_back(q);
  }
  return path;
}

/// True if one shape of the column or of its load is within `reach` of both obstacles:
/// links of lifting_arm() named by number, spheres and capsules alike as shapes.
bool belongs(const Robot& robot, const Scene& scene, const LocalPrimitive& primitive,
             const Configuration& q, double reach) {
  const auto poses = robot.link_poses(q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string& name = robot.links()[i].name;
    if (name != "link_2" && name != "link_3" && name != "link_4") continue;
    std::vector<Capsule> shapes = robot.links()[i].capsules;
    for (const Sphere& s : robot.links()[i].spheres)
      shapes.push_back({s.center, s.center, s.radius});
    for (const Capsule& shape : shapes) {
      const auto is_near = [&](int obstacle) {
        double least = 1e9;
        for (const Shape& solid : scene.obstacles[static_cast<std::size_t>(obstacle)].shapes) {
          least =
              std::min(least, distance_to_segment(poses[i] * shape.a, poses[i] * shape.b, solid));
        }
        return least - shape.radius < reach;
      };
      if (std::ranges::all_of(primitive.obstacles, is_near)) return true;
    }
  }
  return false;
}

Path moved_path(const SymmetricJoints& joints, const Symmetry& motion, const Path& path) {
  Path moved;
  for (const Configuration& q : path) moved.push_back(moved_configuration(joints, motion, q));
  return moved;
}

Database new_database(const std::string& path, const Robot& robot) {
  const auto space = make_signature(robot);
  return require(Database::open(path, space, OpenMode::create));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("without paths, or with paths that stay away, nothing is learned") {
    const Robot robot = lifting_arm();
    CHECK(learn_rows(robot, shelf_scene(), {}).empty());
    CHECK(learn_rows(robot, shelf_scene(), {{}}).empty());
    CHECK(learn_rows(robot, shelf_scene(), {{{0.2, 2.4, 0, 0}, {0.2, 2.0, 0.5, 0.5}}}).empty());
    CHECK(learn_rows(robot, {}, {reaching_path(robot, 20, 1)}).empty());
  }

  TEST_CASE("links that no symmetry turns do not count, however near they are") {
    const Robot robot = lifting_arm();
    // About the base, the torso and the head, with the arm turned away.
    const Scene scene{"",
                      {{"a", {box_at({-0.35, 0, 0.6}, {0.05, 0.3, 0.6})}},
                       {"b", {box_at({-0.1, 0.35, 0.6}, {0.2, 0.05, 0.6})}}}};
    REQUIRE(decompose({robot, scene})->size() == 1);
    const Path away = {{0.2, -1.2, 0, 0}};
    CHECK(learn_rows(robot, scene, {away}, 0.3).empty());
    CHECK(learn_rows(robot, scene, {away}, 3.0).size() == 1);
  }

  TEST_CASE("the errors are those of the decomposition") {
    const Robot robot = lifting_arm();
    const Scene scene = shelf_scene();
    const Error error = require_error(learn_from_paths({robot, scene}, {}, of_kind("triples")));
    CHECK(contains(error.message, "'triples'"));
  }

  TEST_CASE("planar arms learn from paths too") {
    const Robot robot = planar8();
    const Scene scene = make_circle_scene("", {{3, 1, 0.8}, {3, -1, 0.8}});
    const Configuration through(8, 0.0);
    Configuration away = through;
    away[0] = 2.5;
    const auto rows = learn_rows(robot, scene, {{through, away}}, 0.3);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].key == decompose({robot, scene})->at(0).key);
    REQUIRE(rows[0].sampler().component_count() == 1);
    CHECK(robot.distance(mean_of(rows[0].sampler(), 0), through) < 1e-6);
  }
}

TEST_SUITE("law") {
  TEST_CASE("a scene that is turned and lifted with its paths teaches the same") {
    const Robot robot = lifting_arm();
    const SymmetricJoints joints = find_symmetric_joints(robot);
    const Path path = reaching_path(robot, 60, 2);
    const auto here = learn_rows(robot, shelf_scene(), {path});
    REQUIRE(here.size() == 3);
    Rng rng(3);
    for (int i = 0; i < 10; ++i) {
      const Symmetry motion{rng.uniform(-1.5, 1.5), false, rng.uniform(-0.2, 0.2)};
      const Scene scene = moved_scene(transform_of(joints, motion), shelf_scene());
      const auto there = learn_rows(robot, scene, {moved_path(joints, motion, path)});
      INFO("seed 3, case ", i);
      REQUIRE(there.size() == here.size());
      for (std::size_t row = 0; row < here.size(); ++row) {
        CHECK(similarity_error(kind_named("body_pairs"), here[row].key, there[row].key) < 1e-18);
        const LocalSampler &a = here[row].sampler(), &b = there[row].sampler();
        REQUIRE(a.component_count() == b.component_count());
        for (int c = 0; c < a.component_count(); ++c) {
          CHECK(robot.distance(mean_of(a, c), mean_of(b, c)) < 1e-5);
        }
      }
    }
  }

  TEST_CASE("a longer reach learns whatever a shorter one does") {
    const Robot robot = lifting_arm();
    const std::vector<Path> paths = {reaching_path(robot, 60, 4)};
    int previous = 0;
    for (const double reach : {0.0, 0.05, 0.12, 0.3, 10.0}) {
      int components = 0;
      for (const Experience& row : learn_rows(robot, shelf_scene(), paths, reach)) {
        components += row.sampler().component_count();
      }
      CHECK(components >= previous);
      previous = components;
    }
    CHECK(previous == 3 * 60);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("each primitive gets the waypoints at which one moving shape is near all its bodies") {
    const Robot robot = lifting_arm();
    const SymmetricJoints joints = find_symmetric_joints(robot);
    const Scene scene = shelf_scene();
    const std::vector<Path> paths = {reaching_path(robot, 50, 5), reaching_path(robot, 50, 6)};
    const auto primitives = require(decompose({robot, scene}));
    REQUIRE(primitives.size() == 3);
    for (const double reach : {0.03, 0.12}) {
      const auto rows = learn_rows(robot, scene, paths, reach);
      std::size_t next = 0;
      for (const LocalPrimitive& primitive : primitives) {
        Path expected;
        for (const Path& path : paths) {
          for (const Configuration& q : path) {
            if (belongs(robot, scene, primitive, q, reach)) {
              expected.push_back(moved_configuration(joints, inverse(primitive.to_scene), q));
            }
          }
        }
        INFO("seeds 5 and 6, reach ", reach, ", ", expected.size(), " waypoints");
        CHECK(expected.size() < 100);
        if (expected.empty()) continue;
        REQUIRE(next < rows.size());
        CHECK(rows[next].key == primitive.key);
        REQUIRE(rows[next].sampler().component_count() == static_cast<int>(expected.size()));
        for (std::size_t i = 0; i < expected.size(); ++i) {
          CHECK(robot.distance(mean_of(rows[next].sampler(), static_cast<int>(i)), expected[i]) <
                1e-6);
        }
        ++next;
      }
      CHECK(next == rows.size());
      CHECK(next > 0);
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a scene turned and lifted retrieves the waypoints, moved along and still free") {
    const Robot robot = lifting_arm();
    const SymmetricJoints joints = find_symmetric_joints(robot);
    const CollisionChecker here = make_checker(robot, shelf_scene());
    Path path;
    for (const Configuration& q : reaching_path(robot, 400, 7)) {
      if (here.is_valid(std::span<const double>(q))) path.push_back(q);
    }
    REQUIRE(path.size() > 50);
    const TemporaryDirectory directory;
    Database database = new_database(directory / "a.db", robot);
    require(database.insert(learn_rows(robot, shelf_scene(), {path})));
    const std::int64_t components = database.info().components;
    REQUIRE(components > 30);
    SolveSettings settings;
    settings.similarity = 1e-6;
    for (const Symmetry& motion : {Symmetry{}, Symmetry{1.1, false, 0.15}, {-1.7, false, -0.2}}) {
      const Scene scene = moved_scene(transform_of(joints, motion), shelf_scene());
      const CollisionChecker there = make_checker(robot, scene);
      const GlSampler gl = require(recall(problem_in(robot, scene), database, settings));
      CHECK(gl.mixture->component_count() == components);
      int touching = 0;
      for (int i = 0; i < gl.mixture->component_count(); ++i) {
        const Configuration q = mean_of(*gl.mixture, i);
        const Configuration back = moved_configuration(joints, inverse(motion), q);
        CHECK(std::ranges::any_of(
            path, [&](const auto& waypoint) { return robot.distance(waypoint, back) < 1e-5; }));
        if (here.contacts(back).empty()) touching += there.contacts(q).empty() ? 0 : 1;
      }
      CHECK(touching == 0);
    }
  }

  TEST_CASE("waypoints that a scene moves beyond the joints' limits are not retrieved") {
    const Robot robot = lifting_arm();
    const SymmetricJoints joints = find_symmetric_joints(robot);
    const Path path = reaching_path(robot, 100, 8);
    const TemporaryDirectory directory;
    Database database = new_database(directory / "a.db", robot);
    const auto learned = learn_rows(robot, shelf_scene(), {path});
    require(database.insert(learned));
    SolveSettings settings;
    settings.similarity = 1e-6;
    const Scene shelf = shelf_scene();
    const auto primitives = decompose({robot, shelf});
    for (const Symmetry& motion :
         {Symmetry{0, false, 0.25}, Symmetry{2.2, false, 0}, {-2.3, false, -0.24}}) {
      int expected = 0;
      for (std::size_t row = 0; row < learned.size(); ++row) {
        const Symmetry all = compose(motion, (*primitives)[row].to_scene);
        for (int i = 0; i < learned[row].sampler().component_count(); ++i) {
          const Configuration q =
              moved_configuration(joints, all, mean_of(learned[row].sampler(), i));
          expected += robot.describe_violation(q, "mean") ? 0 : 1;
        }
      }
      const Scene scene = moved_scene(transform_of(joints, motion), shelf_scene());
      const GlSampler gl = require(recall(problem_in(robot, scene), database, settings));
      CHECK(gl.mixture->component_count() == expected);
      CHECK(expected > 0);
      CHECK(expected < database.info().components);
    }
  }
}

}  // namespace mneme::test

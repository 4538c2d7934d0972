// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Scenes that change while checkers of them come and go.
#include "collision/random_worlds.h"
#include "geometry/random_compounds.h"

#include <atomic>
#include <optional>
#include <thread>

namespace mneme::test {
namespace {

/// The same obstacles with parts of their own, of which nothing is kept.
Scene afresh(const Scene& scene) {
  Scene copy = scene;
  for (Obstacle& obstacle : copy.obstacles) {
    for (Shape& shape : obstacle.shapes) {
      auto* cloud = std::get_if<PointCloud>(&shape);
      if (cloud == nullptr) continue;
      cloud->parts = std::make_shared<Parts<CloudPoint>>(cloud->parts->list());
    }
  }
  return copy;
}

std::vector<CloudPoint> random_points(std::uint32_t count, Rng& rng) {
  std::vector<CloudPoint> points;
  const Vec3 middle = random_vector(rng, 0.8);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Vector3f p = (middle + random_vector(rng, 0.3)).cast<float>();
    points.push_back({p.x(), p.y(), p.z()});
  }
  return points;
}

void edit(Scene& scene, int number, Rng& rng) {
  const std::string name = "added" + std::to_string(number);
  const std::uint32_t kind = rng.index(8);
  if (scene.obstacles.size() < 3 || kind == 0) {
    const Shape cloud = random_cloud(rng);
    require(scene.add({name, {transformed(random_pose(rng, 1.0), cloud)}}));
  } else if (kind == 1) {
    const Shape box = small_box(rng);
    require(scene.add({name, {transformed(random_pose(rng, 1.5), box)}}));
  }
  const std::uint32_t count = static_cast<std::uint32_t>(scene.obstacles.size());
  const Obstacle& obstacle = scene.obstacles[rng.index(count)];
  const std::string chosen = obstacle.name;
  if (count > 8 && kind == 2) {
    require(scene.remove(chosen));
  } else if (kind == 3) {
    require(scene.move(chosen, random_pose(rng, 0.2)));
  } else if (const auto* cloud = std::get_if<PointCloud>(&obstacle.shapes[0])) {
    const auto size = static_cast<std::uint32_t>(cloud->parts->list().size());
    const std::uint32_t first = rng.index(size), most = std::min(size - first, 100u);
    const std::vector<CloudPoint> points = random_points(rng.index(most) + 1, rng);
    require(scene.replace_points(chosen, first, points));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a scene that was edited again and again is checked as one made afresh") {
    Rng rng(311);
    const Robot robot = random_robot(rng);
    Scene scene{"edited", {}};
    std::optional<CollisionChecker> kept;
    std::vector<std::uint8_t> kept_says;
    const std::vector<float> rows = random_states(robot, 100, rng);
    int in_contact = 0;
    for (int i = 0; i < rounds(30); ++i) {
      INFO("seed 311, edit " << i);
      edit(scene, i, rng);
      const auto checker = require_checker(robot, scene);
      const auto says = check_all(checker, rows);
      REQUIRE(says == check_all(require_checker(robot, afresh(scene)), rows));
      in_contact += static_cast<int>(std::ranges::count(says, std::uint8_t{0}));
      // A checker that is still there must not see edits.
      if (kept) REQUIRE(check_all(*kept, rows) == kept_says);
      if (i % 3 == 0) {
        kept = checker;
        kept_says = says;
      } else {
        kept.reset();
      }
    }
    CHECK(in_contact > 100);
  }

  // The thread sanitizer sees whether what it read is overwritten only after that.
  TEST_CASE("points are replaced in place once a checker of another thread is gone") {
    Rng rng(312);
    const Robot robot = random_robot(rng);
    Scene scene{"seen", {}};
    require(scene.add({"cloud", {random_cloud(rng)}}));
    const std::vector<float> rows = random_states(robot, 10, rng);
    for (int i = 0; i < 20; ++i) {
      std::optional<CollisionChecker> checker = require_checker(robot, scene);
      std::atomic<bool> is_gone = false;
      std::thread other([&rows, &is_gone, seen = std::move(checker)]() mutable {
        static_cast<void>(check_all(*seen, rows));
        seen.reset();
        is_gone.store(true, std::memory_order_relaxed);
      });
      checker.reset();
      while (!is_gone.load(std::memory_order_relaxed)) std::this_thread::yield();
      const std::vector<CloudPoint> points = random_points(50, rng);
      require(scene.replace_points("cloud", 0, points));
      other.join();
      CHECK(check_all(require_checker(robot, scene), rows) ==
            check_all(require_checker(robot, afresh(scene)), rows));
    }
  }
}

}  // namespace
}  // namespace mneme::test

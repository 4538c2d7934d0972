// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/proven_motions.h"
#include "planning/small_worlds.h"
#include "support/path_cell.h"

namespace mneme::test {
namespace {

using internal::ProvenMotions;

/// An arm that knows a way past a circle.
struct StaticCell : PathCell {
  StaticCell() {
    put(0);
    remember({problem.start, problem.goals.front()});
  }
  void put(double offset) {
    problem.scene = make_circle_scene("cell", {{-1.5 + offset, -1.5, 0.1}});
  }
  /// States checked by a query that is replayed.
  std::uint64_t states() {
    const auto result = require(solve(problem, &database, settings));
    REQUIRE(result.replay.is_hit());
    CHECK(is_path_free(problem.robot, problem.scene, result.plan.path, 0.002));
    return result.plan.states_checked;
  }
  [[nodiscard]] std::shared_ptr<ProvenMotions> of_links(Verification verification) const {
    return ProvenMotions::of_links(make_checker(problem.robot, problem.scene), verification);
  }
  [[nodiscard]] ProvenMotions* proven() const { return proven_of(problem.scene); }
  [[nodiscard]] ProvenMotions* proven_of(const Scene& scene) const {
    const auto kept = internal::StaticCell::keep(make_checker(problem.robot, scene));
    return kept == nullptr ? nullptr : &kept->motions(Verification::motions);
  }
};

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("what was proven in a static cell is not proven again") {
    StaticCell cell;
    const std::uint64_t first = cell.states();
    CHECK(first > 0);
    CHECK(cell.states() == 0);
    // The end is bent, the start stays: of a single motion that is all of it.
    cell.problem.goals = {{1.99, 0.5}};
    CHECK(cell.states() > 0);
    CHECK(cell.states() == 0);
  }

  TEST_CASE("a static cell is known by its obstacles, whatever its scene is called") {
    StaticCell cell;
    CHECK(cell.states() > 0);
    cell.problem.scene.name = "another";
    CHECK(cell.states() == 0);
  }

  TEST_CASE("an obstacle that moved by a hair has everything proven again") {
    StaticCell cell;
    const std::uint64_t first = cell.states();
    cell.put(1e-12);
    CHECK(cell.states() == first);
    cell.put(0);
    CHECK(cell.states() == 0);
  }

  TEST_CASE("an obstacle that came onto a way that was proven blocks it") {
    StaticCell cell;
    REQUIRE(cell.states() > 0);
    REQUIRE(cell.states() == 0);
    cell.problem.scene =
        make_circle_scene("cell", {{1.95 * std::cos(1.25), 1.95 * std::sin(1.25), 0.05}});
    const auto result = require(solve(cell.problem, &cell.database, cell.settings));
    REQUIRE(result.replay.blocked.size() == 1);
    CHECK(is_path_free(cell.problem.robot, cell.problem.scene, result.plan.path, 0.002));
  }

  TEST_CASE("another margin, resolution or verification has everything proven again") {
    StaticCell cell;
    const std::uint64_t first = cell.states();
    SolveSettings& settings = cell.settings;
    const SolveSettings before = settings;
    settings.margin = 0.01;
    CHECK(cell.states() > 0);
    settings = before;
    settings.resolution = 0.01;
    CHECK(cell.states() > 0);
    settings = before;
    settings.plan.continuous = false;
    CHECK(cell.states() > 0);
    settings = before;
    CHECK(cell.states() == 0);
    // The same robot that was read once more is another one: nothing tells what changed in between.
    cell.problem.robot = limited_arm({1, 1}, -0.5, 2.5);
    CHECK(cell.states() == first);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("among other obstacles links are not held against each other again") {
    StaticCell cell;
    const Path folded = {{0, 2.4, 1.87}, {0.2, 2.4, 1.2}};
    cell.problem.robot = thick_arm({1, 0.5, 0.35});
    cell.problem.start = folded.front();
    cell.problem.goals = {folded.back()};
    cell.database = make_database(cell.directory / "folded.db", cell.problem.robot);
    auto rows =
        learn_from_paths(memory_query(cell.problem), std::vector<Path>{folded}, {"paths", {}});
    REQUIRE(rows.has_value());
    require(cell.database.insert(*std::move(rows)));
    const std::uint64_t first = cell.states();
    cell.put(0.01);
    CHECK(cell.states() < first);
    // New obstacles are found all the same.
    cell.problem.scene = make_circle_scene("cell", {{0.484, 0.264, 0.03}});
    REQUIRE(make_checker(cell.problem.robot, cell.problem.scene).contacts(folded[0]).empty());
    const auto result = require(solve(cell.problem, &cell.database, cell.settings));
    CHECK(result.replay.blocked.size() == 1);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a cell is kept with its checker, and found by all that this was made with") {
    const StaticCell cell;
    const Robot& robot = cell.problem.robot;
    const Scene& scene = cell.problem.scene;
    CheckerSettings settings;
    settings.margin = 0.015625;
    const auto kept =
        internal::StaticCell::keep(CollisionChecker::make(robot, scene, settings).value());
    REQUIRE(kept != nullptr);
    CHECK(internal::StaticCell::find(robot, scene, settings) == kept);
    Scene renamed = scene;
    renamed.name = "renamed";
    CHECK(internal::StaticCell::find(robot, renamed, settings) == kept);
    const auto is_found = [&](const auto& change) {
      CheckerSettings changed = settings;
      change(changed);
      return internal::StaticCell::find(robot, scene, changed) != nullptr;
    };
    CHECK(is_found([](CheckerSettings& s) { s.isa = default_isa(); }));
    CHECK_FALSE(is_found([](CheckerSettings& s) { s.margin = 0.03125; }));
    CHECK_FALSE(is_found([](CheckerSettings& s) { s.resolution = 0.01; }));
    CHECK_FALSE(is_found([](CheckerSettings& s) { s.constraints.resize(1); }));
    if (default_isa() != Isa::scalar) {
      CHECK_FALSE(is_found([](CheckerSettings& s) { s.isa = Isa::scalar; }));
    }
  }

  TEST_CASE("queries of other ends in a scene share its checker") {
    StaticCell cell;
    cell.problem.scene = make_circle_scene("cell", {{1.42, -1.32, 0.1}});
    CheckerSettings settings;
    settings.margin = 0.01;  // no float
    const auto find = [&](const Configuration& start) {
      return internal::find_or_make_checker(cell.problem.robot, cell.problem.scene, settings,
                                            {start, cell.problem.goals})
          .value();
    };
    const internal::CellChecker first = find({0, 0.5}), second = find({0.1, 0.5});
    REQUIRE(first.cell != nullptr);
    CHECK(second.cell == first.cell);
    CHECK(&second.checked.checker.scene() == &first.checked.checker.scene());
    CHECK(second.checked.are_ends_clear);
    const internal::CellChecker blocked = find({-0.5, -0.5});
    CHECK(blocked.cell == first.cell);
    CHECK_FALSE(blocked.checked.are_ends_clear);
  }

  TEST_CASE("ends that a known cell has not seen are looked at") {
    StaticCell cell;
    cell.put(0.5);
    REQUIRE(cell.states() > 0);
    cell.settings.start_tolerance = 0;
    const auto status_from = [&](const Configuration& start) {
      cell.problem.start = start;
      return solve(cell.problem, &cell.database, cell.settings).value().plan.status;
    };
    CHECK(status_from({-2.2, 0}) == PlanStatus::invalid_start);
    CHECK(status_from({0, 0.5, 0}) == PlanStatus::invalid_start);
    CHECK(status_from({0, std::nan("")}) == PlanStatus::invalid_start);
    CHECK(status_from({0, 0.5}) == PlanStatus::solved);
  }

  TEST_CASE("links that keep apart do so in all cells of a robot, and only there") {
    StaticCell cell;
    const std::vector<float> a = {0, 0.5f}, b = {1, 0.5f};
    const auto links = cell.of_links(Verification::motions);
    REQUIRE(links != nullptr);
    links->add(a, b, {});
    cell.put(1);
    CHECK(cell.of_links(Verification::motions)->contain(a, b, {}));
    CHECK_FALSE(cell.proven()->contain(a, b, {}));
    CHECK(cell.of_links(Verification::states) == nullptr);
    const std::string link = cell.problem.robot.links().back().name;
    cell.problem.scene.obstacles.front().exact_links = {link};
    CHECK(cell.of_links(Verification::motions) == nullptr);
    cell.problem.scene = Scene{};
    cell.problem.scene.exact_pairs = {{cell.problem.robot.links().front().name, link}};
    CHECK(cell.of_links(Verification::motions) == nullptr);
    cell.problem.scene = Scene{};
    cell.problem.robot = limited_arm({1, 1}, -0.5, 2.5);
    CHECK_FALSE(cell.of_links(Verification::motions)->contain(a, b, {}));
  }

  TEST_CASE("motions count for their own ends and their own cell") {
    const StaticCell cell;
    const std::vector<float> a = {0, 0.5f}, b = {1, 0.5f};
    ProvenMotions* proven = cell.proven();
    REQUIRE(proven != nullptr);
    proven->add(a, b, {true, false});
    CHECK(cell.proven()->contain(a, b, {true, false}));
    CHECK_FALSE(proven->contain(a, b, {false, false}));
    CHECK_FALSE(proven->contain(a, b, {true, true}));
    CHECK_FALSE(proven->contain(b, a, {true, false}));
    CHECK_FALSE(cell.proven_of(Scene{})->contain(a, b, {true, false}));
  }

  TEST_CASE("a cell is forgotten after many others, and its motions after many more") {
    StaticCell cell;
    const std::vector<float> a = {0, 0.5f}, b = {1, 0.5f};
    cell.proven()->add(a, b, {});
    for (int i = 1; i <= 40; ++i) {
      cell.put(i);
      CHECK_FALSE(cell.proven()->contain(a, b, {}));
    }
    cell.put(0);
    ProvenMotions* proven = cell.proven();
    CHECK_FALSE(proven->contain(a, b, {}));
    for (int i = 0; i <= 1024; ++i) proven->add(a, {{static_cast<float>(i), 0}}, {});
    CHECK_FALSE(proven->contain(a, {{0, 0}}, {}));
    CHECK(proven->contain(a, {{1024, 0}}, {}));
  }

  TEST_CASE(
      "what may touch and what is checked by exact geometry is part of a cell, and cells of points "
      "have no "
      "proven motions") {
    StaticCell cell;
    const std::vector<float> a = {0, 0.5f}, b = {1, 0.5f};
    cell.proven()->add(a, b, {});
    const std::string link = cell.problem.robot.links().back().name;
    cell.problem.scene.obstacles.front().may_touch = {link};
    REQUIRE(cell.proven() != nullptr);
    CHECK_FALSE(cell.proven()->contain(a, b, {}));
    cell.proven()->add(a, b, {});
    cell.problem.scene.exact_pairs = {{cell.problem.robot.links().front().name, link}};
    CHECK_FALSE(cell.proven()->contain(a, b, {}));
    PointCloud cloud;
    cloud.parts =
        std::make_shared<const Parts<CloudPoint>>(std::vector{CloudPoint{-1.5f, -1.5f, 0}});
    cloud.radius = 0.1;
    cell.problem.scene.obstacles.front().shapes = {cloud};
    CHECK(cell.proven() == nullptr);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "cell/cell_data.h"
#include "cell/cells.h"
#include "cell/split_tree.h"
#include "support/turning_panda.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::test {
namespace {

constexpr double kResolution = 1.0 / 320;

/// Checks all that is promised of an answer.
void check_answer(const CellRegion& region, const CellTask& task, const CellAnswer& answer,
                  std::size_t start = 0) {
  const Robot& robot = region.problem.robot;
  REQUIRE(answer.path.size() >= 2);
  CHECK(answer.path.front() == region.starts[start].q);
  CHECK(is_path_free(robot, region.problem.scene, answer.path, kResolution));
  PoseGoal goal = region.middle();
  goal.pose = link_pose(region, task);
  const PoseError error = pose_error(robot, goal, answer.path.back());
  CHECK(error.position < 1e-5);
  CHECK(error.rotation < 1e-4);
  for (const Configuration& q : answer.path) {
    CHECK_FALSE(robot.describe_violation(q, "waypoint").has_value());
  }
}

/// Boxes in a tree that random leaves are cut from, up to two per node.
internal::StartCell random_boxes(const internal::TaskFrame& frame, int cuts, Rng& rng) {
  internal::StartCell cell;
  const auto& varying = frame.varying();
  for (int i = 0; i < cuts; ++i) {
    const auto count = static_cast<std::uint32_t>(cell.tree.nodes.size());
    const auto node = static_cast<int>(rng.index(count));
    if (!cell.tree.nodes[static_cast<std::size_t>(node)].is_leaf()) continue;
    cell.tree.cut(node, varying[rng.index(static_cast<std::uint32_t>(varying.size()))], 0);
  }
  const auto places = cell.tree.place(frame.whole());
  for (std::size_t i = 0; i < places.size(); ++i) {
    internal::SplitNode& node = cell.tree.nodes[i];
    node.first = static_cast<int>(cell.boxes.size());
    node.count = static_cast<std::uint16_t>(rng.index(3));
    for (int k = 0; k < node.count; ++k) cell.boxes.emplace_back().tasks = places[i];
  }
  return cell;
}

/// The order of NearestBoxes, by distances of all boxes.
std::vector<int> sorted_boxes(const internal::StartCell& cell, const internal::TaskFrame& frame,
                              const CellTask& task) {
  std::vector<std::pair<double, int>> order;
  for (std::size_t i = 0; i < cell.boxes.size(); ++i) {
    order.emplace_back(frame.distance2(cell.boxes[i].tasks, task), static_cast<int>(i));
  }
  std::ranges::sort(order);
  std::vector<int> result;
  for (const auto& [distance2, index] : order) result.push_back(index);
  return result;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the tree finds the boxes nearest to a task, as a look at all of them does") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const internal::TaskFrame frame(region);
    Rng rng(31);
    for (const int cuts : {0, 3, 40, 2000}) {
      const internal::StartCell cell = random_boxes(frame, cuts, rng);
      for (int i = 0; i < 40; ++i) {
        INFO("seed 31, " << cuts << " cuts, task " << i);
        CellTask task = random_task_of(region, rng, i % 2 == 1);
        if (i % 4 >= 2) task[0] *= 1.5;  // beyond the region
        internal::NearestBoxes nearest(cell, frame, task);
        for (const int box : sorted_boxes(cell, frame, task)) REQUIRE(nearest.next() == box);
        REQUIRE(nearest.next() == -1);
      }
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("answers of a cell are free, within limits and at their pose, corners included") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 60);
    CHECK(cell.proven_count() == cell.box_count());
    CHECK(cell.box_count() > 0);
    Rng rng(1);
    int certified = 0;
    for (int i = 0; i < 200; ++i) {
      const CellTask task = random_task_of(region, rng, i % 2 == 1);
      CellAnswer answer;
      cell.look_up(task, answer);
      if (answer.tier == CellTier::none) continue;
      ++certified;
      CHECK(answer.box >= 0);
      check_answer(region, task, answer);
    }
    CHECK(certified > 190);
    const CellCoverage coverage = cell.coverage();
    CHECK(coverage.proven > 0.97);
    double sum = coverage.proven;
    for (const double gap : coverage.gaps) sum += gap;
    CHECK(sum == doctest::Approx(1));
  }

  TEST_CASE("problems that begin or end moving are no tasks of a cell") {
    const TemporaryDirectory directory;
    const Cell cell = require_cell(require_region(directory, region_text()), 60);
    Problem problem = cell.region().problem;
    problem.start = cell.region().starts.front().q;
    problem.goals.clear();
    problem.pose_goals = {cell.region().middle()};
    problem.pose_goals.front().pose = link_pose(cell.region(), CellTask{});
    REQUIRE(answer_from(cell, problem).has_value());
    problem.start_velocity.assign(problem.start.size(), 0.1);
    CHECK_FALSE(answer_from(cell, problem).has_value());
  }

  TEST_CASE("files that are no cells are not replaced") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 1);
    const std::string file = directory / "region.yaml";
    const Error error = require_error(cell.save(file));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "the output exists and is no cell"));
    CHECK(load_region(file).has_value());
    write_file(directory / "a.cell", "");
    for (int i = 0; i < 2; ++i) require(cell.save(directory / "a.cell"));
  }

  TEST_CASE("where nothing is proven, near paths are bent, and then tasks are planned") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 60);
    // In another world boxes are hints.
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    write_file(directory / "region.yaml", region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.4));
    const auto changed = require(load_cell(file));
    CHECK_FALSE(changed.is_of_this_world());
    CHECK(changed.proven_count() == 0);
    Rng rng(1);
    const CellTask task = random_task_of(region, rng);
    const CellAnswer verified = changed.ask(task);
    CHECK(verified.tier == CellTier::verified);
    check_answer(changed.region(), task, verified);
    // A cell without boxes plans: here the lid blocks a part of the only box that is examined.
    CellSettings one;
    one.boxes = 1;
    CellRegion covered = region;
    covered.problem.scene.obstacles.push_back(
        {"lid", {Box{{Eigen::Matrix3d::Identity(), {0.5, 0.4, 0.35}}, {0.3, 0.25, 0.01}}}});
    const auto empty = require(build_cell(covered, one));
    REQUIRE(empty.box_count() == 0);
    const CellTask far = {0, -0.08, 0, 0};
    const CellAnswer planned = empty.ask(far);
    CHECK(planned.tier == CellTier::planned);
    check_answer(covered, far, planned);
    const CellAnswer beyond = cell.ask({0.2, 0, 0, 0});
    CHECK(beyond.tier == CellTier::none);
    CHECK(beyond.note == "the task is beyond the region: x is 0.2, expected at most 0.1");
  }

  TEST_CASE("paths of proven boxes are bent or extended to tasks beside them, and are free") {
    const TemporaryDirectory directory;
    const CellRegion region =
        require_region(directory, region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.17));
    const Cell cell = require_cell(region, 8);
    REQUIRE(cell.coverage().proven < 0.9);
    Rng rng(7);
    int verified = 0;
    for (int i = 0; i < 150; ++i) {
      INFO("seed 7, task " << i);
      const CellTask task = random_task_of(region, rng, i % 2 == 1);
      const CellAnswer answer = cell.ask(task, 0, 0);
      if (answer.tier == CellTier::none) {
        CHECK(answer.path.empty());
        CHECK(answer.note.starts_with("no proven box"));
      }
      if (answer.tier != CellTier::verified) continue;
      ++verified;
      check_answer(region, task, answer);
    }
    CHECK(verified > 10);
  }

  TEST_CASE("a change of the scene leaves boxes to be proven again") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 60);
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    // The post now stands where hands go.
    write_file(directory / "region.yaml", region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.12));
    auto changed = require(load_cell(file));
    const auto share_of = [](const Cell& each, CellGap gap) {
      return each.coverage().gaps[static_cast<std::size_t>(gap)];
    };
    CHECK(share_of(changed, CellGap::changed) > 0.9);
    CellVerification verification = changed.verify(200);
    CHECK(verification.checked == static_cast<int>(cell.box_count()));
    CHECK(verification.kept == verification.checked);
    CHECK(verification.proven < verification.checked);
    CHECK(verification.in_contact == 0);
    CHECK(changed.is_of_this_world());
    const int proven = verification.proven;
    CHECK(changed.proven_count() == static_cast<std::size_t>(proven));
    // What blocks the boxes that failed is listed, also of the file.
    CHECK(share_of(changed, CellGap::changed) == 0);
    CHECK(share_of(changed, CellGap::contact) > 0.2);
    CHECK(share_of(changed, CellGap::limits) <= share_of(cell, CellGap::limits) + 0.01);
    CHECK(changed.progress().back().proven == doctest::Approx(changed.coverage().proven));
    require(changed.save(directory / "b.cell"));
    const std::vector<UnprovenBox> gaps = require(load_cell(directory / "b.cell")).unproven();
    REQUIRE(gaps.size() == changed.unproven().size());
    CHECK(gaps.size() > cell.unproven().size());
    CHECK(gaps.front().gap == CellGap::contact);
    CHECK(gaps.front().other == "post");
    CHECK(gaps.front().first.starts_with("panda_"));
    // A second call proves all: nothing has changed since.
    verification = changed.verify(0);
    CHECK(verification.kept == 0);
    CHECK(verification.proven == proven);
    // And back: all is proven again.
    write_file(directory / "region.yaml", region_text());
    require(changed.save(file));
    auto restored = require(load_cell(file));
    verification = restored.verify(200);
    CHECK(restored.unproven().size() == cell.unproven().size());
    CHECK(verification.proven == verification.checked);
    CHECK(verification.kept == proven);
    CHECK(verification.paths > 150);
    CHECK(verification.in_contact == 0);
  }

  TEST_CASE("a build that is resumed proves more, also of a file") {
    const TemporaryDirectory directory;
    const CellRegion region =
        require_region(directory, region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.17));
    Cell cell = require_cell(region, 4);
    const double before = cell.coverage().proven;
    CHECK(before < 0.5);
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    auto loaded = require(load_cell(file));
    CellSettings settings;
    settings.boxes = 56;
    settings.seconds = 1000;
    for (Cell* each : {&cell, &loaded}) {
      require(each->extend(settings));
      CHECK(each->coverage().proven > before + 0.3);
      CHECK(each->verify(100).in_contact == 0);
      CHECK(each->proven_count() == each->box_count());
    }
    CHECK(cell.coverage().proven == loaded.coverage().proven);
  }

  TEST_CASE("boxes that a change of the scene blocks are replaced by a resumed build") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const std::string file = directory / "a.cell";
    require(require_cell(region, 60).save(file));
    // The post now stands where hands go.
    write_file(directory / "region.yaml", region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.17));
    auto changed = require(load_cell(file));
    CellSettings settings;
    settings.boxes = 300;
    settings.seconds = 1000;
    CHECK(require_error(changed.extend(settings)).code == ErrorCode::invalid);
    const CellVerification verification = changed.verify(0);
    REQUIRE(verification.proven < verification.checked);
    const double before = changed.coverage().proven;
    require(changed.extend(settings));
    CHECK(changed.coverage().proven > before + 0.02);
    CHECK(changed.proven_count() == changed.box_count());
    CHECK(changed.verify(200).in_contact == 0);
  }

  TEST_CASE("jumps of paths are listed where boxes of different plans meet") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 60);
    const CellContinuity all = cell.continuity(0, 0);
    CHECK(all.faces > 0);
    REQUIRE(all.jumps.size() == static_cast<std::size_t>(all.faces));
    const double median = all.jumps[all.jumps.size() / 2].change;
    const CellContinuity half = cell.continuity(0, median);
    CHECK(half.faces == all.faces);
    CHECK(half.jumps.size() <= all.jumps.size() / 2 + 1);
    for (const CellJump& jump : all.jumps) {
      CHECK(jump.box != jump.next);
      CellAnswer there;
      cell.look_up(jump.task, there);
      REQUIRE(there.tier == CellTier::certified);
      CHECK(there.box == jump.next);
    }
  }

  TEST_CASE("a cell prefers branches near the start, as plans do") {
    const TemporaryDirectory directory;
    const CellRegion region =
        require_region(directory, region_text("{x: 0.08, y: 0.1, z: 0.02, yaw: 0.4}", "", 5));
    const Cell cell = require_cell(region, 200);
    const auto length = [&](const Path& path) {
      double sum = 0;
      for (std::size_t i = 1; i < path.size(); ++i) {
        sum += region.problem.robot.distance(path[i - 1], path[i]);
      }
      return sum;
    };
    Rng rng(1);
    double of_cell = 0, of_plans = 0;
    for (int i = 0; i < 20; ++i) {
      const CellTask task = random_task_of(region, rng);
      CellAnswer answer;
      cell.look_up(task, answer);
      if (answer.tier != CellTier::certified) continue;
      Problem problem = region.problem;
      problem.goals.clear();
      problem.pose_goals = {region.middle()};
      problem.pose_goals[0].pose = link_pose(region, task);
      of_cell += length(answer.path);
      of_plans += length(require(solve(problem, nullptr, {})).plan.path);
    }
    REQUIRE(of_plans > 0);
    CHECK(of_cell < 1.1 * of_plans);
  }

  TEST_CASE("continuous joints take the turn that is nearest to the start") {
    const TemporaryDirectory directory;
    write_turning_panda(directory);
    // The last joint starts near pi, where planners wrap it.
    std::string text = region_text("{x: 0.02, y: 0.02, yaw: 3.1}", "", 5);
    const std::string robot = "robot: panda", turn = "1.571, 0.785]";
    text.replace(text.find(robot), robot.size(), "robot: panda.urdf");
    text.replace(text.find(turn), turn.size(), "1.571, 3.0]");
    const CellRegion region = require_region(directory, text);
    const Cell cell = require_cell(region, 100);
    Rng rng(1);
    int certified = 0;
    double most = 0;
    for (int i = 0; i < 100; ++i) {
      INFO("seed 1, task " << i);
      const CellTask task = random_task_of(region, rng, i % 2 == 1);
      CellAnswer answer;
      cell.look_up(task, answer);
      if (answer.tier == CellTier::none) continue;
      ++certified;
      check_answer(region, task, answer);
      for (std::size_t k = 1; k < answer.path.size(); ++k) {
        CHECK(std::abs(answer.path[k].back() - answer.path[k - 1].back()) < std::numbers::pi);
      }
      most = std::max(most, std::abs(answer.path.back().back() - 3.0));
    }
    CHECK(certified > 90);
    CHECK(most > 2.5);
    CHECK(most < std::numbers::pi + 0.11);
    CHECK(cell.coverage().gaps[static_cast<std::size_t>(CellGap::limits)] < 0.02);
  }

  TEST_CASE("a cell depends on its settings, not on threads") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell one = require_cell(region, 20, 1), three = require_cell(region, 20, 3);
    REQUIRE(one.box_count() == three.box_count());
    require(one.save(directory / "one.cell"));
    require(three.save(directory / "three.cell"));
    check_same_answers(region, one, three);
  }

  TEST_CASE("attached objects, allowed contacts and several starts are part of the proof") {
    const TemporaryDirectory directory;
    const std::string more =
        "attached: [{name: stick, link: panda_hand, touch: [panda_leftfinger, panda_rightfinger],"
        " shapes: [{type: cylinder, position: [0, 0, 0.15], radius: 0.01, length: 0.12}]}]\n"
        "allow: [[stick, table]]\n";
    const CellRegion region = require_region(
        directory, region_text("{x: 0.04, y: 0.04, starts: {side: [0.5, -0.785, 0, -2.356, 0, "
                               "1.571, 0.785]}}",
                               more));
    const Cell cell = require_cell(region, 30);
    Rng rng(1);
    for (const std::size_t start : {0, 1}) {
      const CellTask task = random_task_of(region, rng);
      const CellAnswer answer = cell.ask(task, start);
      CHECK(answer.tier == CellTier::certified);
      check_answer(region, task, answer, start);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a start in contact is refused with what it touches") {
    const TemporaryDirectory directory;
    CellRegion region = require_region(directory, region_text());
    const Robot& robot = region.problem.robot;
    const auto hand = static_cast<std::size_t>(*robot.find_link("panda_hand"));
    const Vec3 place = robot.link_poses(region.starts.front().q)[hand].translation;
    region.problem.scene.obstacles.push_back({"brick", {Sphere{place, 0.02}}});
    const Error refused = require_error(build_cell(region, {}));
    const std::string& message = refused.message;
    CHECK_MESSAGE(message.starts_with("start '" + region.starts.front().name +
                                      "': start is in contact: link 'panda_"),
                  message);
    CHECK_MESSAGE(contains(message, "touches obstacle 'brick'"), message);
    CHECK(find_invalid_start(region, 0.0005).value() == message);
    region.problem.scene.obstacles.pop_back();
    CHECK_FALSE(find_invalid_start(region, 0.0005).value().has_value());
  }

  TEST_CASE("proven boxes are looked up without checkers") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const auto data = require(internal::make_cell_data(region, 5e-4));
    data->starts.resize(1);
    const Cell empty(data);
    CellAnswer answer;
    empty.look_up({}, answer);
    CHECK(answer.tier == CellTier::none);
    CHECK_FALSE(data->made->tools.has_value());
    empty.prepare();
    CHECK(data->made->tools.has_value());
  }

  TEST_CASE("a cell whose scene no checker takes has no answers and proves nothing") {
    const TemporaryDirectory directory;
    CellRegion region = require_region(directory, region_text());
    region.problem.scene.obstacles[0].shapes.clear();
    const auto data = require(internal::make_cell_data(region, 5e-4));
    data->starts.emplace_back().boxes.emplace_back();
    Cell cell(data);
    const CellAnswer answer = cell.ask({});
    CHECK(answer.tier == CellTier::none);
    CHECK(answer.note == "obstacle 'table' has no shapes");
    CHECK(cell.verify(0).proven == 0);
  }

  TEST_CASE("neighbours that are not proven for one reason are one box") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const internal::TaskFrame frame(region);
    internal::SplitTree tree;
    UnprovenBox contact, limits;
    contact.gap = CellGap::contact;
    contact.first = "hand";
    contact.other = "post";
    limits.gap = CellGap::limits;
    const int half = tree.cut(0, 0, 0);
    tree.set_gap(half, contact, true);
    const int quarter = tree.cut(half + 1, 1, 0);
    const int eighth = tree.cut(quarter, 0, 0.05);
    for (const int node : {eighth, eighth + 1}) tree.set_gap(node, limits, false);
    tree.set_gap(quarter + 1, contact, true);
    tree.merge();
    CHECK(tree.nodes.size() == 5);
    const std::vector<UnprovenBox> boxes = tree.unproven(frame);
    REQUIRE(boxes.size() == 3);
    CHECK(boxes[0].share == doctest::Approx(0.5));
    CHECK(boxes[0].first == "hand");
    CHECK(boxes[0].other == "post");
    CHECK(boxes[1].share == doctest::Approx(0.25));
    CHECK(boxes[2].share == doctest::Approx(0.25));
    CHECK(tree.leaf_of({0.05, -0.04, 0, 0}).gap.reason == CellGap::limits);
    CHECK(tree.leaf_of({0.05, 0.04, 0, 0}).gap.reason == CellGap::contact);
    // The last two alone are one box as well.
    for (internal::SplitNode& node : tree.nodes) node.gap.reason = CellGap::contact;
    for (internal::SplitNode& node : tree.nodes) node.gap.first = node.gap.other = 0;
    tree.merge();
    CHECK(tree.nodes.size() == 1);
    CHECK(tree.unproven(frame).front().share == 1);
  }

  TEST_CASE("a start that is near one of a cell, but another, is described") {
    const TemporaryDirectory directory;
    const Cell cell = require_cell(require_region(directory, region_text()), 1);
    Problem problem = cell.region().problem;
    CHECK_FALSE(describe_near_start(cell, problem).has_value());
    problem.start[2] += 1e-7;
    CHECK(contains(describe_near_start(cell, problem).value(), "1e-07 from start 'start'"));
    problem.start[2] += 1e-5;
    CHECK_FALSE(describe_near_start(cell, problem).has_value());
  }

  TEST_CASE("answers name their cell: the same of its file, another after the build went on") {
    const TemporaryDirectory directory;
    Cell cell = require_cell(
        require_region(directory, region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.17)), 8);
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    const auto hash_of = [](const Cell& each) {
      CellAnswer answer;
      each.look_up({}, answer);
      return answer.cell;
    };
    const std::uint64_t hash = hash_of(cell);
    CHECK(hash != 0);
    auto loaded = require(load_cell(file));
    CHECK(hash_of(loaded) == hash);
    loaded.verify(0);
    CHECK(hash_of(loaded) == hash);
    const std::size_t count = cell.box_count();
    require(cell.extend({.seconds = 1000, .boxes = 30}));
    REQUIRE(cell.box_count() > count);
    CHECK(hash_of(cell) != hash);
    // The same boxes in another scene.
    write_file(directory / "region.yaml", region_text("{x: 0.1, y: 0.08, yaw: 0.3}", "", 0.4));
    CHECK(hash_of(require(load_cell(file))) != hash);
  }

  TEST_CASE("a cell of other tasks is refused") {
    const TemporaryDirectory directory;
    const Cell cell = require_cell(require_region(directory, region_text()), 1);
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    write_file(directory / "region.yaml", region_text("{x: 0.12, y: 0.08, yaw: 0.3}"));
    CHECK(require_error(load_cell(file)).code == ErrorCode::invalid);
    write_file(directory / "region.yaml", region_text("{x: 0.1, y: 0.08, yaw: 0.3}"));
    CHECK(load_cell(file).has_value());
  }
}

}  // namespace mneme::test

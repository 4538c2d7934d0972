// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "trajectory/empty_scene.h"
#include "trajectory/trajectory_flaws.h"

#include <algorithm>

namespace mneme::test {
namespace {

const RateLimits kOneTwo = {{1, 1, 1}, {2, 2, 2}};
const RateLimits kOneTwoTwenty = {{1, 1, 1}, {2, 2, 2}, {20, 20, 20}};

/// The motion along a path by itself, to be joined.
MotionPart part_along(const Path& path, const RateLimits& limits, const MotionVerifier& verifier,
                      int rounds = 0) {
  TrajectorySettings settings;
  settings.time_rounds = rounds;
  auto motion =
      require(parameterize(verifier.checker().robot(), path, limits, settings, &verifier));
  return {std::move(motion), limits, &verifier, false};
}

std::vector<MotionPart> parts_along(const std::vector<Path>& paths, const RateLimits& limits,
                                    const MotionVerifier& verifier) {
  std::vector<MotionPart> parts;
  for (const Path& path : paths) parts.push_back(part_along(path, limits, verifier));
  return parts;
}

double sum_of(const std::vector<MotionPart>& parts) {
  double sum_s = 0;
  for (const MotionPart& part : parts) sum_s += part.motion.duration_s();
  return sum_s;
}

/// Cuts a path into up to four.
std::vector<Path> cut_at_random(const Path& path, Rng& rng) {
  std::vector<Path> paths = {{path.front()}};
  for (std::size_t i = 1; i < path.size(); ++i) {
    paths.back().push_back(path[i]);
    if (i + 1 < path.size() && paths.size() < 4 && rng.index(2) == 0) paths.push_back({path[i]});
  }
  return paths;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("joined motions keep all limits and stay near their paths") {
    const EmptyScene empty(planar8());
    Rng rng(11);
    int faster = 0;
    for (int i = 0; i < 60; ++i) {
      CAPTURE(i);
      const Path path = random_path(empty.robot(), rng);
      const RateLimits limits =
          i % 2 == 0 ? random_limits(empty.robot(), rng) : random_jerk_limits(empty.robot(), rng);
      std::vector<MotionPart> parts;
      Configuration end = path.front();
      for (const Path& piece : cut_at_random(path, rng)) {
        parts.push_back(part_along(piece, limits, empty.verifier(), i % 3 == 0 ? 4 : 0));
        // Continuous joints do not jump between parts.
        const Configuration begin = parts.back().motion.at(0).position;
        Configuration turns = end;
        for (std::size_t j = 0; j < end.size(); ++j) turns[j] -= begin[j];
        parts.back().motion.shift(turns);
        end = parts.back().motion.at(parts.back().motion.duration_s()).position;
      }
      const JoinedMotion joined = join_motions(parts, 0.3);
      CHECK(joined.trajectory.duration_s() <= sum_of(parts) + 1e-8);
      faster += joined.trajectory.duration_s() < sum_of(parts) - 1e-3 ? 1 : 0;
      CHECK(joined.begins_s.size() == parts.size());
      CHECK(std::ranges::is_sorted(joined.begins_s));
      const auto flaw = trajectory_flaw(empty.robot(), path, limits, 1.3, joined.trajectory);
      CHECK_MESSAGE(!flaw, flaw.value_or(""));
    }
    CHECK(faster > 20);
  }

  TEST_CASE("away from where they join, joined motions are those of the parts") {
    const EmptyScene empty(gantry());
    const Path path = {{-1, 0, 1}, {0.5, 0, 1}, {0.5, 0.8, 1}, {1, 1, 0.5}};
    for (const RateLimits& limits : {kOneTwo, kOneTwoTwenty}) {
      const auto parts = parts_along({{path[0], path[1]}, {path[1], path[2]}, {path[2], path[3]}},
                                     limits, empty.verifier());
      for (const double tolerance : {0.02, 0.1, 0.3}) {
        const JoinedMotion joined = join_motions(parts, tolerance);
        double farthest = 0;
        for (int i = 0; i <= 5000; ++i) {
          const double time_s = joined.trajectory.duration_s() * i / 5000;
          const Configuration q = joined.trajectory.at(time_s).position;
          const double off = distance_to(path, q);
          farthest = std::max(farthest, off);
          const bool is_near = distance_to({path[1]}, q) <= tolerance + 1e-9 ||
                               distance_to({path[2]}, q) <= tolerance + 1e-9;
          CHECK((is_near || off < 1e-9));
        }
        CHECK(farthest > 0);
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("parts along one line take the time of one motion, where the tolerance lets them") {
    const EmptyScene empty(gantry());
    for (const RateLimits& limits : {kOneTwo, kOneTwoTwenty}) {
      const auto parts =
          parts_along({{{-1, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 1}}}, limits, empty.verifier());
      const double once =
          part_along({{-1, 0, 1}, {1, 0, 1}}, limits, empty.verifier()).motion.duration_s();
      CHECK(join_motions(parts, 0.5).trajectory.duration_s() ==
            doctest::Approx(once).epsilon(0.005));
      CHECK(join_motions(parts, 0).trajectory.duration_s() ==
            doctest::Approx(sum_of(parts)).epsilon(1e-9));
    }
  }

  TEST_CASE("a right angle takes one change of speed instead of two") {
    // At 2 m/s^2 both stops from 1 m/s take half a second; the parabola between them as well.
    const EmptyScene empty(gantry());
    auto parts =
        parts_along({{{-1, 0, 1}, {1, 0, 1}}, {{1, 0, 1}, {1, 1, 1}}}, kOneTwo, empty.verifier());
    const JoinedMotion joined = join_motions(parts, 0.3);
    CHECK(joined.trajectory.duration_s() == doctest::Approx(sum_of(parts) - 0.5).epsilon(0.02));
    CHECK(joined.begins_s[1] == doctest::Approx(2.25).epsilon(0.02));
    parts.front().stops = true;
    CHECK(join_motions(parts, 0.3).trajectory.duration_s() == doctest::Approx(sum_of(parts)));
    CHECK(join_motions(parts, 0.3).begins_s[1] == doctest::Approx(2.5));
  }

  TEST_CASE("a blend keeps the lower limits of both parts") {
    const EmptyScene empty(gantry());
    const RateLimits slow = {{0.2, 0.2, 0.2}, {2, 2, 2}};
    std::vector<MotionPart> parts = {part_along({{-1, 0, 1}, {1, 0, 1}}, kOneTwo, empty.verifier()),
                                     part_along({{1, 0, 1}, {1, 1, 1}}, slow, empty.verifier())};
    const JoinedMotion joined = join_motions(parts, 0.3);
    CHECK(joined.trajectory.duration_s() < sum_of(parts) - 0.05);
    for (int i = 0; i <= 1000; ++i) {
      const auto point = joined.trajectory.at(joined.trajectory.duration_s() * i / 1000);
      CHECK(largest(point.acceleration) <= 2 * (1 + 1e-6));
      if (distance_to({{1, 0, 1}}, point.position) < 0.01 || point.position[1] > 0.01) {
        CHECK(largest(point.velocity) <= 0.2 * (1 + 1e-6));
      }
    }
  }

  TEST_CASE("a blend is proven against the obstacles of both parts") {
    // A ball inside of the turn leaves room for narrow blends, or for none.
    const Path first = {{-1, 0, 1}, {1, 0, 1}}, second = {{1, 0, 1}, {1, 1, 1}};
    const EmptyScene empty(gantry());
    const auto alone = parts_along({first, second}, kOneTwo, empty.verifier());
    const double free_s = join_motions(alone, 0.5).trajectory.duration_s();
    double last_s = free_s;
    for (const double gap : {0.015, 0.002}) {
      const double radius = 0.02;
      const double away = 0.1 + radius + gap;
      Scene scene{"turn", {}};
      scene.obstacles = {make_ball("ball", {1 - away, away, 1}, radius)};
      const CollisionChecker checker = make_checker(gantry(), scene);
      const MotionVerifier verifier(checker);
      for (const bool is_first : {true, false}) {
        auto parts = alone;
        parts[is_first ? 0 : 1].verifier = &verifier;
        const JoinedMotion joined = join_motions(parts, 0.5);
        const double duration_s = joined.trajectory.duration_s();
        CHECK(duration_s > last_s + 1e-3);
        for (int i = 0; i <= 2000; ++i) {
          CHECK(checker.is_valid(joined.trajectory.at(duration_s * i / 2000).position));
        }
        if (!is_first) last_s = duration_s;
      }
    }
    CHECK(last_s < sum_of(alone) - 1e-3);
  }

  TEST_CASE("a part of a motion is the same motion") {
    const EmptyScene empty(gantry());
    for (const RateLimits& limits : {kOneTwo, kOneTwoTwenty}) {
      const Trajectory whole =
          part_along({{-1, 0, 1}, {1, 0, 1}, {1, 1, 0}}, limits, empty.verifier()).motion;
      const double from_s = 0.31 * whole.duration_s(), to_s = 0.77 * whole.duration_s();
      const Trajectory part = whole.between(from_s, to_s);
      CHECK(part.duration_s() == doctest::Approx(to_s - from_s).epsilon(1e-8));
      for (int i = 0; i <= 100; ++i) {
        const double time_s = (to_s - from_s) * i / 100;
        const auto a = part.at(time_s), b = whole.at(from_s + time_s);
        for (std::size_t j = 0; j < 3; ++j) {
          CHECK(a.position[j] == doctest::Approx(b.position[j]).epsilon(1e-9));
          CHECK(a.velocity[j] == doctest::Approx(b.velocity[j]).epsilon(1e-9).scale(1));
        }
      }
      CHECK(largest(part.at(part.duration_s() + 1).velocity) == 0);
    }
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "lessons.h"

#include "mneme/memory.h"

#include "base/fail.h"
#include "baselines/cvae_sampler.h"
#include "baselines/scene_image.h"
#include "memory/planar_chain.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::cvae {
namespace {

constexpr int kGoalAttempts = 100;
constexpr double kLongestStep = 0.4;  // radians between examples of a path
constexpr int kRowsPerHeldOutRow = 10;

std::vector<Configuration> threaded_means(const internal::PlanarChain& chain,
                                          const Experience& row) {
  const LocalSampler& sampler = row.sampler();
  std::vector<Configuration> means;
  for (int i = 0; i < sampler.component_count(); ++i) {
    const auto first = sampler.means.begin() + std::ptrdiff_t{i} * sampler.joint_count;
    Configuration q(first, first + sampler.joint_count);
    if (internal::first_crossing_link(chain, row.key, q) >= 0) means.push_back(std::move(q));
  }
  return means;
}

/// Plans local queries among the circles of a row that has threaded means.
class LocalPlanner {
 public:
  LocalPlanner(const CollisionChecker& checker, const internal::PlanarChain& chain,
               const Experience& row, std::vector<Configuration> starts, std::uint64_t seed)
      : checker_(checker), chain_(chain), row_(row), starts_(std::move(starts)), rng_(seed) {
    auto means = std::make_shared<const GaussianMixture>(row.sampler());
    sampler_ =
        make_mixed_sampler(internal::kBootstrapLambda,
                           make_mixture_sampler(checker.robot(), means, internal::kBootstrapSigma),
                           make_uniform_sampler(checker.robot()));
  }

  /// Solves a query out of the gap. Half of the paths are reversed, because arms also enter gaps.
  std::optional<Path> plan() {
    const Configuration& start = starts_[rng_.index(static_cast<std::uint32_t>(starts_.size()))];
    const PlanQuery query{
        start, internal::sample_outside(checker_, chain_, row_.key, 1, kGoalAttempts, rng_)};
    if (query.goals.empty()) return std::nullopt;
    const LearnSettings learning;
    PlanSettings settings;
    settings.range = learning.range;
    settings.max_iterations = static_cast<std::uint64_t>(learning.max_iterations);
    settings.timeout_s = 1e6;
    settings.seed = rng_.next();
    settings.verify = false;
    PlanResult planned = plan_with(rrt_connect, checker_, query, *sampler_, settings);
    if (!planned.is_solved()) return std::nullopt;
    if (rng_.index(2) == 0) std::ranges::reverse(planned.path);
    return std::move(planned.path);
  }

 private:
  const CollisionChecker& checker_;
  const internal::PlanarChain& chain_;
  const Experience& row_;
  std::vector<Configuration> starts_;
  Rng rng_;
  std::shared_ptr<const Sampler> sampler_;
};

/// The path with states between its waypoints, at most kLongestStep apart.
Path with_states_between(const Robot& robot, const Path& path) {
  Path states = {path.front()};
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double distance = robot.distance(path[i], path[i + 1]);
    const int steps = static_cast<int>(std::ceil(distance / kLongestStep));
    for (int step = 1; step < steps; ++step) {
      const double fraction = static_cast<double>(step) / steps;
      states.push_back(internal::interpolate(robot, path[i], path[i + 1], fraction));
    }
    states.push_back(path[i + 1]);
  }
  return states;
}

class LessonMaker {
 public:
  LessonMaker(const Robot& robot, const internal::PlanarChain& chain,
              const LessonSettings& settings)
      : robot_(robot), chain_(chain), settings_(settings), joints_(find_symmetric_joints(robot)) {
    lessons_.half_extent = chain.reach();
    lessons_.cells = static_cast<int>(std::ceil(2 * chain.reach() / settings.cell));
  }

  /// Adds a row as it was learned, and its mirror image, which is as good.
  Result<void> add(const Experience& row) {
    if (row.key.size() != kCirclePairKeySize) {
      return fail(ErrorCode::invalid, "row {} is no pair of circles: its key has {} numbers",
                  row.id, row.key.size());
    }
    const std::vector<Path> paths = MNEME_TRY(plan_paths(row));
    if (paths.empty()) {
      ++lessons_.skipped_rows;
      return {};
    }
    const bool is_held_out = lessons_.rows++ % kRowsPerHeldOutRow == 0;
    Examples& examples = is_held_out ? lessons_.held_out : lessons_.training;
    for (const bool is_mirrored : {false, true}) add_scene(row.key, is_mirrored, paths, examples);
    return {};
  }

  Lessons take() { return std::move(lessons_); }

 private:
  /// Paths with a state at least between their ends.
  Result<std::vector<Path>> plan_paths(const Experience& row) {
    std::vector<Path> paths;
    std::vector<Configuration> starts = threaded_means(chain_, row);
    if (starts.empty()) return paths;
    const CollisionChecker checker = MNEME_TRY(CollisionChecker::make(robot_, make_scene(row.key)));
    const auto seed = derive_seed(settings_.seed, static_cast<std::uint64_t>(row.id));
    LocalPlanner planner(checker, chain_, row, std::move(starts), seed);
    for (int i = 0; i < settings_.queries; ++i) {
      ++lessons_.queries;
      const auto path = planner.plan();
      if (!path) continue;
      ++lessons_.solved_queries;
      Path states = with_states_between(robot_, *path);
      if (states.size() > 2) paths.push_back(std::move(states));
    }
    return paths;
  }

  /// Adds the states between the ends of the paths as examples. Planners have the ends themselves.
  void add_scene(const PrimitiveKey& key, bool is_mirrored, const std::vector<Path>& paths,
                 Examples& examples) const {
    const double direction = internal::mean_direction(moved_key({0, is_mirrored}, key));
    const Symmetry motion{-direction, is_mirrored};
    const auto image =
        internal::draw_image(moved_key(motion, key), lessons_.cells, lessons_.half_extent);
    for (const float value : image) {
      examples.images.push_back(static_cast<std::uint8_t>(std::lround(255 * value)));
    }
    const auto add_to = [&](std::vector<float>& rows, const Configuration& q) {
      const auto scaled =
          internal::scaled_to_limits(robot_, moved_configuration(joints_, motion, q));
      rows.insert(rows.end(), scaled.begin(), scaled.end());
    };
    for (const Path& path : paths) {
      const std::size_t number = examples.ends.size() / (2 * path.front().size());
      add_to(examples.ends, path.front());
      add_to(examples.ends, path.back());
      for (std::size_t i = 1; i + 1 < path.size(); ++i) {
        add_to(examples.configurations, path[i]);
        examples.paths.push_back(static_cast<std::int64_t>(number));
      }
    }
    examples.begins.push_back(static_cast<std::int64_t>(examples.paths.size()));
  }

  const Robot& robot_;
  const internal::PlanarChain& chain_;
  const LessonSettings& settings_;
  SymmetricJoints joints_;
  Lessons lessons_;
};

}  // namespace

Result<Lessons> make_lessons(const Robot& robot, const Database& database,
                             const LessonSettings& settings) {
  const MemoryKind* pairs = MNEME_TRY(find_memory_kind("pairs"));
  const auto chain = MNEME_TRY(internal::PlanarChain::make(robot));
  std::vector<std::shared_ptr<const Experience>> rows;
  MNEME_TRY(database.for_each([&](const std::shared_ptr<const Experience>& row) {
    if (row->kind == pairs->version && !row->is_path()) rows.push_back(row);
  }));
  LessonMaker maker(robot, chain, settings);
  for (const auto& row : rows) MNEME_TRY(maker.add(*row));
  Lessons lessons = maker.take();
  if (lessons.rows < 2) {
    return fail(ErrorCode::invalid,
                "{} of {} rows of the kind 'pairs' have a solved local query; expected at least 2, "
                "one of which is held out",
                lessons.rows, rows.size());
  }
  return lessons;
}

}  // namespace mneme::cvae

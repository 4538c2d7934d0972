// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "memory/local_queries.h"
#include "memory/passage_queries.h"
#include "memory/planar_chain.h"
#include "memory/threaded.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mneme {
namespace {

/// Planar arms, stratified by the first link that crosses the gap: the last link is shallow.
class ThreadedQueries final : public internal::QuerySource {
 public:
  ThreadedQueries(const CollisionChecker& checker, const internal::PlanarChain& chain,
                  const PrimitiveKey& key)
      : checker_(checker), chain_(chain), key_(key) {}

  [[nodiscard]] int depth_count() const override { return chain_.link_count(); }

  [[nodiscard]] std::optional<Configuration> draw_start(int depth, std::span<const Configuration>,
                                                        Rng& rng) const override {
    constexpr int kAttempts = 300;
    const int link = chain_.link_count() - 1 - depth;
    return internal::sample_threaded(checker_, chain_, key_, link, kAttempts, rng);
  }

  [[nodiscard]] bool is_clear(std::span<const double> q) const override {
    return internal::first_crossing_link(chain_, key_, q) < 0;
  }

 private:
  const CollisionChecker& checker_;
  const internal::PlanarChain& chain_;
  const PrimitiveKey& key_;
};

Result<CollisionChecker> make_checker(const Robot& robot, const Scene& scene,
                                      const LearnSettings& settings) {
  CheckerSettings checking;
  checking.resolution = settings.resolution;
  return CollisionChecker::make(robot, scene, checking);
}

/// A key of another kind would be read as circles that nobody meant.
Result<void> check_circles(const PrimitiveKey& key) {
  constexpr std::size_t kPairKeySize = 6;
  constexpr double kFarthest = 1e6;
  // Written so that a NaN is no length.
  const auto is_length = [](double value) { return std::abs(value) <= kFarthest; };
  if (key.size() == kPairKeySize && std::ranges::all_of(key, is_length)) return {};
  return fail(ErrorCode::invalid,
              fmt::format("a primitive of a planar arm cannot be learned: its key is ({:.4g}); "
                          "expected the 6 numbers of a pair of circles, metres, at most {}",
                          fmt::join(key, ", "), kFarthest));
}

/// Takes means from the scene of the primitive to its canonical frame.
void move_means(const SymmetricJoints& joints, const Symmetry& motion, LocalSampler& sampler) {
  const auto size = static_cast<std::size_t>(sampler.joint_count);
  for (std::size_t i = 0; i + size <= sampler.means.size(); i += size) {
    const Configuration q(sampler.means.begin() + static_cast<std::ptrdiff_t>(i),
                          sampler.means.begin() + static_cast<std::ptrdiff_t>(i + size));
    const Configuration moved = moved_configuration(joints, motion, q);
    std::copy(moved.begin(), moved.end(), sampler.means.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

std::string describe(const LearnSettings& settings) {
  std::string text;
  visit_settings(settings, [&](const char* name, const auto& value, auto, auto, const char*) {
    text += fmt::format("{}{}=", text.empty() ? "" : " ", name);
    if constexpr (SettingTraits<std::remove_cvref_t<decltype(value)>>::kIsOptional) {
      text += value ? fmt::format("{}", *value) : "default";
    } else {
      text += fmt::format("{}", value);
    }
  });
  return text;
}

Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                        const LearnSettings& settings, std::uint64_t seed,
                                        double deadline_s, const std::atomic<bool>* cancel) {
  const auto chain = internal::PlanarChain::make(robot);
  if (!chain) return tl::unexpected(chain.error());
  if (const auto checked = check_circles(key); !checked) return tl::unexpected(checked.error());
  const auto checker = make_checker(robot, make_scene(key), settings);
  if (!checker) return tl::unexpected(checker.error());
  const ThreadedQueries queries(*checker, *chain, key);
  return internal::learn_from_queries(*checker, queries, settings, seed, deadline_s, cancel);
}

Result<LearnResult> learn_local_sampler(const Robot& robot, const LocalProblem& problem,
                                        const LearnSettings& settings, std::uint64_t seed,
                                        double deadline_s, const std::atomic<bool>* cancel) {
  const LocalPrimitive& primitive = problem.primitive;
  if (robot.is_planar()) {
    return learn_local_sampler(robot, primitive.key, settings, seed, deadline_s, cancel);
  }
  const auto checker = make_checker(robot, problem.scene, settings);
  if (!checker) return tl::unexpected(checker.error());
  const auto queries = internal::PassageQueries::make(*checker);
  LearnResult result;
  result.sampler.joint_count = robot.joint_count();
  if (!queries) return result;
  result = internal::learn_from_queries(*checker, *queries, settings, seed, deadline_s, cancel);
  move_means(find_symmetric_joints(robot), inverse(primitive.to_scene), result.sampler);
  return result;
}

std::vector<LocalProblem> local_problems(const Scene& scene,
                                         std::span<const LocalPrimitive> primitives) {
  std::vector<LocalProblem> problems;
  for (const LocalPrimitive& primitive : primitives) {
    LocalProblem& problem = problems.emplace_back();
    problem.primitive = primitive;
    problem.scene.name = scene.name;
    for (const int index : primitive.obstacles) {
      problem.scene.obstacles.push_back(scene.obstacles[static_cast<std::size_t>(index)]);
    }
  }
  return problems;
}

}  // namespace mneme

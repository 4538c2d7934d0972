// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/local_queries.h"
#include "support/lifting_arm.h"

namespace mneme::test {
namespace {

/// Starts at one configuration per depth; everything else is out.
class Scripted final : public internal::QuerySource {
 public:
  explicit Scripted(std::vector<std::optional<Configuration>> starts)
      : starts_(std::move(starts)) {}
  [[nodiscard]] int depth_count() const override { return static_cast<int>(starts_.size()); }
  [[nodiscard]] std::optional<Configuration> draw_start(int depth, std::span<const Configuration>,
                                                        Rng&) const override {
    asked_.push_back(depth);
    return starts_[static_cast<std::size_t>(depth)];
  }
  [[nodiscard]] bool is_clear(std::span<const double>) const override { return true; }
  [[nodiscard]] const std::vector<int>& asked() const { return asked_; }

 private:
  std::vector<std::optional<Configuration>> starts_;
  mutable std::vector<int> asked_;
};

CollisionChecker empty_checker() {
  auto checker = CollisionChecker::make(lifting_arm(), Scene{});
  REQUIRE(checker.has_value());
  return *checker;
}

LearnSettings small() {
  LearnSettings settings;
  settings.starts_per_link = 2;
  settings.paths_per_start = 2;
  return settings;
}

LearnResult learn(const internal::QuerySource& source, std::uint64_t seed) {
  return internal::learn_from_queries(empty_checker(), source, small(), seed, 0, nullptr);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("depths are asked from shallow to deep, and one without a start is passed over") {
    const Configuration q = {0.1, 0.2, 0, 0};
    const Scripted source({q, std::nullopt, q});
    const LearnResult result = learn(source, 1);
    CHECK(source.asked() == std::vector<int>{0, 0, 1, 2, 2});
    CHECK(result.queries == 8);
    CHECK(result.solved == 8);
    CHECK(result.sampler.joint_count == 4);
    CHECK(result.sampler.component_count() >= 8);
  }

  TEST_CASE("without starts nothing is learned") {
    const LearnResult result = learn(Scripted({std::nullopt}), 1);
    CHECK(result.queries == 0);
    CHECK(result.sampler.component_count() == 0);
  }

  TEST_CASE("a cancelled lesson stops at once") {
    const std::atomic<bool> cancel = true;
    const Scripted source({Configuration{0.1, 0.2, 0, 0}});
    const LearnResult result =
        internal::learn_from_queries(empty_checker(), source, small(), 1, 0, &cancel);
    CHECK(result.queries == 0);
    CHECK(source.asked().empty());
  }
}

TEST_SUITE("law") {
  TEST_CASE(
      "the same seed teaches the same, starts are among the means, and all of them are valid") {
    const Configuration q = {0.1, 0.2, 0, 0};
    const Scripted source({q, q});
    const LearnResult result = learn(source, 5);
    CHECK(result.sampler.means == learn(source, 5).sampler.means);
    CHECK(result.sampler.means[1] == doctest::Approx(0.2));
    const CollisionChecker checker = empty_checker();
    for (int i = 0; i < result.sampler.component_count(); ++i) {
      const std::span<const float> mean(result.sampler.means.data() + 4 * i, 4);
      REQUIRE(checker.is_valid(mean));
    }
  }
}

}  // namespace mneme::test

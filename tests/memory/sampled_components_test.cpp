// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/sampled_components.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

using internal::SampledComponents;

/// Two groups of two components: planar8 stretched out into the direction (group, component).
class Pointers final : public ComponentSource {
 public:
  int group_count() const override { return 2; }
  int component_count(int) const override { return 2; }
  SampleSource sample_source(int group) const override { return group + 3; }
  bool make(int group, int component, std::span<float> mean) const override {
    std::ranges::fill(mean, 0.0f);
    mean[0] = static_cast<float>(group) + 0.5f * static_cast<float>(component);
    return group == 0 || component == 1;
  }
  std::span<const float> factor(int group, int) const override {
    return group == 0 ? std::span<const float>() : shape_;
  }

 private:
  std::vector<float> shape_ = std::vector<float>(36, 0.5f);
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("what was made is noted once, in that order, with all that belongs to it") {
    const SampledComponents drawn(std::make_shared<Pointers>(), 8, std::nullopt);
    std::vector<float> q(8);
    CHECK(drawn.made().component_count() == 0);
    CHECK(drawn.make(1, 1, q));
    CHECK(q[0] == 1.5f);
    CHECK(!drawn.make(1, 0, q));
    CHECK(drawn.make(0, 1, q));
    CHECK(drawn.make(1, 1, q));
    const GaussianMixture made = drawn.made();
    REQUIRE(made.component_count() == 2);
    CHECK(made.means[0] == 1.5f);
    CHECK(made.means[8] == 0.5f);
    CHECK(made.sources == std::vector<SampleSource>{4, 3});
    CHECK(made.factor_rows == std::vector<int>{0, -1});
    CHECK(made.factors == std::vector<float>(36, 0.5f));
  }

  TEST_CASE("means in contact are not made where they are looked at") {
    const CollisionChecker checker = make_checker(planar8(), make_circle_scene("", {{5, 0, 1}}));
    const SampledComponents drawn(std::make_shared<Pointers>(), 8, checker);
    std::vector<float> q(8);
    CHECK(!drawn.make(0, 0, q));
    CHECK(drawn.make(0, 1, q));
    CHECK(drawn.made().component_count() == 1);
  }
}

}  // namespace mneme::test

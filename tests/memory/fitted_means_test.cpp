// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/moved_means.h"
#include "memory/gap_fit.h"
#include "support/kinds.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

#include <memory>

namespace mneme::test {
namespace {

using internal::find_gap_crossing;
using internal::gap_segment;
using internal::PlanarChain;

std::shared_ptr<const Experience> lesson(const PrimitiveKey& key, std::uint64_t seed = 1) {
  Experience row;
  row.key = key;
  row.sampler() = learn(planar8(), key, cheap_settings(), seed).sampler;
  REQUIRE(row.sampler().component_count() > 10);
  return std::make_shared<const Experience>(std::move(row));
}

/// The matches of a pair if memory has only this experience.
PrimitiveRetrieval retrieval_of(const PrimitiveKey& scene_pair,
                                std::vector<std::shared_ptr<const Experience>> experiences) {
  const MemoryKind& kind = kind_named("pairs");
  PrimitiveRetrieval retrieval;
  retrieval.primitive = make_primitive(scene_pair);
  const auto images = kind.images(retrieval.primitive.key);
  for (const auto& experience : experiences) {
    Match match{experience, 1e9, {}};
    for (const KeyImage& image : images) {
      double error = 0;
      for (std::size_t i = 0; i < image.key.size(); ++i) {
        error += std::pow(image.key[i] - experience->key[i], 2);
      }
      if (error >= match.similarity_error) continue;
      match.similarity_error = error;
      match.to_scene = compose(retrieval.primitive.to_scene, {0, image.is_mirrored});
    }
    retrieval.matches.push_back(std::move(match));
  }
  return retrieval;
}

std::shared_ptr<const ComponentSource> source_of(const Scene& scene,
                                                 const std::vector<PrimitiveRetrieval>& retrievals,
                                                 const Configuration* start = nullptr) {
  auto source = internal::retarget_means({planar8(), scene, start}, retrievals, 5);
  REQUIRE(source != nullptr);
  return source;
}

/// The means of a group, one after the other; those that have nothing to say are left out.
std::vector<Configuration> means_of(const ComponentSource& source, int group) {
  std::vector<Configuration> means;
  std::vector<float> mean(8);
  for (int i = 0; i < source.component_count(group); ++i) {
    if (source.make(group, i, mean)) means.emplace_back(mean.begin(), mean.end());
  }
  return means;
}

int count_free(const CollisionChecker& checker, const std::vector<Configuration>& means) {
  return static_cast<int>(std::ranges::count_if(
      means, [&](const auto& q) { return checker.is_valid(std::span<const double>(q)); }));
}

/// A configuration of a lesson whose first crossing link is `link`.
Configuration crossing_at(const Experience& experience, int link) {
  const PlanarChain chain = PlanarChain::make(planar8()).value();
  for (int i = 0; i < experience.sampler().component_count(); ++i) {
    Configuration q = mean_of(experience.sampler(), i);
    if (find_gap_crossing(chain, gap_segment(experience.key), q).link == link) return q;
  }
  FAIL("no mean crosses so");
  return {};
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("means of the pair itself come back, wherever it is turned or mirrored") {
    const PrimitiveKey key = near_pair();
    const auto known = lesson(key);
    for (const Symmetry& motion : {Symmetry{}, Symmetry{2, false}, Symmetry{-1.2, true}}) {
      PrimitiveKey pair = moved_key(motion, key);
      for (int order = 0; order < 2; ++order) {
        const auto source = source_of(make_scene(pair), {retrieval_of(pair, {known})});
        const CollisionChecker checker = make_checker(planar8(), make_scene(pair));
        const auto means = means_of(*source, 0);
        CHECK(static_cast<int>(means.size()) == known->sampler().component_count());
        // Means at the surface may be in contact by a rounding error.
        CHECK(count_free(checker, means) >= 0.97 * static_cast<double>(means.size()));
        std::rotate(pair.begin(), pair.begin() + 3, pair.end());
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("means deeper in the gap than the start have nothing to say") {
    const auto known = lesson(near_pair());
    const PlanarChain chain = PlanarChain::make(planar8()).value();
    const Configuration start = crossing_at(*known, 6);
    const Scene scene = make_scene(near_pair());
    const auto source = source_of(scene, {retrieval_of(near_pair(), {known})}, &start);
    const auto means = means_of(*source, 0);
    CHECK(!means.empty());
    CHECK(static_cast<int>(means.size()) < known->sampler().component_count());
    for (const Configuration& q : means) {
      const int link = find_gap_crossing(chain, gap_segment(near_pair()), q).link;
      CHECK((link == -1 || link >= 6));
    }
  }

  TEST_CASE("pairs that the start crosses come first, then rank decides, then similarity") {
    const PrimitiveKey crossed = near_pair();
    const PrimitiveKey other = moved_key({2.5, false}, near_pair());
    const auto near = lesson(crossed), far = lesson(keys_near(crossed, 1, 0.2, 8).front(), 2);
    const Configuration start = crossing_at(*near, 7);
    const Scene scene = make_scene(crossed);
    const std::vector<PrimitiveRetrieval> retrievals = {retrieval_of(other, {near, far}),
                                                        retrieval_of(crossed, {near, far})};
    const auto source = source_of(scene, retrievals, &start);
    REQUIRE(source->group_count() == 4);
    CHECK(source->first_groups() == 1);
    const std::vector<SampleSource> sources = {source->sample_source(0), source->sample_source(1),
                                               source->sample_source(2), source->sample_source(3)};
    CHECK(sources == std::vector<SampleSource>{6, 6, 5, 5});
    // Without a start no pair comes before the others.
    const auto unknown = source_of(scene, retrievals);
    CHECK(unknown->sample_source(0) != unknown->sample_source(1));
  }

  TEST_CASE("all pairs that the start crosses take part from the first draw on") {
    const auto near = lesson(near_pair());
    const Configuration start = crossing_at(*near, 7);
    const PrimitiveKey twin = near_pair();
    const auto source = source_of(
        make_scene(twin), {retrieval_of(twin, {near, near}), retrieval_of(twin, {near})}, &start);
    CHECK(source->group_count() == 3);
    CHECK(source->first_groups() == 2);
  }

  TEST_CASE("a covariance stays what it was") {
    auto known = std::make_shared<Experience>(*lesson(near_pair()));
    known->sampler().factors.assign(36, 0.25f);
    known->sampler().factor_rows.assign(
        static_cast<std::size_t>(known->sampler().component_count()), -1);
    known->sampler().factor_rows[2] = 0;
    const auto source = source_of(make_scene(near_pair()), {retrieval_of(near_pair(), {known})});
    CHECK(source->factor(0, 1).empty());
    CHECK(source->factor(0, 2).size() == 36);
    CHECK(source->factor(0, 2)[7] == 0.25f);
  }

  TEST_CASE("means outside the limits of the joints have nothing to say") {
    const auto known = lesson(near_pair());
    const Robot robot = limited_arm(planar8_lengths(), -1, 1);
    const Scene scene = make_scene(near_pair());
    const std::vector<PrimitiveRetrieval> retrievals = {retrieval_of(near_pair(), {known})};
    const auto source = internal::retarget_means({robot, scene}, retrievals, 0);
    REQUIRE(source != nullptr);
    const auto means = means_of(*source, 0);
    CHECK(static_cast<int>(means.size()) < known->sampler().component_count());
    for (const Configuration& q : means) CHECK(!robot.describe_violation(q, "mean"));
  }

  TEST_CASE("an arm that is no chain of capsules is left to the other way") {
    const Scene scene;
    CHECK(internal::retarget_means({lifting_arm(), scene}, {}, 0) == nullptr);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

#include <map>
#include <utility>

namespace mneme::test {
namespace {

/// Groups of components of a robot of three joints: group g has its source 10 + g and its means at
/// (0, 0, 1 + 0.1 g). Notes what is made.
class FakeSource final : public ComponentSource {
 public:
  explicit FakeSource(std::vector<int> sizes, int first_groups = 1)
      : sizes_(std::move(sizes)), first_groups_(first_groups) {}

  int group_count() const override { return static_cast<int>(sizes_.size()); }
  int first_groups() const override { return first_groups_; }
  int component_count(int group) const override {
    return sizes_.at(static_cast<std::size_t>(group));
  }
  SampleSource sample_source(int group) const override { return 10 + group; }
  bool make(int group, int component, std::span<float> mean) const override {
    ++made[{group, component}];
    mean[0] = mean[1] = 0;
    mean[2] = 1 + 0.1f * static_cast<float>(group);
    return !silent.contains({group, component});
  }
  std::span<const float> factor(int, int) const override { return shape; }

  std::map<std::pair<int, int>, bool> silent;
  std::vector<float> shape;
  mutable std::map<std::pair<int, int>, int> made;

 private:
  std::vector<int> sizes_;
  int first_groups_;
};

Samples draw_components(std::shared_ptr<const FakeSource> source, double sigma, int count,
                        std::uint64_t seed = 1) {
  const Robot robot = all_kinds();
  return draw(*make_component_sampler(robot, std::move(source), sigma), 3, seed, count);
}

std::map<SampleSource, int> counts(const std::vector<SampleSource>& sources) {
  std::map<SampleSource, int> result;
  for (const SampleSource source : sources) ++result[source];
  return result;
}

TEST_SUITE("unit") {
  TEST_CASE("the seed decides the stream of components") {
    const Robot robot = all_kinds();
    check_seeds(
        *make_component_sampler(robot, std::make_shared<FakeSource>(std::vector{3, 2}), 0.1), 3);
  }

  TEST_CASE("a component is made when it is first drawn, and once") {
    const auto source = std::make_shared<FakeSource>(std::vector{1000});
    draw_components(source, 0.1, 1);
    CHECK(source->made.size() == 1);
    source->made.clear();
    draw_components(source, 0.1, 900);
    CHECK(source->made.size() < 900);
    CHECK(source->made.size() > 400);
    for (const auto& [component, times] : source->made) CHECK(times == 1);
  }

  TEST_CASE("a group more takes part every so many draws, from the first ones on") {
    const auto source = std::make_shared<FakeSource>(std::vector{5, 5, 5, 5}, 2);
    const int period = ComponentSource::kSamplesPerGroup;
    const Samples samples = draw_components(source, 0.1, 3 * period);
    const auto part = [&](int begin, int end) {
      return counts({samples.sources.begin() + begin, samples.sources.begin() + end});
    };
    CHECK(part(0, period - 1).size() == 2);
    CHECK(part(0, period - 1).contains(11));
    CHECK(part(period, 2 * period - 1).size() == 3);
    CHECK(part(2 * period, 3 * period).size() == 4);
  }

  TEST_CASE("what has nothing to say is asked once and never drawn") {
    const auto source = std::make_shared<FakeSource>(std::vector{2, 1});
    source->silent[{0, 0}] = source->silent[{0, 1}] = true;
    const Samples samples = draw_components(source, 0.1, 50);
    CHECK(counts(samples.sources) == std::map<SampleSource, int>{{11, 50}});
    CHECK(source->made.size() == 3);
  }

  TEST_CASE("where nothing has anything to say samples are uniform") {
    const auto silent = std::make_shared<FakeSource>(std::vector{2, 0, 1});
    silent->silent[{0, 0}] = silent->silent[{0, 1}] = silent->silent[{2, 0}] = true;
    for (const auto& source : {silent, std::make_shared<FakeSource>(std::vector<int>{})}) {
      const Samples samples = draw_components(source, 0.1, 2000);
      CHECK(counts(samples.sources) == std::map<SampleSource, int>{{kUniformSource, 2000}});
      // The first joint turns all the way, the second from -2 to 1.
      CHECK(chi_square(samples.columns[1], -2, 1, 10) < 30);
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("samples of components are within the limits") {
    const Robot robot = all_kinds();
    check_limits(*make_component_sampler(robot, std::make_shared<FakeSource>(std::vector{3, 2}), 1),
                 robot, 20000);
  }

  TEST_CASE("samples have the deviation of sigma, slides half as many metres") {
    const Samples samples =
        draw_components(std::make_shared<FakeSource>(std::vector{1}), 0.2, 40000);
    const std::vector<double> deviations = {0.2, 0.2, 0.1};
    for (std::size_t j = 0; j < 3; ++j) {
      CHECK(mean(samples.columns[j]) == doctest::Approx(j == 2 ? 1.0 : 0.0).epsilon(0.01));
      const double variance = covariance(samples.columns[j], samples.columns[j]);
      CHECK(std::sqrt(variance) == doctest::Approx(deviations[j]).epsilon(0.03));
    }
  }

  TEST_CASE("a factor shapes the samples of its component") {
    const auto source = std::make_shared<FakeSource>(std::vector{1});
    source->shape = {0.1f, 0.08f, 0.06f, 0, 0, 0.05f};
    const Samples samples = draw_components(source, 0.2, 40000);
    CHECK(covariance(samples.columns[0], samples.columns[0]) ==
          doctest::Approx(0.01).epsilon(0.05));
    CHECK(covariance(samples.columns[1], samples.columns[1]) ==
          doctest::Approx(0.01).epsilon(0.05));
    CHECK(covariance(samples.columns[0], samples.columns[1]) ==
          doctest::Approx(0.008).epsilon(0.05));
    CHECK(std::abs(correlation(samples.columns[0], samples.columns[2])) < 0.02);
  }

  TEST_CASE("all components of the groups that take part are equally likely") {
    const auto source = std::make_shared<FakeSource>(std::vector{3, 1}, 2);
    const auto shares = counts(draw_components(source, 0.1, 40000).sources);
    CHECK(shares.at(10) == doctest::Approx(30000).epsilon(0.03));
  }
}

}  // namespace
}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planning_fixture.h"
#include "planning/scripted_sampler.h"
#include "planning/anchored_samples.h"

#include <algorithm>
#include <cmath>

namespace mneme::test {
namespace {

using Row = std::vector<float>;

PlanSettings anchored(double probability, std::optional<double> sigma = {}) {
  PlanSettings settings;
  settings.anchor = probability;
  settings.anchor_sigma = sigma;
  return settings;
}

World open_room(const Robot& robot) {
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  return {"open", robot, {}, {zero, {zero}}};
}

std::vector<Row> sample_rows(RunFixture& f, int count, const Row& newest) {
  internal::AnchoredSamples samples(f.run);
  std::vector<Row> rows;
  for (int i = 0; i < count; ++i) {
    rows.emplace_back(newest.size());
    CHECK(samples.next(newest, rows.back()) == kUniformSource);
  }
  return rows;
}

/// Mean and standard deviation of the differences from `newest` of one joint.
std::pair<double, double> spread_of(const std::vector<Row>& rows, const Row& newest,
                                    std::size_t joint) {
  double sum = 0, squares = 0;
  for (const Row& row : rows) {
    const double off = static_cast<double>(row[joint]) - newest[joint];
    sum += off;
    squares += off * off;
  }
  const double count = static_cast<double>(rows.size()), mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean)};
}

/// A slide along z, then two joints that turn.
Robot lift() {
  Robot::Parts parts;
  parts.name = "lift";
  parts.links.push_back({.name = "base"});
  add_link(parts, JointType::prismatic, Vec3::Zero(), Vec3::UnitZ(), 2, {{Vec3::Zero(), 0.1}});
  add_link(parts, JointType::revolute, Vec3(0, 0, 0.3), Vec3::UnitZ(), 2, {{Vec3(1, 0, 0), 0.1}});
  add_link(parts, JointType::continuous, Vec3(1, 0, 0), Vec3::UnitZ(), kPi, {{Vec3(1, 0, 0), 0.1}});
  return make_small_robot(std::move(parts));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("without anchors the samples are the sampler's") {
    RunFixture f(open_room(lift()), anchored(0));
    internal::AnchoredSamples samples(f.run);
    const auto stream = f.sampler->start(f.settings.seed);
    Row sampled(3), expected(3);
    for (int i = 0; i < 1000; ++i) {
      CHECK(samples.next(Row{0, 0, 0}, sampled) == stream->next(expected));
      CHECK(sampled == expected);
    }
  }

  TEST_CASE("samples that come from memory are never replaced") {
    const std::vector<Configuration> script = {{0.5, 1, -1}, {-0.25, 0.125, 3}, {1, -1, 0}};
    RunFixture f(open_room(lift()), anchored(1, 0.01), Isa::automatic,
                 std::make_unique<ScriptedSampler>(script));
    internal::AnchoredSamples samples(f.run);
    Row q(3);
    for (std::size_t i = 0; i < 300; ++i) {
      CHECK(samples.next(Row{0, 0, 0}, q) == static_cast<SampleSource>(i % 3));
      CHECK(Configuration(q.begin(), q.end()) == script[i % 3]);
    }
  }

  TEST_CASE("each sample takes one of the sampler's, whether it is replaced or not") {
    const auto rng_free = [](double probability) {
      RunFixture f(open_room(lift()), anchored(probability, 1e-3));
      internal::AnchoredSamples samples(f.run);
      Row q(3);
      for (int i = 0; i < 100; ++i) samples.next(Row{0, 0, 0}, q);
      f.run.next_sample(q);
      return q;
    };
    CHECK(rng_free(0) == rng_free(1));
    CHECK(rng_free(0) == rng_free(0.5));
  }

  TEST_CASE("the observer sees each sample as it is returned, once") {
    struct Spy : PlanObserver {
      std::vector<std::pair<Row, SampleSource>> seen;
      void on_sample(std::span<const float> q, SampleSource source) override {
        seen.emplace_back(Row(q.begin(), q.end()), source);
      }
    } spy;
    PlanSettings settings = anchored(0.5, 0.1);
    settings.observer = &spy;
    RunFixture f(open_room(lift()), settings);
    internal::AnchoredSamples samples(f.run);
    Row q(3);
    for (std::size_t i = 0; i < 200; ++i) {
      const SampleSource source = samples.next(Row{0.5, 0.5, 0.5}, q);
      REQUIRE(spy.seen.size() == i + 1);
      CHECK(spy.seen.back() == std::pair(q, source));
    }
  }

  TEST_CASE("only early samples are pulled, up to half of the way to the target") {
    RunFixture f(open_room(lift()), anchored(1, 0.01));
    REQUIRE(f.run.is_early());
    internal::AnchoredSamples samples(f.run);
    const Row newest = {0, -0.5f, 3}, target = {0, 1.5f, 3};
    const auto mean_and_spread = [&] {
      std::vector<Row> rows(2000, Row(3));
      for (Row& row : rows) samples.next(newest, row, target);
      CHECK(std::abs(spread_of(rows, newest, 0).first) < 1e-3);
      return spread_of(rows, newest, 1);
    };
    const auto [early, early_spread] = mean_and_spread();
    CHECK(early == doctest::Approx(0.5).epsilon(0.05));
    CHECK(early_spread == doctest::Approx(1 / std::sqrt(12.0)).epsilon(0.05));
    f.run.begin_iterations(1000);
    const auto [late, late_spread] = mean_and_spread();
    CHECK(std::abs(late) < 1e-3);
    CHECK(late_spread == doctest::Approx(0.01).epsilon(0.1));
  }

  TEST_CASE("the same seed gives the same samples and another one others") {
    const Row newest = {0.5, -0.5, 3};
    std::vector<std::vector<Row>> runs;
    for (const std::uint64_t seed : {1, 1, 2}) {
      PlanSettings settings = anchored(0.8);
      settings.seed = seed;
      RunFixture f(open_room(lift()), settings);
      runs.push_back(sample_rows(f, 100, newest));
    }
    CHECK(runs[0] == runs[1]);
    CHECK(runs[0] != runs[2]);
  }
}

TEST_SUITE("law") {
  TEST_CASE("anchored samples lie around the newest node, slides by half as much") {
    constexpr double kSigma = 0.125;
    RunFixture f(open_room(lift()), anchored(1, kSigma));
    const Row newest = {0.5, -0.25, 1};
    const std::vector<Row> rows = sample_rows(f, 20000, newest);
    for (std::size_t joint = 0; joint < 3; ++joint) {
      INFO("joint ", joint);
      const double sigma = joint == 0 ? 0.5 * kSigma : kSigma;
      const auto [mean, deviation] = spread_of(rows, newest, joint);
      CHECK(std::abs(mean) < 5 * sigma / std::sqrt(20000.0));
      CHECK(std::abs(deviation / sigma - 1) < 0.03);
      for (const Row& row : rows) REQUIRE(std::abs(row[joint] - newest[joint]) < 4.9 * sigma);
    }
  }

  TEST_CASE("the joints of an anchored sample are independent of each other") {
    RunFixture f(open_room(lift()), anchored(1, 0.125));
    const Row newest = {0, 0, 0};
    const std::vector<Row> rows = sample_rows(f, 20000, newest);
    for (const auto& [a, b] : {std::pair(0u, 1u), std::pair(1u, 2u), std::pair(0u, 2u)}) {
      double product = 0;
      for (const Row& row : rows) product += static_cast<double>(row[a]) * row[b];
      const double scale = spread_of(rows, newest, a).second * spread_of(rows, newest, b).second;
      CHECK(std::abs(product / 20000 / scale) < 5 / std::sqrt(20000.0));
    }
  }

  TEST_CASE("a deviation that is left out is 4 rad over the square root of the joints' number") {
    PlanSettings settings = anchored(1);
    Robot::Parts parts;
    parts.name = "wide";
    parts.links.push_back({.name = "base"});
    for (int i = 0; i < 4; ++i) {
      add_link(parts, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitZ(), 100, {});
    }
    RunFixture f(open_room(make_small_robot(std::move(parts))), settings);
    const Row newest(4, 0.0f);
    const std::vector<Row> rows = sample_rows(f, 20000, newest);
    for (std::size_t joint = 0; joint < 4; ++joint) {
      CHECK(std::abs(spread_of(rows, newest, joint).second / 2 - 1) < 0.03);
    }
  }

  TEST_CASE("samples stay within the limits, around any node and with any deviation") {
    const Robot robot = lift();
    for (const double sigma : {0.0, 0.1, 3.0, 100.0}) {
      RunFixture f(open_room(robot), anchored(1, sigma));
      for (const Row& newest : {Row{2, -2, 3.1f}, Row{-2, 2, -3.1f}}) {
        for (const Row& row : sample_rows(f, 500, newest)) {
          REQUIRE(!robot.describe_violation(Configuration(row.begin(), row.end()), "draw"));
          REQUIRE(std::abs(row[0]) <= 2);
          REQUIRE(std::abs(row[1]) <= 2);
          REQUIRE(std::abs(row[2]) <= kPi + 1e-6);
        }
      }
    }
  }

  TEST_CASE("samples around a continuous joint's jump lie on both sides of it") {
    RunFixture f(open_room(lift()), anchored(1, 0.1));
    const std::vector<Row> rows = sample_rows(f, 400, {0, 0, 3.14f});
    const auto beyond = std::ranges::count_if(rows, [](const Row& row) { return row[2] < 0; });
    CHECK(beyond > 150);
    CHECK(beyond < 250);
  }

  TEST_CASE("as many uniform samples are replaced as the settings say") {
    for (const double probability : {0.25, 0.8}) {
      RunFixture f(open_room(lift()), anchored(probability, 1e-6));
      const std::vector<Row> rows = sample_rows(f, 4000, {0.5, 0.5, 0.5});
      const auto near = std::ranges::count_if(
          rows, [](const Row& row) { return std::abs(row[0] - 0.5f) < 1e-4f; });
      CHECK(std::abs(static_cast<double>(near) / 4000 / probability - 1) < 0.1);
    }
  }
}

}  // namespace mneme::test

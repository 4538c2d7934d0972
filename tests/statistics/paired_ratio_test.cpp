// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"

#include <algorithm>
#include <cmath>

namespace mneme {
namespace {

/// Twenty runs, each `factor` times as long as those of factor 1.
std::vector<BenchmarkRow> runs(double factor, int problems = 1) {
  std::vector<BenchmarkRow> rows;
  for (int problem = 0; problem < problems; ++problem) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      BenchmarkRow row = test::run(factor * (1 + 0.1 * double(seed) + problem));
      row.problem = std::to_string(problem);
      row.seed = seed;
      row.timeout_s = 1000;
      rows.push_back(row);
    }
  }
  return rows;
}

void fail_run(BenchmarkRow& row) {
  row.is_solved = row.is_path_valid = false;
  row.status = PlanStatus::timeout;
  row.planning_time_s = row.timeout_s;
}

TEST_SUITE("unit") {
  TEST_CASE("A constant factor is found exactly, and its mean has no spread") {
    const PairedRatio ratio = compare_runs(runs(6), runs(2));
    CHECK(ratio.pairs == 20);
    CHECK(ratio.p50.value == doctest::Approx(3));
    CHECK(ratio.p95.value == doctest::Approx(3));
    CHECK(ratio.p99.value == doctest::Approx(3));
    CHECK(ratio.mean.value == doctest::Approx(3));
    CHECK(ratio.geometric.value == doctest::Approx(3));
    CHECK(ratio.geometric.low == doctest::Approx(3));
    CHECK(ratio.geometric.high == doctest::Approx(3));
    CHECK_FALSE(ratio.p50.is_at_least);
    CHECK_FALSE(ratio.mean.is_at_most);
    CHECK_FALSE(ratio.geometric.is_at_least);
  }

  TEST_CASE("Pairs are of one problem and seed, whatever the order") {
    auto reference = runs(6), other = runs(2);
    std::ranges::reverse(other);
    other.resize(5);
    other[0].seed = 99;
    const PairedRatio ratio = compare_runs(reference, other);
    CHECK(ratio.pairs == 4);
    CHECK(ratio.geometric.value == doctest::Approx(3));
    CHECK(compare_runs({}, other).pairs == 0);
  }

  TEST_CASE("Failures stand at their limit and make the ratio a bound") {
    auto reference = runs(1);
    for (std::size_t i = 0; i < 12; ++i) fail_run(reference[i]);
    const PairedRatio ratio = compare_runs(reference, runs(1));
    CHECK(ratio.p50.is_at_least);
    CHECK_FALSE(ratio.p50.is_at_most);
    CHECK(ratio.p50.value == doctest::Approx(1000 / 2.0));
    const PairedRatio inverse = compare_runs(runs(1), reference);
    CHECK(inverse.p50.is_at_most);
    CHECK(inverse.geometric.value == doctest::Approx(1 / ratio.geometric.value));
  }

  TEST_CASE("The mean weighs long runs, and one failure makes both means and p99 bounds") {
    auto reference = runs(1), other = runs(1);
    reference[3].planning_time_s += 100;
    const double sum = 20 * (1 + 0.1 * 10.5);
    CHECK(compare_runs(reference, other).mean.value == doctest::Approx((sum + 100) / sum));
    fail_run(reference[3]);
    const PairedRatio ratio = compare_runs(reference, other);
    CHECK(ratio.mean.is_at_least);
    CHECK(ratio.geometric.is_at_least);
    CHECK_FALSE(ratio.geometric.is_at_most);
    CHECK(compare_runs(other, reference).geometric.is_at_most);
    CHECK(ratio.p99.is_at_least);
    CHECK_FALSE(ratio.p50.is_at_least);
    CHECK(ratio.p99.value == doctest::Approx(1000 / 3.0));
  }

  TEST_CASE("A path that did not survive its check is a failure; invalid problems are no pairs") {
    auto reference = runs(1), other = runs(1);
    other[0].is_path_valid = false;
    reference[1].status = PlanStatus::invalid_start;
    const PairedRatio ratio = compare_runs(reference, other);
    CHECK(ratio.pairs == 19);
    CHECK(ratio.geometric.value == doctest::Approx(std::pow(1.1 / 1000, 1.0 / 19)));
  }
}

TEST_SUITE("law") {
  TEST_CASE("Intervals hold their estimate, and the same rows give the same numbers") {
    Rng rng(11);
    for (const int problems : {1, 12}) {
      auto reference = runs(5, problems), other = runs(1, problems);
      for (BenchmarkRow& row : other) row.planning_time_s *= std::exp(rng.uniform() - 0.5);
      const PairedRatio ratio = compare_runs(reference, other);
      for (const TimeRatio* each : {&ratio.p50, &ratio.p95, &ratio.p99}) {
        CHECK(each->low <= each->value);
        CHECK(each->value <= each->high);
      }
      for (const TimeRatio* each : {&ratio.mean, &ratio.geometric}) {
        CHECK(each->low < each->value);
        CHECK(each->value < each->high);
      }
      const PairedRatio again = compare_runs(reference, other);
      CHECK(again.p50.low == ratio.p50.low);
      CHECK(again.mean.high == ratio.mean.high);
    }
  }

  TEST_CASE("Intervals of the geometric mean cover the true ratio about as often as they say") {
    Rng rng(5);
    int covered = 0;
    constexpr int kTrials = 100;
    for (int i = 0; i < kTrials; ++i) {
      auto reference = runs(1), other = runs(1);
      for (std::size_t j = 0; j < other.size(); ++j) {
        const double noise = rng.uniform() + rng.uniform() + rng.uniform() - 1.5;
        reference[j].planning_time_s = 2 * other[j].planning_time_s * std::exp(noise);
      }
      const PairedRatio ratio = compare_runs(reference, other);
      covered += ratio.geometric.low <= 2 && 2 <= ratio.geometric.high ? 1 : 0;
    }
    CHECK(covered >= 84);
    CHECK(covered <= 100);
  }
}

}  // namespace
}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "benchmark/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace mneme {
namespace {

constexpr int kResamples = 2000;
constexpr std::uint64_t kSeed = 20190524;
/// With fewer problems, whole problems are too coarse a unit to draw.
constexpr std::size_t kEnoughProblems = 10;

/// A planning time; failures sort after all successes and stand at their limit.
struct Time {
  bool is_failure = false;
  double seconds = 0;
  auto operator<=>(const Time&) const = default;
};

struct Pair {
  Time reference;
  Time other;
};
/// The pairs of one problem.
using Group = std::vector<Pair>;

Time time_of(const BenchmarkRow& row) {
  constexpr double kShortest = 1e-9;  // a ratio needs a positive number
  const bool is_failure = !is_success(row);
  return {is_failure, std::max(is_failure ? row.timeout_s : row.planning_time_s, kShortest)};
}

std::vector<Group> make_groups(std::span<const BenchmarkRow> reference,
                               std::span<const BenchmarkRow> other) {
  using Problem = std::pair<std::string, std::string>;
  std::map<std::pair<Problem, std::uint64_t>, Time> times;
  for (const BenchmarkRow& row : reference) {
    if (!is_invalid_problem(row)) times[{{row.set, row.problem}, row.seed}] = time_of(row);
  }
  std::map<Problem, Group> groups;
  for (const BenchmarkRow& row : other) {
    const auto found = times.find({{row.set, row.problem}, row.seed});
    if (found == times.end() || is_invalid_problem(row)) continue;
    groups[{row.set, row.problem}].push_back({found->second, time_of(row)});
  }
  std::vector<Group> result;
  for (auto& [problem, group] : groups) result.push_back(std::move(group));
  return result;
}

/// The ratios of a sample of pairs.
struct Estimate {
  double p50 = 0, p95 = 0, p99 = 0, mean = 0, geometric = 0;
};

struct Statistic {
  TimeRatio PairedRatio::*ratio;
  double Estimate::*value;
};
constexpr std::array<Statistic, 5> kStatistics = {
    {{&PairedRatio::p50, &Estimate::p50},
     {&PairedRatio::p95, &Estimate::p95},
     {&PairedRatio::p99, &Estimate::p99},
     {&PairedRatio::mean, &Estimate::mean},
     {&PairedRatio::geometric, &Estimate::geometric}}};

Time percentile(int percent, std::vector<Time>& times) {
  const int rank = internal::nearest_rank(percent, static_cast<int>(times.size()));
  std::ranges::nth_element(times, times.begin() + rank - 1);
  return times[static_cast<std::size_t>(rank - 1)];
}

/// Estimates of samples of pairs, in buffers that are kept.
class Estimator {
 public:
  void clear() {
    reference_.clear();
    other_.clear();
    reference_sum_ = other_sum_ = log_sum_ = 0;
  }
  void add(const Pair& pair) {
    reference_.push_back(pair.reference);
    other_.push_back(pair.other);
    reference_sum_ += pair.reference.seconds;
    other_sum_ += pair.other.seconds;
    log_sum_ += std::log(pair.reference.seconds / pair.other.seconds);
  }
  Estimate estimate() {
    const auto ratio = [this](int percent) {
      return percentile(percent, reference_).seconds / percentile(percent, other_).seconds;
    };
    return {ratio(50), ratio(95), ratio(99), reference_sum_ / other_sum_,
            std::exp(log_sum_ / static_cast<double>(other_.size()))};
  }
  /// What of the last estimate's is a failure, or holds one.
  void mark_bounds(PairedRatio& ratio) {
    const auto mark = [this](int percent, TimeRatio& marked) {
      marked.is_at_least = percentile(percent, reference_).is_failure;
      marked.is_at_most = percentile(percent, other_).is_failure;
    };
    mark(50, ratio.p50);
    mark(95, ratio.p95);
    mark(99, ratio.p99);
    mark(100, ratio.mean);
  }

 private:
  std::vector<Time> reference_;
  std::vector<Time> other_;
  double reference_sum_ = 0, other_sum_ = 0, log_sum_ = 0;
};

std::size_t draw_index(std::size_t count, Rng& rng) {
  const auto index = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
  return std::min(index, count - 1);
}

void resample(const std::vector<Group>& groups, Rng& rng, Estimator& estimator) {
  estimator.clear();
  const bool draws_problems = groups.size() >= kEnoughProblems;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Group& group = groups[draws_problems ? draw_index(groups.size(), rng) : i];
    for (std::size_t j = 0; j < group.size(); ++j) {
      estimator.add(group[draws_problems ? j : draw_index(group.size(), rng)]);
    }
  }
}

const Estimate& at_quantile(const std::vector<Estimate>& sorted, double quantile) {
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(quantile * last))];
}

}  // namespace

PairedRatio compare_runs(std::span<const BenchmarkRow> reference,
                         std::span<const BenchmarkRow> other) {
  const std::vector<Group> groups = make_groups(reference, other);
  PairedRatio ratio;
  Estimator estimator;
  for (const Group& group : groups) {
    ratio.pairs += static_cast<int>(group.size());
    for (const Pair& pair : group) estimator.add(pair);
  }
  if (ratio.pairs == 0) return ratio;
  const Estimate all = estimator.estimate();
  estimator.mark_bounds(ratio);
  Rng rng(kSeed);
  std::vector<Estimate> resampled;
  for (int i = 0; i < kResamples; ++i) {
    resample(groups, rng, estimator);
    resampled.push_back(estimator.estimate());
  }
  for (const auto& [member, value] : kStatistics) {
    TimeRatio& estimate = ratio.*member;
    estimate.value = all.*value;
    std::ranges::sort(resampled, {}, value);
    estimate.low = at_quantile(resampled, 0.025).*value;
    estimate.high = at_quantile(resampled, 0.975).*value;
  }
  return ratio;
}

}  // namespace mneme

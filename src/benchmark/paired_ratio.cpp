// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "report/summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
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

struct Estimate {
  double p50 = 0;
  double mean = 0;
};

Time median(std::vector<Time>& times) {
  const int rank = internal::nearest_rank(50, static_cast<int>(times.size()));
  std::ranges::nth_element(times, times.begin() + rank - 1);
  return times[static_cast<std::size_t>(rank - 1)];
}

/// Estimates of samples of pairs, in buffers that are kept.
class Estimator {
 public:
  void clear() {
    reference_.clear();
    other_.clear();
    log_sum_ = 0;
  }
  void add(const Pair& pair) {
    reference_.push_back(pair.reference);
    other_.push_back(pair.other);
    log_sum_ += std::log(pair.reference.seconds / pair.other.seconds);
  }
  Estimate estimate(PairedRatio* ratio = nullptr) {
    const Time reference = median(reference_);
    const Time other = median(other_);
    if (ratio != nullptr) {
      ratio->is_at_least = reference.is_failure;
      ratio->is_at_most = other.is_failure;
    }
    return {reference.seconds / other.seconds,
            std::exp(log_sum_ / static_cast<double>(other_.size()))};
  }

 private:
  std::vector<Time> reference_;
  std::vector<Time> other_;
  double log_sum_ = 0;
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

/// The 2.5th and the 97.5th percentile.
std::pair<double, double> interval(std::vector<double>& values) {
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return {values[static_cast<std::size_t>(std::lround(0.025 * last))],
          values[static_cast<std::size_t>(std::lround(0.975 * last))]};
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
  const Estimate all = estimator.estimate(&ratio);
  ratio.p50 = all.p50;
  ratio.mean = all.mean;
  Rng rng(kSeed);
  std::vector<double> p50s, means;
  for (int i = 0; i < kResamples; ++i) {
    resample(groups, rng, estimator);
    const Estimate estimate = estimator.estimate();
    p50s.push_back(estimate.p50);
    means.push_back(estimate.mean);
  }
  std::tie(ratio.p50_low, ratio.p50_high) = interval(p50s);
  std::tie(ratio.mean_low, ratio.mean_high) = interval(means);
  return ratio;
}

}  // namespace mneme

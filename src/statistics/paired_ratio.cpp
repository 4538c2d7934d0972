// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "statistics/tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace mneme {
namespace {

constexpr std::size_t kResamples = 2000;
constexpr std::size_t kLowRank = kResamples / 40;  // rank of the 2.5 % quantile
constexpr std::uint64_t kSeed = 20190524;
/// With fewer problems, whole problems are too coarse a unit of resampling.
constexpr std::size_t kEnoughProblems = 10;

/// A planning time. Failures sort after all successes and have the time limit.
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

constexpr std::array kRatios = {&PairedRatio::p50, &PairedRatio::p95, &PairedRatio::p99,
                                &PairedRatio::mean, &PairedRatio::geometric};
/// The values of kRatios for a sample of pairs.
using Estimate = std::array<double, kRatios.size()>;

/// Percentiles of the first three ratios. The maximum decides whether the means are bounds.
constexpr std::array kPercents = {50, 95, 99, 100};
using Percentiles = std::array<Time, kPercents.size()>;

/// Estimates from samples of pairs. Pairs are sorted once; a sample counts how often each occurs.
class Estimator {
 public:
  explicit Estimator(const std::vector<Group>& groups) {
    begins_.push_back(0);
    for (const Group& group : groups) {
      pairs_.insert(pairs_.end(), group.begin(), group.end());
      begins_.push_back(pairs_.size());
    }
    for (const Pair& pair : pairs_) {
      logs_.push_back(std::log(pair.reference.seconds / pair.other.seconds));
    }
    by_reference_ = sorted_by(&Pair::reference);
    by_other_ = sorted_by(&Pair::other);
  }

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }

  void sample_all() {
    clear();
    for (std::size_t i = 0; i < pairs_.size(); ++i) add(i);
  }
  /// Samples whole groups, or pairs of each group if there are few groups.
  void sample(Rng& rng) {
    clear();
    const std::size_t groups = begins_.size() - 1;
    const bool by_groups = groups >= kEnoughProblems;
    for (std::size_t i = 0; i < groups; ++i) {
      const std::size_t group = by_groups ? random_index(groups, rng) : i;
      const std::size_t count = begins_[group + 1] - begins_[group];
      for (std::size_t j = 0; j < count; ++j) {
        add(begins_[group] + (by_groups ? j : random_index(count, rng)));
      }
    }
  }

  [[nodiscard]] Estimate estimate() const {
    const Percentiles reference = percentiles(by_reference_, &Pair::reference);
    const Percentiles other = percentiles(by_other_, &Pair::other);
    const auto ratio = [&](std::size_t i) { return reference[i].seconds / other[i].seconds; };
    return {ratio(0), ratio(1), ratio(2), reference_sum_ / other_sum_,
            std::exp(log_sum_ / static_cast<double>(count_))};
  }
  /// Marks the ratios of the current sample that are bounds, because their percentile or any run is
  /// a failure.
  void mark_bounds(PairedRatio& ratio) const {
    const Percentiles reference = percentiles(by_reference_, &Pair::reference);
    const Percentiles other = percentiles(by_other_, &Pair::other);
    for (std::size_t i = 0; i < kRatios.size(); ++i) {
      const std::size_t percentile = std::min(i, kPercents.size() - 1);
      (ratio.*kRatios[i]).is_at_least = reference[percentile].is_failure;
      (ratio.*kRatios[i]).is_at_most = other[percentile].is_failure;
    }
  }

 private:
  [[nodiscard]] std::vector<std::size_t> sorted_by(Time Pair::*time) const {
    std::vector<std::size_t> order(pairs_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return pairs_[i].*time; });
    return order;
  }

  static std::size_t random_index(std::size_t count, Rng& rng) {
    const auto index = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    return std::min(index, count - 1);
  }

  void clear() {
    counts_.assign(pairs_.size(), 0);
    count_ = 0;
    reference_sum_ = other_sum_ = log_sum_ = 0;
  }
  void add(std::size_t i) {
    ++counts_[i];
    ++count_;
    reference_sum_ += pairs_[i].reference.seconds;
    other_sum_ += pairs_[i].other.seconds;
    log_sum_ += logs_[i];
  }

  /// Percentiles kPercents of the current sample.
  [[nodiscard]] Percentiles percentiles(const std::vector<std::size_t>& order,
                                        Time Pair::*time) const {
    std::array<int, kPercents.size()> ranks{};
    std::ranges::transform(kPercents, ranks.begin(),
                           [&](int percent) { return internal::nearest_rank(percent, count_); });
    Percentiles found;
    std::size_t next = 0;
    int passed = 0;
    for (const std::size_t i : order) {
      passed += counts_[i];
      while (next < ranks.size() && passed >= ranks[next]) {
        found[next++] = pairs_[i].*time;
      }
    }
    return found;
  }

  std::vector<Pair> pairs_;
  std::vector<std::size_t> begins_;  // first pair of each group, and the end of the last
  std::vector<double> logs_;
  std::vector<std::size_t> by_reference_;
  std::vector<std::size_t> by_other_;
  std::vector<int> counts_;
  int count_ = 0;
  double reference_sum_ = 0, other_sum_ = 0, log_sum_ = 0;
};

}  // namespace

PairedRatio compare_runs(std::span<const BenchmarkRow> reference,
                         std::span<const BenchmarkRow> other) {
  Estimator estimator(make_groups(reference, other));
  PairedRatio ratio;
  ratio.pairs = static_cast<int>(estimator.size());
  if (ratio.pairs == 0) return ratio;
  estimator.sample_all();
  const Estimate all = estimator.estimate();
  estimator.mark_bounds(ratio);
  Rng rng(kSeed);
  std::vector<Estimate> resampled;
  for (std::size_t i = 0; i < kResamples; ++i) {
    estimator.sample(rng);
    resampled.push_back(estimator.estimate());
  }
  for (std::size_t i = 0; i < kRatios.size(); ++i) {
    std::ranges::sort(resampled, {}, [i](const Estimate& one) { return one[i]; });
    TimeRatio& estimate = ratio.*kRatios[i];
    estimate.value = all[i];
    estimate.low = resampled[kLowRank][i];
    estimate.high = resampled[kResamples - 1 - kLowRank][i];
  }
  return ratio;
}

}  // namespace mneme

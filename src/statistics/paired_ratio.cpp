// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "statistics/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
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
/// Of one problem.
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

constexpr std::array kPercents = {50, 95, 99, 100};
using Percentiles = std::array<Time, kPercents.size()>;

/// Estimates of samples of pairs. The pairs are sorted once, and each sample counts how often it
/// has drawn them.
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

  void draw_all() {
    clear();
    for (std::size_t i = 0; i < pairs_.size(); ++i) add(i);
  }
  /// Whole groups, or pairs of each if there are few.
  void draw(Rng& rng) {
    clear();
    const std::size_t groups = begins_.size() - 1;
    const bool draws_groups = groups >= kEnoughProblems;
    for (std::size_t i = 0; i < groups; ++i) {
      const std::size_t group = draws_groups ? draw_index(groups, rng) : i;
      const std::size_t count = begins_[group + 1] - begins_[group];
      for (std::size_t j = 0; j < count; ++j) {
        add(begins_[group] + (draws_groups ? j : draw_index(count, rng)));
      }
    }
  }

  [[nodiscard]] Estimate estimate() const {
    const Percentiles reference = percentiles(by_reference_, &Pair::reference);
    const Percentiles other = percentiles(by_other_, &Pair::other);
    const auto ratio = [&](std::size_t i) { return reference[i].seconds / other[i].seconds; };
    return {ratio(0), ratio(1), ratio(2), reference_sum_ / other_sum_,
            std::exp(log_sum_ / static_cast<double>(drawn_))};
  }
  /// What of the last draw's is a failure, or holds one.
  void mark_bounds(PairedRatio& ratio) const {
    const Percentiles reference = percentiles(by_reference_, &Pair::reference);
    const Percentiles other = percentiles(by_other_, &Pair::other);
    const std::array marked = {&ratio.p50, &ratio.p95, &ratio.p99, &ratio.mean};
    for (std::size_t i = 0; i < marked.size(); ++i) {
      marked[i]->is_at_least = reference[i].is_failure;
      marked[i]->is_at_most = other[i].is_failure;
    }
  }

 private:
  [[nodiscard]] std::vector<std::size_t> sorted_by(Time Pair::*time) const {
    std::vector<std::size_t> order(pairs_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return pairs_[i].*time; });
    return order;
  }

  static std::size_t draw_index(std::size_t count, Rng& rng) {
    const auto index = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    return std::min(index, count - 1);
  }

  void clear() {
    counts_.assign(pairs_.size(), 0);
    drawn_ = 0;
    reference_sum_ = other_sum_ = log_sum_ = 0;
  }
  void add(std::size_t i) {
    ++counts_[i];
    ++drawn_;
    reference_sum_ += pairs_[i].reference.seconds;
    other_sum_ += pairs_[i].other.seconds;
    log_sum_ += logs_[i];
  }

  /// Of what was drawn, at kPercents.
  [[nodiscard]] Percentiles percentiles(const std::vector<std::size_t>& order,
                                        Time Pair::*time) const {
    std::array<int, kPercents.size()> ranks{};
    std::ranges::transform(kPercents, ranks.begin(),
                           [&](int percent) { return internal::nearest_rank(percent, drawn_); });
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
  std::vector<std::size_t> begins_;  // of the groups, and the end of the last
  std::vector<double> logs_;
  std::vector<std::size_t> by_reference_;
  std::vector<std::size_t> by_other_;
  std::vector<int> counts_;
  int drawn_ = 0;
  double reference_sum_ = 0, other_sum_ = 0, log_sum_ = 0;
};

const Estimate& at_quantile(const std::vector<Estimate>& sorted, double quantile) {
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(quantile * last))];
}

}  // namespace

PairedRatio compare_runs(std::span<const BenchmarkRow> reference,
                         std::span<const BenchmarkRow> other) {
  Estimator estimator(make_groups(reference, other));
  PairedRatio ratio;
  ratio.pairs = static_cast<int>(estimator.size());
  if (ratio.pairs == 0) return ratio;
  estimator.draw_all();
  const Estimate all = estimator.estimate();
  estimator.mark_bounds(ratio);
  Rng rng(kSeed);
  std::vector<Estimate> resampled;
  for (int i = 0; i < kResamples; ++i) {
    estimator.draw(rng);
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

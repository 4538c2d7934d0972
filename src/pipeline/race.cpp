// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/race.h"

#include "base/threads.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

/// Seeds of the other searches, far from all others derived from the query's.
constexpr std::uint64_t kFirstTask = std::uint64_t{1} << 62;
constexpr int kIndexBits = 8;

/// Counts samples.
class CountingSampler final : public Sampler {
 public:
  CountingSampler(const Sampler& sampler, std::uint64_t& samples)
      : sampler_(sampler), samples_(samples) {}

  [[nodiscard]] std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<Stream>(sampler_.start(seed), samples_);
  }

 private:
  class Stream final : public SampleStream {
   public:
    Stream(std::unique_ptr<SampleStream> stream, std::uint64_t& samples)
        : stream_(std::move(stream)), samples_(samples) {}
    SampleSource next(std::span<float> q) override {
      ++samples_;
      return stream_->next(q);
    }
    void report(SampleSource source, SampleOutcome outcome) override {
      stream_->report(source, outcome);
    }

   private:
    std::unique_ptr<SampleStream> stream_;
    std::uint64_t& samples_;
  };

  const Sampler& sampler_;
  std::uint64_t& samples_;
};

Result<PlanResult> search(const RaceTask& task, const Sampler& sampler,
                          const PlanSettings& settings, SearchLimit* limit, FoundMotions& found) {
  const ResolvedQuery& resolved = task.resolved;
  MotionMemory motions(resolved);
  const Query& query = resolved.query;
  std::optional<PoseGoalSource> further_goals = resolved.further_goals;
  PathFinisher shorten_and_verify(resolved.checker, settings.finish());
  const std::string_view valid_states =
      query.sampler.samples_valid_states ? query.sampler.name : "";
  auto planned =
      query.planner.plan({resolved.checker, resolved.ends, sampler, settings, shorten_and_verify,
                          valid_states, further_goals ? &*further_goals : nullptr, limit,
                          MotionMemory::is_used(query) ? &motions : nullptr});
  found = motions.take_found();
  return planned;
}

class Race {
 public:
  explicit Race(const RaceTask& task) : task_(task) {
    for (int i = 0; i < task.resolved.query.settings.threads; ++i) entrants_.emplace_back(*this, i);
  }

  Result<RaceResult> run() {
    run_those_left();
    threads_.join();
    Entrant& first = winner();
    if (!*first.planned) return tl::unexpected(first.planned->error());
    RaceResult result{**std::move(first.planned), first.samples, std::move(first.found)};
    if (plan_settings().observer != nullptr && !first.is_beaten) show(first);
    return result;
  }

 private:
  /// One search. Its thread alone writes to it.
  class Entrant final : public SearchLimit {
   public:
    Entrant(Race& race, int number) : index(number), race_(race) {}
    bool may_go_on(std::uint64_t iterations) override {
      if (index == 0 && !race_.may_first_go_on(iterations)) {
        is_beaten = true;
        return false;
      }
      // A path found from now on needs at least one more iteration.
      is_beaten = is_beaten || rank(iterations + 1) > race_.best_.load(std::memory_order_relaxed);
      return !is_beaten;
    }
    /// By iterations since the race began, then by index.
    [[nodiscard]] std::uint64_t rank(std::uint64_t iterations) const {
      const std::uint64_t since = index == 0 ? iterations : iterations + kAlone;
      return (since << kIndexBits) | static_cast<std::uint64_t>(index);
    }
    [[nodiscard]] bool has_path() const {
      return !is_beaten && planned && *planned && (*planned)->is_solved();
    }

    int index;
    bool is_beaten = false;  ///< True: paths found later do not count.
    std::uint64_t samples = 0;
    std::optional<Result<PlanResult>> planned;
    FoundMotions found;

   private:
    Race& race_;
  };

  [[nodiscard]] const PlanSettings& plan_settings() const {
    return task_.resolved.query.settings.plan;
  }
  [[nodiscard]] PlanSettings settings_of(int index) const {
    PlanSettings settings = plan_settings();
    const auto count = static_cast<std::uint64_t>(entrants_.size());
    settings.max_nodes = std::max(settings.max_nodes / count, std::uint64_t{1});
    settings.timeout_s = task_.resolved.query.remaining_s();
    settings.observer = nullptr;
    if (index > 0) {
      // The first search keeps walks for hard problems; the others start with them.
      if (!settings.walk_after) settings.walk_after = 0;
      settings.seed = derive_seed(settings.seed, kFirstTask + static_cast<std::uint64_t>(index));
    }
    return settings;
  }

  void run(Entrant& entrant) {
    const CountingSampler sampler(task_.sampler, entrant.samples);
    entrant.planned = search(task_, sampler, settings_of(entrant.index), &entrant, entrant.found);
    if (!entrant.has_path()) return;
    const std::uint64_t rank = entrant.rank((*entrant.planned)->iterations);
    std::uint64_t best = best_.load();
    while (rank < best && !best_.compare_exchange_weak(best, rank)) {
    }
  }

  /// Runs the searches that no thread has begun. If threads cannot be started, one thread runs all
  /// of them, with the same winner.
  void run_those_left() {
    for (std::size_t i = next_++; i < entrants_.size(); i = next_++) {
      run(entrants_[i]);
      // The others begin once the first has taken a while, or never.
      if (i == 0 && !has_started_) return;
    }
  }

  /// Called only by the thread of the first search. Starts the others.
  bool may_first_go_on(std::uint64_t iterations) {
    if (task_.limit != nullptr && !task_.limit->may_go_on(iterations)) return false;
    if (iterations >= kAlone && !std::exchange(has_started_, true)) {
      threads_ = Threads(entrants_.size() - 1, [this] { run_those_left(); });
    }
    return true;
  }

  [[nodiscard]] Entrant& winner() {
    Entrant* first = &entrants_.front();
    for (Entrant& entrant : entrants_) {
      if (!entrant.has_path()) continue;
      const bool is_first = !first->has_path() || rank_of(entrant) < rank_of(*first);
      if (is_first) first = &entrant;
    }
    return *first;
  }
  [[nodiscard]] static std::uint64_t rank_of(const Entrant& entrant) {
    return entrant.rank((*entrant.planned)->iterations);
  }

  void show(const Entrant& entrant) const {
    PlanSettings settings = settings_of(entrant.index);
    settings.timeout_s = timeout_s_;
    settings.observer = plan_settings().observer;
    FoundMotions ignored;
    static_cast<void>(search(task_, task_.sampler, settings, nullptr, ignored));
  }

  const RaceTask& task_;
  double timeout_s_ = task_.resolved.query.remaining_s();
  std::deque<Entrant> entrants_;
  std::atomic<std::uint64_t> best_ = ~std::uint64_t{0};  ///< least rank of searches with a path
  std::atomic<std::size_t> next_ = 0;
  bool has_started_ = false;
  Threads threads_;  ///< last member: joined first
};

}  // namespace

Result<RaceResult> race(const RaceTask& task) {
  if (task.resolved.query.settings.threads > 1) return Race(task).run();
  PlanSettings settings = task.resolved.query.settings.plan;
  settings.timeout_s = task.resolved.query.remaining_s();
  RaceResult result;
  result.plan = MNEME_TRY(search(task, task.sampler, settings, task.limit, result.found));
  return result;
}

}  // namespace mneme::internal

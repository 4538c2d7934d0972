// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell.h"
#include "mneme/path.h"
#include "mneme/sampling.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "cell/blocked_link.h"
#include "cell/cell_data.h"
#include "cell/examine.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

namespace mneme {

using internal::as_index;
using internal::CellBox;
using internal::StartCell;

namespace {

/// Proves boxes again: against changed obstacles only where the rest is proven.
class Reprover {
 public:
  explicit Reprover(const internal::CellData& data) : data_(data) {
    if (!data.changed) return;
    auto checker = CollisionChecker::make(data.region.problem.robot, *data.changed);
    if (checker) changes_ = std::move(*checker);
  }

  /// Returns where the proof of each box failed.
  std::vector<std::optional<internal::ProofFailure>> run(StartCell& start, int threads,
                                                         CellVerification& result) const {
    std::vector<std::optional<internal::ProofFailure>> failures(start.boxes.size());
    std::atomic<int> proven = 0, kept = 0;
    internal::run_parallel(start.boxes.size(), as_index(std::max(1, threads)), [&](std::size_t i) {
      CellBox& box = start.boxes[i];
      const bool is_known = changes_.has_value() && box.was_proven;
      kept += is_known ? 1 : 0;
      box.is_proven = box.was_proven = prove(box, is_known, failures[i]);
      proven += box.is_proven ? 1 : 0;
    });
    result.proven += proven;
    result.kept += kept;
    result.checked += static_cast<int>(start.boxes.size());
    return failures;
  }

 private:
  [[nodiscard]] bool prove(const CellBox& box, bool is_known,
                           std::optional<internal::ProofFailure>& where) const {
    if (is_known && data_.changed->obstacles.empty()) return true;
    internal::ProofSettings settings;
    settings.margin = static_cast<float>(data_.margin);
    settings.most_states = ~std::uint64_t{0} >> 1;
    settings.has_trials = false;
    settings.has_links = !is_known;
    internal::ProofFailure failure;
    CheckCounters counters;
    if (!is_known && !data_.make_tools()) return false;
    const CollisionChecker& checker = is_known ? *changes_ : data_.tools().checker;
    if (internal::prove(checker, box.path, box.shift, settings, failure, counters)) return true;
    where = failure;
    return false;
  }

  const internal::CellData& data_;
  std::optional<CollisionChecker> changes_;  ///< with changed obstacles only
};

/// Leaves whose link is no longer blocked are open.
void check_blocked(const internal::CellData& data, internal::SplitTree& tree) {
  const internal::BlockedLink blocked(data.region, data.frame);
  const std::vector<internal::TaskBox> places = tree.place(data.frame.whole());
  for (std::size_t i = 0; i < places.size(); ++i) {
    internal::SplitNode& node = tree.nodes[i];
    if (!node.has_gap || node.gap.reason != CellGap::blocked) continue;
    if (blocked.look_around(places[i], 0).blocked) continue;
    node.gap = {};
    node.gap.is_examined = node.count > 0;
  }
}

/// Finds the leaves that boxes do not serve since their proof failed, and notes why.
class LossNoter {
 public:
  LossNoter(const internal::CellData& data, StartCell& start) : data_(data), start_(start) {}

  /// `failures` has a place for each box that is not proven.
  void run(const std::vector<std::optional<internal::ProofFailure>>& failures,
           const CollisionChecker& wide) {
    std::vector<internal::SplitNode>& nodes = start_.tree.nodes;
    for (internal::SplitNode& node : nodes) {
      if (!node.has_gap || !node.gap.is_lost) continue;
      node.has_gap = false;
      node.gap = {};
    }
    const std::vector<internal::TaskBox> places = start_.tree.place(data_.frame.whole());
    std::vector<int> lost(nodes.size(), -1);  // a box that failed, of the node or one above
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      int proven = 0;
      for (int k = nodes[i].first; k < nodes[i].first + nodes[i].count; ++k) {
        if (failures[as_index(k)]) {
          lost[i] = k;
        } else {
          ++proven;
        }
      }
      for (int side = 0; side < 2 && !nodes[i].is_leaf(); ++side) {
        lost[as_index(nodes[i].below + side)] = lost[i];
      }
      if (!nodes[i].is_leaf() || nodes[i].has_gap || lost[i] < 0 || is_served(places[i])) continue;
      UnprovenBox reason;
      reason.gap = CellGap::contact;
      internal::describe(wide, *failures[as_index(lost[i])], reason);
      start_.tree.set_gap(static_cast<int>(i), reason, proven > 0);
      nodes[i].gap.is_lost = true;
    }
  }

 private:
  /// True if proven boxes serve all samples of the leaf.
  [[nodiscard]] bool is_served(const internal::TaskBox& leaf) const {
    constexpr int kSamples = 32;
    Rng rng(7);
    bool is_served = true;
    for (int i = 0; i < kSamples && is_served; ++i) {
      const CellTask task = leaf.sample(data_.frame.varying(), rng, i % 2 == 1);
      is_served = false;
      start_.visit_boxes(task, [&](int index) {
        const CellBox& box = start_.boxes[as_index(index)];
        is_served = box.is_proven && serves(box, task, data_.frame, data_.chain);
        return is_served;
      });
    }
    return is_served;
  }

  const internal::CellData& data_;
  StartCell& start_;
};

/// Notes why the region is not proven where boxes failed.
Result<void> note_losses(
    internal::CellData& data,
    const std::vector<std::vector<std::optional<internal::ProofFailure>>>& failures) {
  CheckerSettings settings;
  settings.margin = internal::kWidestClearance;
  const Problem& problem = data.region.problem;
  const auto wide = MNEME_TRY(CollisionChecker::make(problem.robot, problem.scene, settings));
  for (std::size_t i = 0; i < data.starts.size(); ++i) {
    LossNoter(data, data.starts[i]).run(failures[i], wide);
  }
  return {};
}

/// Checks answers to tasks of proven boxes by exact distances.
void check_answers(const Cell& cell, const internal::CellData& data, int samples,
                   std::uint64_t seed, CellVerification& result) {
  constexpr double kResolution = 1.0 / 320;
  std::vector<std::pair<std::size_t, const CellBox*>> proven;
  for (std::size_t i = 0; i < data.starts.size(); ++i) {
    for (const CellBox& box : data.starts[i].boxes) {
      if (box.is_proven) proven.emplace_back(i, &box);
    }
  }
  Rng rng(seed);
  CellAnswer answer;
  const Problem& problem = data.region.problem;
  for (int i = 0; i < samples && !proven.empty(); ++i) {
    const auto& [start, box] = proven[rng.index(static_cast<std::uint32_t>(proven.size()))];
    cell.look_up(box->tasks.sample(data.frame.varying(), rng, i % 2 == 1), answer, start);
    if (answer.tier != CellTier::certified) continue;
    ++result.paths;
    if (!is_path_free(problem.robot, problem.scene, answer.path, kResolution)) ++result.in_contact;
  }
}

}  // namespace

CellVerification Cell::verify(int samples, std::uint64_t seed, int threads) {
  const Stopwatch stopwatch;
  CellVerification result;
  auto data = std::make_shared<internal::CellData>(*data_);
  const Reprover reprover(*data);
  std::vector<std::vector<std::optional<internal::ProofFailure>>> failures;
  for (StartCell& start : data->starts) {
    failures.push_back(reprover.run(start, threads, result));
    if (!data->is_of_this_world) check_blocked(*data, start.tree);
  }
  data->is_of_this_world = true;
  data->changed.reset();
  // Without a checker only reasons are missing.
  static_cast<void>(note_losses(*data, failures));
  data_ = data;
  if (result.proven < result.checked && !data->progress.empty()) {
    double share = 0;
    for (std::size_t i = 0; i < data->starts.size(); ++i) share += coverage(i).proven;
    share /= static_cast<double>(data->starts.size());
    data->progress.push_back({data->progress.back().time_s, result.proven, share, share});
  }
  result.time_s = stopwatch.elapsed_s();
  check_answers(*this, *data, samples, seed, result);
  return result;
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/fail.h"
#include "base/threads.h"
#include "cell/cell_data.h"
#include "cell/examine.h"

#include <algorithm>
#include <optional>
#include <queue>
#include <string>
#include <vector>

namespace mneme {
namespace internal {
namespace {

/// Boxes that are examined together. They do not see each other's results, so that these do not
/// depend on threads.
constexpr std::size_t kRound = 16;
/// Boxes of a smaller share of the region are not cut.
constexpr double kLeastShare = 1e-7;
/// A build ends when its file would be about this large: larger ones load slowly and gain little.
constexpr double kMostBytes = 5e6;
/// Boxes without a sample that may be served count as if this share of them could.
constexpr double kLeastLeft = 0.003;
/// Tasks by which progress is measured.
constexpr std::size_t kTracked = 6000;

/// About how many bytes a box takes in a file.
double bytes_of(const CellBox& box) {
  constexpr double kPerWaypointValue = 1.9, kPerCoefficient = 1.6, kRest = 16;
  const auto parameters = static_cast<double>(box.shift.parameters);
  const auto joints = static_cast<double>(box.shift.constant.size());
  const double coefficients = joints * (2 + parameters + parameters * (parameters + 1) / 2);
  return kPerWaypointValue * static_cast<double>(box.path.rows.size()) +
         kPerCoefficient * coefficients + kRest;
}

/// Builds the boxes of one start.
class CellBuilder {
 public:
  /// Continues with `known`.
  CellBuilder(const Examiner& examiner, const CellSettings& settings, double seconds,
              double most_bytes, StartCell known)
      : examiner_(examiner),
        settings_(settings),
        seconds_(seconds),
        most_bytes_(most_bytes),
        cell_(std::move(known)),
        tracked_(kTracked),
        is_tracked_(kTracked, false) {
    Rng rng(4242);
    const TaskFrame& frame = examiner.frame();
    for (CellTask& task : tracked_) task = frame.whole().sample(frame.varying(), rng);
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
    for (const CellBox& box : cell_.boxes) {
      track(box);
      bytes_ += bytes_of(box);
    }
    reopen();
  }

  StartCell run(const std::function<void(const CellProgress&)>& on_progress) {
    while (!queue_.empty() && !is_over()) {
      round();
      if (on_progress) on_progress(progress());
    }
    for (; !queue_.empty(); queue_.pop()) {
      cell_.tree.set_gap(queue_.top().node, queue_.top().around, false);
    }
    cell_.tree.merge();
    return std::move(cell_);
  }

  [[nodiscard]] CellProgress progress() const {
    const double proven = static_cast<double>(tracked_count_) / kTracked;
    return {stopwatch_.elapsed_s(), static_cast<int>(cell_.boxes.size()), proven,
            proven + blocked_};
  }

 private:
  struct IsSmaller {
    bool operator()(const OpenBox& a, const OpenBox& b) const {
      return a.priority != b.priority ? a.priority < b.priority : a.node > b.node;
    }
  };

  [[nodiscard]] bool is_over() const {
    return examined_ >= settings_.boxes || bytes_ >= most_bytes_ ||
           stopwatch_.elapsed_s() >= seconds_ || is_set(settings_.cancel);
  }

  /// Queues what is not proven: leaves, or the halves of those that were examined.
  void reopen() {
    const std::vector<TaskBox> places = cell_.tree.place(examiner_.frame().whole());
    std::vector<std::vector<int>> above(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const SplitNode node = cell_.tree.nodes[i];
      for (int k = 0; k < node.count; ++k) above[i].push_back(node.first + k);
      for (int side = 0; side < 2 && !node.is_leaf(); ++side) {
        above[as_index(node.below + side)] = above[i];
      }
      if (node.has_gap) reopen(node.gap, places[i], static_cast<int>(i), std::move(above[i]));
    }
  }

  void reopen(const LeafGap& gap, const TaskBox& tasks, int node, std::vector<int> above) {
    OpenBox open{tasks, examiner_.frame().share_of(tasks), node, std::move(above)};
    open.around = cell_.tree.reason_of(gap);
    if (gap.reason == CellGap::blocked) {
      blocked_ += open.share;
    } else if (!gap.is_examined) {
      open.priority = open.share;
      queue_.push(std::move(open));
    } else if (open.share / 2 >= kLeastShare) {
      cut(open, {}, open.above, open.around);
    }
  }

  void round() {
    std::vector<OpenBox> open;
    const auto most = std::min<std::uint64_t>(kRound, settings_.boxes - examined_);
    while (open.size() < most && !queue_.empty()) {
      open.push_back(queue_.top());
      queue_.pop();
    }
    std::vector<std::optional<Examined>> results(open.size());
    examine_all(open, results);
    // Results count up to the first that time did not suffice for, as if it had ended there.
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (!results[i]) {
        for (; i < open.size(); ++i) queue_.push(open[i]);
        break;
      }
      ++examined_;
      take(open[i], std::move(*results[i]));
    }
    std::ranges::stable_sort(order_, std::greater(),
                             [&](int profile) { return wins_[as_index(profile)]; });
  }

  void examine_all(const std::vector<OpenBox>& open,
                   std::vector<std::optional<Examined>>& results) {
    run_parallel(open.size(), as_index(settings_.threads), [&](std::size_t i) {
      // The first is always examined, so that a round makes progress.
      if (i > 0 && (stopwatch_.elapsed_s() >= seconds_ || is_set(settings_.cancel))) return;
      results[i] = examiner_.examine(open[i], cell_.boxes, order_);
    });
  }

  void take(const OpenBox& open, Examined&& result) {
    std::vector<int> above = open.above;
    cell_.tree.nodes[as_index(open.node)].has_gap = false;
    for (std::size_t i = 0; i < result.boxes.size(); ++i) {
      CellBox& box = result.boxes[i];
      const int index = static_cast<int>(cell_.boxes.size());
      if (box.origin < 0) box.origin = index;
      ++wins_[as_index(result.profiles[i])];
      SplitNode& node = cell_.tree.nodes[as_index(open.node)];
      if (node.count++ == 0) node.first = index;
      above.push_back(index);
      track(box);
      bytes_ += bytes_of(box);
      cell_.boxes.push_back(std::move(box));
    }
    Tally& tally = tallies_.at(static_cast<std::size_t>(open.around.gap));
    if (!result.blocked_by) {
      tally.tried += 1;
      tally.gained += result.gained;
    }
    if (result.is_served) return;
    if (result.is_blocked) blocked_ += open.share;
    UnprovenBox reason;
    reason.gap = result.gap;
    if (result.failure) examiner_.describe(*result.failure, reason);
    if (result.blocked_by) {
      reason = {{}, {}, CellGap::contact, 0, result.blocked_by->link, result.blocked_by->obstacle,
                1};
    }
    if (result.is_blocked || open.share / 2 < kLeastShare) {
      cell_.tree.set_gap(open.node, reason, true);
    } else {
      cut(open, result, above, reason);
    }
  }

  void track(const CellBox& box) {
    for (std::size_t i = 0; i < tracked_.size(); ++i) {
      if (is_tracked_[i] || !serves(box, tracked_[i], examiner_.frame(), examiner_.chain())) {
        continue;
      }
      is_tracked_[i] = true;
      ++tracked_count_;
    }
  }

  /// Estimates how much of a box is proven when the box around it was not for this reason.
  [[nodiscard]] double chance_of(CellGap reason) const {
    const Tally& tally = tallies_.at(static_cast<std::size_t>(reason));
    return (1 + tally.gained) / (2 + tally.tried);
  }

  /// Cuts a box across the parameter that moves the arm most and was most to blame.
  void cut(const OpenBox& open, const Examined& result, const std::vector<int>& above,
           const UnprovenBox& reason) {
    constexpr double kSizeWeight = 0.7, kMetresPerRadian = 0.25;
    const std::vector<int>& varying = examiner_.frame().varying();
    const auto size = [&](int k) {
      return open.tasks.half[as_index(k)] * (k == kYaw ? kMetresPerRadian : 1);
    };
    double sizes = 0, blames = 1e-9;
    for (std::size_t i = 0; i < varying.size(); ++i) {
      sizes += size(varying[i]);
      blames += result.blame[i];
    }
    int widest = varying.front();
    double most = -1;
    for (std::size_t i = 0; i < varying.size(); ++i) {
      const double weight =
          kSizeWeight * size(varying[i]) / sizes + result.blame[i] / blames + result.contrast[i];
      if (weight <= most) continue;
      most = weight;
      widest = varying[i];
    }
    const int below = cell_.tree.cut(open.node, widest, open.tasks.center[as_index(widest)]);
    for (const int side : {0, 1}) {
      OpenBox part{cell_.tree.nodes[as_index(open.node)].half(open.tasks, side), open.share / 2,
                   below + side, above, reason};
      part.priority = part.share * std::max(result.left, kLeastLeft) * chance_of(reason.gap);
      queue_.push(std::move(part));
    }
  }

  const Examiner& examiner_;
  const CellSettings& settings_;
  double seconds_, most_bytes_;
  Stopwatch stopwatch_;
  StartCell cell_;
  std::priority_queue<OpenBox, std::vector<OpenBox>, IsSmaller> queue_;
  std::array<int, kBendProfiles> order_ = {};
  std::array<int, kBendProfiles> wins_ = {};
  std::vector<CellTask> tracked_;
  std::vector<bool> is_tracked_;
  std::size_t tracked_count_ = 0;
  double blocked_ = 0, bytes_ = 0;
  std::uint64_t examined_ = 0;
  /// Boxes that were examined, and what of them was proven, by the reason of the box around them.
  struct Tally {
    double tried = 0, gained = 0;
  };
  std::array<Tally, kCellGaps> tallies_ = {};
};

/// Adds up the progress of starts: boxes, and mean shares.
CellProgress total_of(const std::vector<CellProgress>& starts, double time_s) {
  CellProgress total;
  total.time_s = time_s;
  const auto count = static_cast<double>(starts.size());
  for (const CellProgress& each : starts) {
    total.boxes += each.boxes;
    total.proven += each.proven / count;
    total.decided += each.decided / count;
  }
  return total;
}

/// Builds on what the starts of a cell have.
Result<void> grow(CellData& data, const CellSettings& settings,
                  const std::function<void(const CellProgress&)>& on_progress) {
  const Stopwatch stopwatch;
  const double before = data.progress.empty() ? 0 : data.progress.back().time_s;
  std::vector<CellProgress> of_starts(data.starts.size());
  for (std::size_t i = 0; i < data.starts.size(); ++i) {
    of_starts[i].boxes = static_cast<int>(data.starts[i].boxes.size());
  }
  const auto total = [&] { return total_of(of_starts, before + stopwatch.elapsed_s()); };
  for (std::size_t i = 0; i < data.starts.size(); ++i) {
    const auto examiner = MNEME_TRY(Examiner::make(data.region, data.region.starts[i], settings));
    const double left = settings.seconds - stopwatch.elapsed_s();
    const auto starts_left = static_cast<double>(data.starts.size() - i);
    CellBuilder builder(examiner, settings, std::max(0.0, left / starts_left),
                        kMostBytes / static_cast<double>(data.starts.size()),
                        std::move(data.starts[i]));
    double kept = -1;
    of_starts[i] = builder.progress();
    data.starts[i] = builder.run([&](const CellProgress& progress) {
      constexpr double kStep = 0.002;
      of_starts[i] = progress;
      if (progress.proven >= kept + kStep) {
        data.progress.push_back(total());
        kept = progress.proven;
      }
      if (on_progress) on_progress(total());
    });
    data.progress.push_back(total());
  }
  return {};
}

}  // namespace
}  // namespace internal

Result<std::optional<std::string>> find_invalid_start(const CellRegion& region, double margin) {
  CheckerSettings kept;
  kept.margin = margin;
  const auto careful =
      MNEME_TRY(CollisionChecker::make(region.problem.robot, region.problem.scene, kept));
  for (const CellStart& start : region.starts) {
    const auto refused = refuse_query(careful, {start.q, {start.q}});
    if (refused) return fmt::format("start '{}': {}", start.name, refused->message);
  }
  return std::nullopt;
}

Result<Cell> build_cell(const CellRegion& region, const CellSettings& settings,
                        const std::function<void(const CellProgress&)>& on_progress) {
  MNEME_TRY(internal::check_ranges(settings));
  MNEME_TRY(internal::check_region(region));
  if (const auto fault = MNEME_TRY(find_invalid_start(region, settings.margin))) {
    return fail(ErrorCode::invalid, "{}", *fault);
  }
  auto data = MNEME_TRY(internal::make_cell_data(region, settings.margin));
  data->starts.resize(region.starts.size());
  MNEME_TRY(internal::grow(*data, settings, on_progress));
  data->hash = internal::hash_cell(*data);
  return Cell(std::move(data));
}

Result<void> Cell::extend(const CellSettings& settings,
                          const std::function<void(const CellProgress&)>& on_progress) {
  MNEME_TRY(internal::check_ranges(settings));
  if (!data_->is_of_this_world) {
    return fail(ErrorCode::invalid,
                "{}: the robot, the scene or allowed contacts have changed since the cell was "
                "built; prove its boxes again before more are built",
                data_->region.path);
  }
  auto data = std::make_shared<internal::CellData>(*data_);
  for (internal::StartCell& start : data->starts) start.drop_hints();
  CellSettings same = settings;
  same.margin = data->margin;
  MNEME_TRY(internal::grow(*data, same, on_progress));
  data->hash = internal::hash_cell(*data);
  data_ = std::move(data);
  return {};
}

}  // namespace mneme

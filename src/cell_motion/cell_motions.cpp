// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell_motion.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "cell/cell_data.h"
#include "cell_motion/box_motion.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace mneme {
namespace {

const Configuration& start_of(const internal::CellData& cell, const CellAnswer& answer) {
  return cell.region.starts[answer.start].q;
}

const std::vector<internal::CellBox>& boxes_of(const internal::CellData& cell,
                                               const CellAnswer& answer) {
  return cell.starts[answer.start].boxes;
}

}  // namespace

struct CellMotions::Kept {
  /// A box that is timed by whoever asks first.
  struct Box {
    std::once_flag is_timed;
    std::optional<internal::BoxMotion> motion;
  };
  /// All boxes, for certain limits.
  struct Boxes {
    RateLimits limits;
    TrajectorySettings settings;
    std::vector<std::vector<Box>> starts = {};

    [[nodiscard]] bool are_for(const RateLimits& other, const TrajectorySettings& timing) const {
      return limits.velocity == other.velocity && limits.acceleration == other.acceleration &&
             limits.jerk == other.jerk && settings.path_tolerance == timing.path_tolerance &&
             settings.time_rounds == timing.time_rounds;
    }
  };

  explicit Kept(std::shared_ptr<const internal::CellData> data) : cell(std::move(data)) {}

  std::shared_ptr<Boxes> find(const RateLimits& limits, const TrajectorySettings& settings) {
    constexpr std::size_t kMostLimits = 4;
    const std::lock_guard lock(mutex);
    const auto found = std::ranges::find_if(
        kept, [&](const auto& boxes) { return boxes->are_for(limits, settings); });
    if (found != kept.end()) {
      std::rotate(found, found + 1, kept.end());
      return kept.back();
    }
    if (kept.size() == kMostLimits) kept.erase(kept.begin());
    kept.push_back(std::make_shared<Boxes>(Boxes{limits, settings}));
    for (const internal::StartCell& start : cell->starts) {
      kept.back()->starts.emplace_back(start.boxes.size());
    }
    return kept.back();
  }

  /// Keeps the cell's margin from obstacles. Made by the first call, which takes milliseconds.
  const Result<CollisionChecker>& make_careful_checker() {
    std::call_once(is_careful, [&] {
      CheckerSettings wanted;
      wanted.margin = cell->margin;
      const Problem& problem = cell->region.problem;
      careful = CollisionChecker::make(problem.robot, problem.scene, wanted);
    });
    return *careful;
  }

  /// The motion of the answer's box, bent to its task. Returns nothing without one.
  std::optional<Trajectory> bend(const CellAnswer& answer, const RateLimits& limits,
                                 const TrajectorySettings& settings,
                                 const MotionVerifier& verifier) {
    const auto boxes = find(limits, settings);
    const std::size_t index = internal::as_index(answer.box);
    const internal::CellBox& box = boxes_of(*cell, answer)[index];
    Box& timed = boxes->starts[answer.start][index];
    std::call_once(timed.is_timed, [&] {
      timed.motion =
          internal::time_box(*cell, box, start_of(*cell, answer), limits, settings, verifier);
    });
    if (!timed.motion) return std::nullopt;
    const internal::JointVector goal = internal::to_vector(answer.path.back());
    return timed.motion->bent(cell->chain, goal - box.path.goal());
  }

  std::shared_ptr<const internal::CellData> cell;
  std::once_flag is_careful;
  std::optional<Result<CollisionChecker>> careful;
  std::mutex mutex;
  std::vector<std::shared_ptr<Boxes>> kept;  ///< the ones that were used last, last
};

CellMotions::CellMotions(const Cell& cell) : kept_(std::make_shared<Kept>(cell.data_)) {}

Result<CellMotion> CellMotions::time(const CellAnswer& answer, const RateLimits& limits,
                                     const TrajectorySettings& settings) const {
  const internal::CellData& cell = *kept_->cell;
  if (answer.path.empty()) return fail(ErrorCode::invalid, "the answer has no path");
  if (answer.cell != cell.hash || answer.start >= cell.starts.size()) {
    return fail(ErrorCode::invalid,
                "the answer is of another cell, or of this one before a build went on; make "
                "CellMotions of the cell that answered");
  }
  const Robot& robot = cell.region.problem.robot;
  const auto to_motion = [](Trajectory motion) { return CellMotion{std::move(motion)}; };
  if (answer.tier != CellTier::certified) {
    const auto& tools = cell.make_tools();
    if (!tools) return tl::unexpected(tools.error());
    const MotionVerifier verifier(tools->checker);
    return parameterize(robot, answer.path, limits, settings, &verifier).map(to_motion);
  }
  if (answer.path.front() != start_of(cell, answer) ||
      internal::as_index(answer.box) >= boxes_of(cell, answer).size()) {
    return fail(ErrorCode::invalid, "expected an answer of this cell as it was given");
  }
  const auto& careful = kept_->make_careful_checker();
  if (!careful) return tl::unexpected(careful.error());
  const MotionVerifier verifier(*careful);
  auto motion = kept_->bend(answer, limits, settings, verifier);
  if (motion) return CellMotion{*std::move(motion), true};
  return parameterize(robot, answer.path, limits, settings, &verifier).map(to_motion);
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The alternatives of a group of stages, tested from cheap to expensive, one at a time.
#pragma once

#include "mneme/goal.h"

#include "line/floating_body.h"
#include "task/drop_counts.h"
#include "task/follow.h"
#include "task/gripper_motion.h"
#include "task/groups.h"
#include "task/look_ahead.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A stage with its path, before moves are planned.
struct LocalStage {
  int stage = 0;
  CheckedWorldPtr world;
  Path path;                              ///< one configuration if nothing moves
  int alternative = -1;                   ///< of a line with poses
  std::vector<std::string> touches = {};  ///< contacts at the line's end, for people
  GripperMotionPtr gripper = {};
};

/// One choice for a group: what follows from its anchor.
struct Candidate {
  int alternative = -1;
  Configuration begin, end;  ///< where the group's move ends, and where its last stage ends
  Configuration anchor;      ///< where the choice's pose is reached
  std::vector<LocalStage> stages;
  CheckedWorldPtr after;  ///< after all stages, without contact that they allowed
  double time_s = 0;      ///< of the lines
};

/// Alternatives that worked before, best first, each with a configuration near it.
using Remembered = std::vector<std::pair<int, Configuration>>;

/// Ranks the poses of a group's anchor: targets of a link, the number of alternatives before them.
using Ranker = std::function<Remembered(const World& world, const std::vector<Transform>& targets,
                                        std::size_t first, const std::string& link)>;

/// Candidates of a group in one world, from cheap tests to expensive ones.
class Alternatives {
 public:
  /// `next` is the group after this one, if any; an alternative is dropped at once if the object
  /// that it attaches fits no pose of the next group. All must outlive this object.
  Alternatives(TaskRun& run, DropCounts& drops, const Group& group, const Group* next,
               CheckedWorldPtr world, Configuration near, const Ranker& rank);

  /// Returns the next candidate; nothing once none is left or the time is over.
  [[nodiscard]] std::optional<Candidate> next();
  /// Skips what is left of the last candidate's alternative.
  void leave_alternative() {
    pending_.clear();
    found_.clear();
  }
  /// Number of alternatives of the anchor.
  [[nodiscard]] int count() const { return count_; }

 private:
  /// Targets whose hand and object are tested at once: the lanes of the widest vector.
  static constexpr std::size_t kBlock = 16;
  /// A choice of the anchor, followed up to some stage.
  struct LocalState {
    CheckedWorldPtr world;
    Configuration q;
    std::vector<LocalStage> stages;
    Configuration begin, anchor;  ///< as of Candidate
  };
  struct LineEnds {
    std::string link;
    std::vector<Transform> poses;
    bool are_choice = false;
  };
  /// Why a choice fails, and at which stage.
  struct StageFailure {
    int stage = 0;
    Failure failure;
  };

  [[nodiscard]] const Stage& stage(int i) const;
  [[nodiscard]] bool wants_reason(int line) const;
  [[nodiscard]] int failing_stage() const { return group_.anchor.value_or(0); }
  [[nodiscard]] World with_touch(World world) const;
  [[nodiscard]] tl::expected<void, StageFailure> make_ready();
  [[nodiscard]] tl::expected<World, Failure> applied(const World& world, int i,
                                                     const Configuration& q) const;
  void list_alternatives();
  void drop_out_of_reach();
  void make_bodies();
  void filter_block();
  void drop_where(const FloatingBody& body, const std::vector<Transform>& poses,
                  std::vector<int>& block);
  [[nodiscard]] bool suits_next_group(int alternative);
  [[nodiscard]] std::size_t first_target() const { return is_left_.size() - targets_.size(); }
  void sort(const Ranker& rank);
  [[nodiscard]] Transform line_begin(int line, const Transform& X_end,
                                     const std::vector<Transform>& link_poses) const;
  void list_configurations(int alternative);
  [[nodiscard]] PoseGoal goal_of(int alternative) const;
  [[nodiscard]] IkSettings ik_settings() const;
  [[nodiscard]] std::vector<Configuration> solve_kinematics(int alternative);
  void drop_unsolved(const InverseKinematics& kinematics, const PoseGoal& goal,
                     const Configuration& near);
  [[nodiscard]] Result<const InverseKinematics*> kinematics_of(const std::string& link);
  void drop(int stage, const Failure& failure) { drops_.add(stage, failure, alternative_); }
  void drop(const StageFailure& failed) { drop(failed.stage, failed.failure); }
  void drop_in_contact(int stage, const CollisionChecker& checker, const Configuration& q);
  void try_configuration(const Configuration& anchor);
  [[nodiscard]] tl::expected<LocalStage, StageFailure> at_rest(int i, const CheckedWorldPtr& world,
                                                               const Configuration& q);
  [[nodiscard]] tl::expected<LocalState, StageFailure> begin_at_line(const Configuration& anchor);
  void run_from(std::size_t position, LocalState& state);
  [[nodiscard]] LineEnds line_ends(const Stage& line, const World& world,
                                   const Configuration& q) const;
  void run_line(std::size_t position, LocalState& state);
  void finish(const LocalState& state);

  TaskRun& run_;
  DropCounts& drops_;
  const Group& group_;
  const Group* next_group_;
  CheckedWorldPtr world_;    ///< where the move ends
  CheckedWorldPtr touched_;  ///< with the contact that stages of the group allow, where its line
                             ///< begins
  std::vector<std::pair<int, CheckedWorldPtr>> before_line_;  ///< stages between move and line
  Configuration near_;
  int count_ = 0;
  std::string link_;                   ///< of the anchor's poses
  std::vector<Transform> targets_;     ///< per alternative that is a pose
  std::vector<std::uint8_t> is_left_;  ///< per alternative: 0 once dropped
  std::vector<std::pair<int, std::optional<Configuration>>> order_;
  std::size_t position_ = 0;  ///< next entry of `order_`
  std::size_t tested_ = 0;    ///< entries of `order_` that are remembered, or whose hand was tested
  int alternative_ = -1;      ///< the one that is being tried
  bool has_looked_ahead_ = false, has_bodies_ = false;
  std::optional<FloatingBody> hand_, object_;
  std::optional<LookAhead> ahead_;
  std::map<std::string, InverseKinematics> kinematics_;  ///< by link
  std::deque<std::pair<int, Configuration>> pending_;    ///< of the last alternative, not tried yet
  std::deque<Candidate> found_;
};

}  // namespace mneme::internal

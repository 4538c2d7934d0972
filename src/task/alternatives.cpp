// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/alternatives.h"

#include "base/as_index.h"
#include "goal/any_rotation.h"
#include "planning/end_contacts.h"
#include "task/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>

namespace mneme::internal {
namespace {

/// Metres that count as much as a radian when poses are ordered.
constexpr double kMetresPerTurn = 0.3;
/// Seeds of inverse kinematics that all alternatives of a stage share at least.
constexpr int kSharedSeeds = 512;

double pose_distance(const Transform& a, const Transform& b) {
  const double cosine = 0.5 * ((a.rotation.transpose() * b.rotation).trace() - 1);
  return (a.translation - b.translation).norm() +
         kMetresPerTurn * std::acos(std::clamp(cosine, -1.0, 1.0));
}

/// The direction of a line in the root link's frame.
Vec3 line_direction(const Robot& robot, const Stage& line,
                    const std::vector<Transform>& link_poses) {
  if (line.along.empty()) return line.direction;
  return link_poses[as_index(*robot.find_link(line.along))].rotation * line.direction;
}

}  // namespace

Alternatives::Alternatives(TaskRun& run, DropCounts& drops, const Group& group, const Group* next,
                           CheckedWorldPtr world, Configuration near, const Ranker& rank)
    : run_(run),
      drops_(drops),
      group_(group),
      next_group_(next),
      world_(std::move(world)),
      touched_(world_),
      near_(std::move(near)) {
  if (auto ready = make_ready(); !ready) {
    drop(ready.error());
    return;
  }
  list_alternatives();
  drop_out_of_reach();
  sort(rank);
}

bool Alternatives::wants_reason(int line) const {
  return drops_.wants_what(line, DropReason::contact) && drops_.wants_what(line, DropReason::line);
}

const Stage& Alternatives::stage(int i) const { return run_.task.stages[as_index(i)]; }

/// Objects may touch the links that take them where a line ends.
World Alternatives::with_touch(World world) const {
  for (const int i : group_.local) {
    const Stage& at = stage(i);
    if (at.kind != StageKind::attach) continue;
    let_touch_at_ends(world.scene, at.object, at.may_touch, run_.settings.solve.allow_at_ends);
  }
  return world;
}

/// The world after a stage without motion.
tl::expected<World, Failure> Alternatives::applied(const World& world, int i,
                                                   const Configuration& q) const {
  const Stage& at = stage(i);
  if (at.kind == StageKind::attach) {
    if (const auto near = check_near(world, at, q); !near) {
      return tl::unexpected(Failure{DropReason::attach, near.error().message});
    }
  }
  auto next = after_stage(world, at, q);
  if (!next) return tl::unexpected(Failure{DropReason::world, next.error().message});
  if (at.kind == StageKind::detach) {
    let_touch_at_ends(next->scene, at.object, world.held.at(at.object).may_touch,
                      run_.settings.solve.allow_at_ends);
  }
  return *std::move(next);
}

/// Applies contact that the group allows, and the stages between the move and its line.
tl::expected<void, Alternatives::StageFailure> Alternatives::make_ready() {
  World world = with_touch(world_->world);
  const auto check = [&](int i) -> tl::expected<void, StageFailure> {
    auto checked = check_world(world, run_);
    if (!checked) {
      return tl::unexpected(StageFailure{i, {DropReason::world, checked.error().message}});
    }
    touched_ = *std::move(checked);
    return {};
  };
  const int first = group_.move.value_or(0);
  if (!(world.scene == world_->world.scene)) {
    if (auto checked = check(first); !checked) return checked;
  }
  for (const int i : group_.local) {
    if (!group_.is_line_anchor || i == *group_.anchor || run_.is_over()) break;
    before_line_.emplace_back(i, touched_);
    auto next = applied(world, i, near_);
    if (!next) return tl::unexpected(StageFailure{i, next.error()});
    world = *std::move(next);
    if (auto checked = check(i); !checked) return checked;
  }
  return {};
}

void Alternatives::list_alternatives() {
  if (!group_.anchor) {
    count_ = 1;
  } else {
    const Stage& at = stage(*group_.anchor);
    if (!at.poses.poses.empty()) {
      link_ = at.poses.link;
      targets_ = link_targets(touched_->world, at.poses, run_.start_poses);
    }
    count_ = static_cast<int>(at.goals.size() + targets_.size());
  }
  is_left_.assign(as_index(count_), 1);
}

/// Where a line that ends at X_end begins.
Transform Alternatives::line_begin(int line, const Transform& X_end,
                                   const std::vector<Transform>& link_poses) const {
  const Stage& at = stage(line);
  const Vec3 direction = at.along == link_ ? Vec3(X_end.rotation * at.direction)
                                           : line_direction(world_->world.robot, at, link_poses);
  Transform begin = X_end;
  begin.translation -= at.distance * direction;
  return begin;
}

/// Drops goals beyond the joint limits and targets out of reach.
void Alternatives::drop_out_of_reach() {
  const auto drop_at = [&](std::size_t i, std::string what) {
    is_left_[i] = 0;
    drops_.add(failing_stage(), {DropReason::reach, std::move(what)}, static_cast<int>(i));
  };
  if (!group_.anchor) return;
  const Robot& robot = touched_->world.robot;
  const std::vector<MoveGoal>& goals = stage(*group_.anchor).goals;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const auto* q = std::get_if<Configuration>(&goals[i]);
    if (q == nullptr) continue;
    if (auto flaw = robot.describe_violation(*q, "its goal")) drop_at(i, *std::move(flaw));
  }
  if (targets_.empty()) return;
  const Reach reach(robot, link_);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (!reach.contains(targets_[i])) drop_at(first_target() + i, fmt::format("link '{}'", link_));
  }
}

/// Makes the bodies of the hand and of what it holds, once.
void Alternatives::make_bodies() {
  if (std::exchange(has_bodies_, true)) return;
  const World& world = touched_->world;
  hand_ = FloatingBody::of_link(world.robot, world.scene, link_, run_.body_settings());
  const PoseChoice& choice = stage(*group_.anchor).poses;
  if (!choice.object.empty()) {
    object_ = FloatingBody::of_object(world.robot, world.scene, choice.object,
                                      world.held.at(choice.object).X_LO, run_.body_settings());
  }
}

/// Tests the hand, and the object in it, at the next few targets in order.
void Alternatives::filter_block() {
  tested_ = std::min(order_.size(), tested_ + kBlock);
  if (targets_.empty()) return;
  make_bodies();
  std::vector<int> block;
  for (std::size_t i = position_; i < tested_; ++i) {
    if (as_index(order_[i].first) >= first_target()) block.push_back(order_[i].first);
  }
  const World& world = touched_->world;
  const PoseChoice& choice = stage(*group_.anchor).poses;
  const auto test = [&](const std::optional<FloatingBody>& body, const auto& pose_at) {
    if (!body || block.empty()) return;
    std::vector<Transform> poses;
    for (const int i : block) poses.push_back(pose_at(targets_[as_index(i) - first_target()]));
    drop_where(*body, poses, block);
  };
  if (object_) {
    const Transform X_LO = world.held.at(choice.object).X_LO;
    test(object_, [&](const Transform& target) { return target * X_LO; });
  }
  test(hand_, [](const Transform& target) { return target; });
  // Where other links will be, no target tells.
  const std::string& along = stage(*group_.anchor).along;
  if (!group_.is_line_anchor || !(along.empty() || along == link_)) return;
  test(hand_, [&](const Transform& target) { return line_begin(*group_.anchor, target, {}); });
}

/// Drops the alternatives of `block` at whose poses the body is not free.
void Alternatives::drop_where(const FloatingBody& body, const std::vector<Transform>& poses,
                              std::vector<int>& block) {
  run_.states += poses.size();
  const std::vector<std::uint8_t> is_free = body.find_free(poses);
  std::string what;
  std::vector<int> left;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_free[i]) {
      left.push_back(block[i]);
      continue;
    }
    is_left_[as_index(block[i])] = 0;
    run_.has_tried = run_.has_tried || body.has_surfaces();
    // Naming bodies costs more than the test: one speaks for its block.
    if (what.empty() && drops_.wants_what(failing_stage(), DropReason::contact)) {
      what = body.describe_contact(poses[i]);
    }
    drops_.add(failing_stage(), {DropReason::contact, what}, block[i]);
  }
  block = std::move(left);
}

/// True unless the hand fits at no pose of the next group with this grasp.
bool Alternatives::suits_next_group(int alternative) {
  if (!std::exchange(has_looked_ahead_, true) && next_group_ != nullptr && !targets_.empty()) {
    ahead_ = LookAhead::make(run_, group_, *next_group_, touched_->world, link_);
  }
  if (!ahead_) return true;
  const Transform& target = targets_[as_index(alternative) - first_target()];
  const bool has_reason = drops_.wants_what(failing_stage(), DropReason::place);
  const auto failure = ahead_->find_failure(run_, target, has_reason);
  if (!failure) return true;
  drops_.add(failing_stage(), *failure, alternative);
  return false;
}

void Alternatives::sort(const Ranker& rank) {
  std::vector<std::uint8_t> is_listed(is_left_.size(), 0);
  const Remembered remembered =
      targets_.empty() ? Remembered() : rank(touched_->world, targets_, first_target(), link_);
  for (const auto& [alternative, q] : remembered) {
    if (as_index(alternative) >= is_left_.size() || !is_left_[as_index(alternative)]) continue;
    if (std::exchange(is_listed[as_index(alternative)], 1)) continue;
    order_.emplace_back(alternative, q);
  }
  // Remembered ones mostly are free: the arm and its line are checked at once.
  tested_ = order_.size();
  std::vector<std::pair<double, int>> rest;
  Transform from;
  if (!targets_.empty()) {
    from = world_->world.robot.link_poses(near_)[as_index(*world_->world.robot.find_link(link_))];
  }
  for (std::size_t i = 0; i < is_left_.size(); ++i) {
    if (!is_left_[i] || is_listed[i]) continue;
    const bool is_target = i >= first_target();
    rest.emplace_back(is_target ? pose_distance(from, targets_[i - first_target()]) : 0,
                      static_cast<int>(i));
  }
  std::ranges::sort(rest);
  for (const auto& [distance, alternative] : rest) order_.emplace_back(alternative, std::nullopt);
}

std::optional<Candidate> Alternatives::next() {
  while (found_.empty() && !run_.is_over()) {
    if (!pending_.empty()) {
      const auto [known, q] = std::move(pending_.front());
      pending_.pop_front();
      alternative_ = known;
      try_configuration(q);
      continue;
    }
    if (position_ == order_.size()) break;
    if (position_ == tested_) filter_block();
    const auto& [alternative, hint] = order_[position_++];
    if (!is_left_[as_index(alternative)]) continue;
    alternative_ = alternative;
    const bool is_unknown = as_index(alternative) >= first_target() && !hint;
    if (is_unknown && !suits_next_group(alternative)) continue;
    list_configurations(alternative);
  }
  if (found_.empty()) return std::nullopt;
  Candidate first = std::move(found_.front());
  found_.pop_front();
  return first;
}

/// The region or the pose of an alternative that is no configuration.
PoseGoal Alternatives::goal_of(int alternative) const {
  if (as_index(alternative) < first_target()) {
    return std::get<PoseGoal>(stage(*group_.anchor).goals[as_index(alternative)]);
  }
  return {.link = link_, .pose = targets_[as_index(alternative) - first_target()]};
}

IkSettings Alternatives::ik_settings() const {
  IkSettings settings = run_.settings.solve.ik;
  settings.seed = run_.settings.solve.plan.seed;
  settings.seeds = std::min(settings.seeds, std::max(run_.seeds(), kSharedSeeds / count_));
  settings.solutions = run_.branches();
  settings.is_over = [this] { return run_.is_over(); };
  return settings;
}

std::vector<Configuration> Alternatives::solve_kinematics(int alternative) {
  const PoseGoal goal = goal_of(alternative);
  const CollisionChecker& checker = touched_->checker;
  const auto kinematics = kinematics_of(goal.link);
  if (!kinematics) {
    drop(failing_stage(), {DropReason::kinematics, kinematics.error().message});
    return {};
  }
  run_.has_tried = true;
  const auto& hint = order_[position_ - 1].second;
  const Configuration& near = hint ? *hint : near_;
  // A held object may rest on something at the end of a line.
  const bool may_touch = group_.is_line_anchor && run_.may_touch_at_ends(touched_->world);
  IkResult reached =
      (*kinematics)
          ->solve(goal, near, ik_settings(), may_touch ? nullptr : &checker, kVerificationMargin);
  run_.states += reached.solutions.size() + reached.blocked.size();
  if (!reached.solutions.empty()) return std::move(reached.solutions);
  if (reached.blocked.empty()) {
    drop_unsolved(**kinematics, goal, near);
    return {};
  }
  reached.blocked.resize(std::min(reached.blocked.size(), as_index(run_.branches())));
  // Exact geometry decides: of a held object near what it is put on always, of others in later
  // rounds.
  if (run_.round > 0 || run_.may_touch_at_ends(touched_->world)) return std::move(reached.blocked);
  drop_in_contact(failing_stage(), checker, reached.blocked.front());
  return {};
}

/// Says of a goal without a configuration the same as PoseGoalSource::describe_failure().
void Alternatives::drop_unsolved(const InverseKinematics& kinematics, const PoseGoal& goal,
                                 const Configuration& near) {
  const auto gap = find_gap_with_any_rotation(kinematics, goal, near, ik_settings());
  const DropReason reason = gap.value_or(0) > 0 ? DropReason::reach : DropReason::kinematics;
  drop(failing_stage(), {reason, fmt::format("link '{}'", goal.link)});
}

Result<const InverseKinematics*> Alternatives::kinematics_of(const std::string& link) {
  auto found = kinematics_.find(link);
  if (found == kinematics_.end()) {
    const CollisionChecker& checker = touched_->checker;
    auto made = MNEME_TRY(InverseKinematics::make(checker.robot(), link, checker.isa()));
    found = kinematics_.emplace(link, std::move(made)).first;
  }
  return &found->second;
}

void Alternatives::drop_in_contact(int stage, const CollisionChecker& checker,
                                   const Configuration& q) {
  Failure failure{DropReason::contact, {}};
  if (drops_.wants_what(stage, failure.reason)) failure.what = describe_contact(checker, q);
  drop(stage, failure);
}

/// Configurations that reach the alternative, to be tried one by one.
void Alternatives::list_configurations(int alternative) {
  const auto add = [&](Configuration q) { pending_.emplace_back(alternative, std::move(q)); };
  if (!group_.anchor) return add(run_.task.start);
  if (as_index(alternative) < first_target()) {
    const MoveGoal& goal = stage(*group_.anchor).goals[as_index(alternative)];
    if (const auto* q = std::get_if<Configuration>(&goal)) return add(*q);
  }
  for (Configuration& q : solve_kinematics(alternative)) add(std::move(q));
}

/// Stage `i`, in which the group stays at `q`; the gripper may move.
tl::expected<LocalStage, Alternatives::StageFailure> Alternatives::at_rest(
    int i, const CheckedWorldPtr& world, const Configuration& q) {
  LocalStage local{i, world, {q}};
  if (stage(i).kind == StageKind::gripper) {
    auto moved = move_gripper(run_, *world, stage(i), q);
    if (!moved) return tl::unexpected(StageFailure{i, moved.error()});
    local.gripper = *std::move(moved);
  }
  return local;
}

tl::expected<Alternatives::LocalState, Alternatives::StageFailure> Alternatives::begin_at_line(
    const Configuration& anchor) {
  const int line = *group_.anchor;
  const std::vector<Transform> poses = world_->world.robot.link_poses(anchor);
  const Transform X_end = poses[as_index(*world_->world.robot.find_link(link_))];
  auto followed = follow_line(
      run_, touched_, {link_, anchor, line_begin(line, X_end, poses), false, wants_reason(line)});
  if (!followed) return tl::unexpected(StageFailure{line, followed.error()});
  LocalState state{followed->world, anchor, {}, followed->path.front(), anchor};
  for (const auto& [i, world] : before_line_) {
    auto local = at_rest(i, world, state.begin);
    if (!local) return tl::unexpected(local.error());
    state.stages.push_back(*std::move(local));
  }
  state.stages.push_back(
      {line, followed->world, std::move(followed->path), -1, std::move(followed->touches)});
  return state;
}

void Alternatives::try_configuration(const Configuration& anchor) {
  const Robot& robot = world_->world.robot;
  if (const auto violation = robot.describe_violation(anchor, "its goal")) {
    return drop(failing_stage(), {DropReason::reach, *violation});
  }
  if (!group_.is_line_anchor) {
    ++run_.states;
    // A held object may rest on something: the move then enters this contact last.
    const bool may_rest = run_.may_touch_at_ends(world_->world);
    const bool is_checked = group_.anchor.has_value() && !may_rest;
    if (is_checked && !is_clear_by_exact_geometry(world_->checker, anchor)) {
      return drop_in_contact(failing_stage(), world_->checker, anchor);
    }
    LocalState state{touched_, anchor, {}, anchor, anchor};
    return run_from(0, state);
  }
  auto state = begin_at_line(anchor);
  if (!state) return drop(state.error());
  ++run_.states;
  if (world_ != touched_ && !is_clear_by_exact_geometry(world_->checker, state->begin)) {
    return drop_in_contact(failing_stage(), world_->checker, state->begin);
  }
  const auto line = std::ranges::find(group_.local, *group_.anchor);
  run_from(as_index(static_cast<int>(line - group_.local.begin())) + 1, *state);
}

/// Leaves more stages in `state`.
void Alternatives::run_from(std::size_t position, LocalState& state) {
  for (; position < group_.local.size(); ++position) {
    if (run_.is_over()) return;
    const int i = group_.local[position];
    if (stage(i).kind == StageKind::line) return run_line(position, state);
    auto local = at_rest(i, state.world, state.q);
    if (!local) return drop(local.error());
    auto next = applied(state.world->world, i, state.q);
    if (!next) return drop(i, next.error());
    auto checked = check_world(*std::move(next), run_);
    if (!checked) return drop(i, {DropReason::world, checked.error().message});
    if (!may_stand(run_, *checked, state.q))
      return drop_in_contact(i, (*checked)->checker, state.q);
    state.stages.push_back(*std::move(local));
    state.world = *std::move(checked);
  }
  finish(state);
}

/// Where the link of a line may end that begins at `q`.
Alternatives::LineEnds Alternatives::line_ends(const Stage& line, const World& world,
                                               const Configuration& q) const {
  LineEnds ends{line.poses.link, link_targets(world, line.poses, run_.start_poses)};
  ends.are_choice = !ends.poses.empty();
  if (ends.are_choice) return ends;
  const std::vector<Transform> poses = world.robot.link_poses(q);
  ends.link = line.link;
  ends.poses.push_back(poses[as_index(*world.robot.find_link(line.link))]);
  ends.poses.back().translation += line.distance * line_direction(world.robot, line, poses);
  return ends;
}

/// Tries the ends of a line one after the other. Each begins with the stages that `state` has now.
void Alternatives::run_line(std::size_t position, LocalState& state) {
  const int i = group_.local[position];
  const CheckedWorldPtr world = state.world;
  const Configuration q = state.q;
  const std::size_t stages = state.stages.size();
  const LineEnds ends = line_ends(stage(i), world->world, q);
  for (std::size_t end = 0; end < ends.poses.size() && !run_.is_over(); ++end) {
    auto followed =
        follow_line(run_, world, {ends.link, q, ends.poses[end], true, wants_reason(i)});
    const int choice = ends.are_choice ? static_cast<int>(end) : -1;
    if (!followed) {
      drops_.add(i, followed.error(), ends.are_choice ? choice : alternative_);
      continue;
    }
    state.world = world;
    state.q = followed->path.back();
    state.stages.resize(stages);
    state.stages.push_back({i, followed->world, std::move(followed->path), choice});
    run_from(position + 1, state);
  }
}

void Alternatives::finish(const LocalState& state) {
  Candidate candidate;
  candidate.alternative = group_.anchor ? alternative_ : -1;
  candidate.begin = state.begin;
  candidate.end = state.q;
  candidate.anchor = state.anchor;
  World after = state.world->world;
  // The hand may touch what it takes or leaves in this group only.
  after.scene.end_contacts = run_.task.scene.end_contacts;
  candidate.after = state.world;
  if (!(after.scene == state.world->world.scene)) {
    auto checked = check_world(std::move(after), run_);
    if (!checked) return;
    candidate.after = *std::move(checked);
  }
  for (const LocalStage& each : state.stages) {
    const double speed = stage(each.stage).speed;
    candidate.time_s += path_time(each.world->world.robot, each.path) / speed;
    if (each.gripper) {
      candidate.time_s += path_time(each.gripper->world->robot, each.gripper->path) / speed;
    }
  }
  candidate.stages = state.stages;
  found_.push_back(std::move(candidate));
}

}  // namespace mneme::internal

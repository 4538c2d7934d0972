// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "line/line_search.h"

#include "base/as_index.h"
#include "check/parted_pairs.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mneme::internal {
namespace {

/// Seeds and solutions of inverse kinematics for one place that branches grow towards.
constexpr int kSeeds = 32, kSolutions = 4;
/// Gain of the drift away from limits where the usual one does not suffice.
constexpr double kStrongDrift = 5;
/// Distance ahead of the farthest state, metres, of every other place.
constexpr double kAhead = 0.01;
/// Places ahead without a configuration after which the search ends.
constexpr int kPatience = 6;
/// Configurations that branches grow towards without getting any farther, after which it ends.
constexpr int kMostFutile = 48;
/// Largest motion of the joints per metre of the line, radians, towards a configuration.
constexpr double kMostDrift = 40;

/// Rounding error of a share of the line.
constexpr double kRounding = 1e-12;

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

}  // namespace

LineSearch::LineSearch(LineTracker& tracker, const CollisionChecker& checker, const PoseGoal& start,
                       const LineSettings& settings)
    : tracker_(tracker),
      checker_(checker),
      goal_(start),
      settings_(settings),
      rng_(settings.seed) {}

void LineSearch::run(const std::vector<JointVector>& starts, bool may_add_starts) {
  std::vector<int> roots;
  for (const JointVector& q : starts) {
    if (is_over() || has_enough() || is_link_blocked()) break;
    roots.push_back(add(tracker_.begin(0, q), -1));
    take_whole(extend(extend_at_once(roots.back()), {1, LineCheck::proof}));
  }
  if (roots.empty()) return;
  if (tracker_.redundancy() > 0 && !is_link_blocked()) {
    for (const int root : roots) {
      if (is_over() || has_enough() || is_link_blocked()) break;
      take_whole(extend(root, {1, LineCheck::states, kStrongDrift}));
    }
    explore(may_add_starts);
  }
  if (!has_enough()) farthest_ = prove(farthest_);
}

bool LineSearch::is_link_blocked() {
  if (stop_.kind != LineStop::Kind::contact || goal_.turn > 0) return false;
  if (stop_s_ == examined_s_) return is_link_blocked_;
  examined_s_ = stop_s_;
  const Robot& robot = checker_.robot();
  if (carried_.empty()) {
    for (const int link : rigid_with(robot, *robot.find_link(goal_.link))) {
      carried_.push_back(robot.links()[as_index(link)].name);
    }
  }
  const Configuration q(stop_.to.data(), stop_.to.data() + robot.joint_count());
  is_link_blocked_ = std::ranges::any_of(checker_.contacts(q), [&](const Contact& contact) {
    return !contact.is_self && std::ranges::count(carried_, contact.link) > 0;
  });
  return is_link_blocked_;
}

bool LineSearch::has_enough() const { return std::ssize(whole_) >= settings_.line_paths; }

bool LineSearch::is_over() {
  is_cancelled_ = settings_.cancel != nullptr && settings_.cancel->load();
  is_timed_out_ = stopwatch_.elapsed_s() > settings_.timeout_s;
  return is_cancelled_ || is_timed_out_ || steps_ >= settings_.line_steps;
}

int LineSearch::add(const LineState& state, int parent) {
  const int node = static_cast<int>(nodes_.size());
  nodes_.push_back({state, parent});
  if (farthest_ < 0 || state.s > at(farthest_).s) farthest_ = node;
  return node;
}

int LineSearch::extend(int node, const Growth& growth) {
  while (at(node).s < growth.until - kRounding) {
    const LineState from = at(node);
    LineState to;
    LineStop stop =
        tracker_.step(from, growth.until, drift(from, growth), growth.check, to, steps_);
    if (stop.kind == LineStop::Kind::none) {
      node = add(to, node);
      if (to.s == 1 || !is_over()) continue;
      stop = {LineStop::Kind::budget, -1, to.q, to.q};
    }
    note(stop, at(node).s, growth.goal == nullptr);
    break;
  }
  return node;
}

int LineSearch::extend_at_once(int root) {
  std::vector<LineState> states = {at(root)};
  int steps = 0;
  while (states.back().s < 1 && steps_ + steps < settings_.line_steps) {
    LineState to;
    const JointVector drift = tracker_.drift_from_limits(states.back().q);
    const LineStop stop = tracker_.step(states.back(), 1, drift, LineCheck::kinematics, to, steps);
    if (stop.kind != LineStop::Kind::none) return root;
    states.push_back(to);
  }
  if (states.back().s < 1 || !tracker_.prove(states)) return root;
  steps_ += steps;
  int node = root;
  for (LineState& state : std::span(states).subspan(1)) {
    state.is_proven = true;
    node = add(state, node);
  }
  return node;
}

JointVector LineSearch::drift(const LineState& from, const Growth& growth) const {
  if (growth.goal == nullptr) return growth.gain * tracker_.drift_from_limits(from.q);
  JointVector drift = motion(from.q, *growth.goal) / (growth.until - from.s);
  const double most = kMostDrift * tracker_.segment().size();
  if (drift.norm() > most) drift *= most / drift.norm();
  return drift;
}

void LineSearch::note(const LineStop& stop, double s, bool is_plain) {
  if (s < stop_s_ || (s == stop_s_ && !is_plain)) return;
  stop_ = stop;
  stop_s_ = s;
}

int LineSearch::prove(int node) {
  std::vector<int> unproven;
  for (int i = node; i >= 0 && !at(i).is_proven; i = nodes_[as_index(i)].parent) {
    unproven.push_back(i);
  }
  for (; !unproven.empty(); unproven.pop_back()) {
    Node& next = nodes_[as_index(unproven.back())];
    if (!tracker_.prove(at(next.parent), next.state)) {
      stop_ = {LineStop::Kind::contact, -1, at(next.parent).q, next.state.q};
      return next.parent;
    }
    next.state.is_proven = true;
  }
  return node;
}

void LineSearch::take_whole(int node) {
  if (at(node).s < 1) return;
  const int root = root_of(node);
  const auto is_same = [&](int other) { return root_of(other) == root; };
  if (std::ranges::none_of(whole_, is_same) && prove(node) == node) whole_.push_back(node);
}

int LineSearch::root_of(int node) const {
  while (nodes_[as_index(node)].parent >= 0) node = nodes_[as_index(node)].parent;
  return node;
}

void LineSearch::explore(bool may_add_starts) {
  int barren = 0, futile = 0;
  for (int i = 0; barren < kPatience && futile < kMostFutile; ++i) {
    if (is_over() || has_enough()) return;
    const double reached = at(farthest_).s, s = choose_place(i, may_add_starts);
    const std::vector<JointVector> goals = sample_states(s);
    if (s >= reached) barren = goals.empty() ? barren + 1 : 0;
    for (const JointVector& goal : goals) {
      if (is_over() || has_enough()) return;
      grow_towards(goal, s);
      ++futile;
    }
    if (at(farthest_).s > reached) futile = 0;
  }
}

double LineSearch::choose_place(int i, bool may_add_starts) {
  const double reached = at(farthest_).s;
  if (i % 4 == 1 && reached > 0) return rng_.uniform(0.05 * reached, reached);
  if (i % 4 == 3) return may_add_starts ? 0 : rng_.uniform(reached, 1);
  return std::min(1.0, reached + kAhead / tracker_.segment().size());
}

void LineSearch::grow_towards(const JointVector& goal, double s) {
  const int last = s == 0 ? add(tracker_.begin(0, goal), -1)
                          : extend(find_nearest(goal, s), {s, LineCheck::states, 1, &goal});
  if (at(last).s >= s - kRounding) take_whole(extend(last, {1, LineCheck::states}));
}

std::vector<JointVector> LineSearch::sample_states(double s) {
  if (!kinematics_) {
    auto made = InverseKinematics::make(checker_.robot(), goal_.link, checker_.isa());
    if (!made) return {};
    kinematics_.emplace(*std::move(made));
  }
  goal_.pose = tracker_.segment().at(s);
  IkSettings settings;
  settings.seeds = kSeeds;
  settings.solutions = kSolutions;
  settings.apart = 0.2;
  settings.seed = rng_.next();
  const JointVector& last = at(farthest_).q;
  const auto joints = checker_.robot().joint_count();
  const Configuration near(last.data(), last.data() + joints);
  std::vector<JointVector> states;
  for (const Configuration& q :
       kinematics_->solve(goal_, near, settings, &checker_, kVerificationMargin).solutions) {
    JointVector state = with_free_axis(q, s);
    if (tracker_.settle(s, state)) states.push_back(state);
  }
  return states;
}

JointVector LineSearch::with_free_axis(const Configuration& q, double s) const {
  const LinkChain& chain = tracker_.chain();
  JointVector state = JointVector::Zero(chain.joint_count());
  for (std::size_t j = 0; j < q.size(); ++j) state[static_cast<Eigen::Index>(j)] = q[j];
  if (chain.joint_count() == std::ssize(q)) return state;
  const Transform pose = chain.place(state);
  const Eigen::Quaterniond turn(pose.rotation.transpose() * tracker_.segment().at(s).rotation);
  const double about = turn.vec()[static_cast<int>(goal_.axis)];
  state[chain.joint_count() - 1] = wrapped(2 * std::atan2(about, turn.w()));
  return state;
}

JointVector LineSearch::motion(const JointVector& from, const JointVector& to) const {
  JointVector delta = to - from;
  for (int j = 0; j < delta.size(); ++j) {
    if (tracker_.chain().wraps(j)) delta[j] = wrapped(delta[j]);
  }
  return delta;
}

int LineSearch::find_nearest(const JointVector& goal, double s) const {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  const double size = tracker_.segment().size();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const LineState& state = nodes_[i].state;
    if (state.s >= s) continue;
    const double distance = motion(state.q, goal).norm();
    // Beyond what the drift can close, a node is no use.
    const double gap = std::max(0.0, distance - 0.5 * kMostDrift * size * (s - state.s));
    const double cost = distance + 100 * gap;
    if (cost >= least) continue;
    least = cost;
    nearest = static_cast<int>(i);
  }
  return nearest;
}

LinePath LineSearch::path_to(int node) const {
  LinePath path;
  const auto joints = checker_.robot().joint_count();
  for (; node >= 0; node = nodes_[as_index(node)].parent) {
    const LineState& state = at(node);
    path.path.emplace_back(state.q.data(), state.q.data() + joints);
    path.fractions.push_back(state.s);
    path.position_deviation = std::max({path.position_deviation, state.off_line, state.position});
    path.rotation_deviation =
        std::max({path.rotation_deviation, state.off_rotation, state.rotation});
  }
  std::ranges::reverse(path.path);
  std::ranges::reverse(path.fractions);
  return path;
}

LinePath LineSearch::farthest() const { return farthest_ < 0 ? LinePath{} : path_to(farthest_); }

std::vector<LinePath> LineSearch::whole() const {
  std::vector<LinePath> paths;
  for (const int node : whole_) paths.push_back(path_to(node));
  return paths;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// ERTConnect: Pairet, Chamzas, Petillot and Kavraki, arXiv 2103.00448. Two trees grow by pieces of
// one remembered path. Each piece is translated to its first node and sheared to its target.
// docs/design/baselines.md lists the departures.
#include "mneme/planning.h"

#include "path/waypoints.h"
#include "pipeline/memory_steps.h"
#include "pipeline/resolve_goals.h"
#include "planning/planner_run.h"
#include "planning/tree.h"
#include "baselines/solvers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

constexpr int kPhases = 50;  ///< discretization of the remembered path
constexpr int kLeastSpan = kPhases / 20, kMostSpan = kPhases / 10;
/// Half width of the box that a piece explores, per share of the path, radians.
constexpr double kTube = 5;

/// A remembered path, translated and sheared to the ends of the query.
class PriorPath {
 public:
  PriorPath(const Robot& robot, const std::vector<float>& rows, const std::vector<float>& start,
            const std::vector<float>& goal)
      : joints_(static_cast<std::size_t>(robot.joint_count())), states_((kPhases + 1) * joints_) {
    Waypoints waypoints(robot);
    waypoints.assign(rows);
    for (int phase = 0; phase <= kPhases; ++phase) {
      const float part = static_cast<float>(phase) / kPhases;
      waypoints.write(waypoints.locate(part * waypoints.length()), states_.data() + index(phase));
    }
    std::vector<float> moved(joints_), shear(joints_);
    for (std::size_t j = 0; j < joints_; ++j) moved[j] = start[j] + change(0, kPhases, j);
    waypoints.space().difference(moved.data(), goal.data(), shear.data());
    for (int phase = 0; phase <= kPhases; ++phase) {
      for (std::size_t j = 0; j < joints_; ++j) {
        states_[index(phase) + j] += shear[j] * static_cast<float>(phase) / kPhases;
      }
    }
  }
  /// Change of a joint between two phases, 0 to kPhases; continuous joints do not wrap.
  [[nodiscard]] float change(int from, int to, std::size_t joint) const {
    return states_[index(to) + joint] - states_[index(from) + joint];
  }

 private:
  [[nodiscard]] std::size_t index(int phase) const {
    return static_cast<std::size_t>(phase) * joints_;
  }

  std::size_t joints_;
  std::vector<float> states_;
};

/// Samples nodes by weight with a Fenwick tree.
class Weights {
 public:
  void add(double weight) {
    sums_.push_back(0);
    values_.push_back(0);
    const std::size_t i = sums_.size();
    for (std::size_t step = 1; step < (i & -i); step *= 2) sums_.back() += sums_[i - step - 1];
    set(i - 1, weight);
  }
  void set(std::size_t i, double weight) {
    const double change = weight - std::exchange(values_[i], weight);
    total_ += change;
    for (++i; i <= sums_.size(); i += i & -i) sums_[i - 1] += change;
  }
  /// The node at `fraction` in [0, 1) of the total weight.
  [[nodiscard]] int sample(double fraction) const {
    double left = fraction * total_;
    std::size_t i = 0;
    for (std::size_t step = std::bit_floor(sums_.size()); step > 0; step /= 2) {
      if (i + step > sums_.size() || sums_[i + step - 1] > left) continue;
      left -= sums_[i + step - 1];
      i += step;
    }
    return static_cast<int>(std::min(i, sums_.size() - 1));
  }

 private:
  std::vector<double> sums_, values_;
  double total_ = 0;
};

class ErtConnect {
 public:
  /// Plans from the start to the goal with index `goal`.
  ErtConnect(PlannerRun& run, PriorPath prior, std::size_t goal)
      : run_(run),
        prior_(std::move(prior)),
        rng_(run.make_rng(RngStream::goals)),
        reaches_(joint_deviations(run.checker().robot(), kTube)),
        sides_{Side(run, 0), Side(run, 1)} {
    add(sides_[0], run.start(), -1, 0, true);
    add(sides_[1], run.goals()[goal], -1, kPhases, true);
  }

  PlanResult solve() {
    if (is_solved_by(extend(sides_[0], 0, kPhases, root(sides_[1])), sides_[1], 0)) return finish();
    for (bool is_forward = true; run_.begin_iterations() > 0; is_forward = !is_forward) {
      Side& growing = sides_[is_forward ? 0 : 1];
      Side& other = sides_[is_forward ? 1 : 0];
      const int node = grow(growing, other);
      if (node < 0) continue;
      const int facing = other.tree.nearest(growing.tree[node]);
      const int end =
          extend(growing, node, other.phases[static_cast<std::size_t>(facing)], other.tree[facing]);
      if (is_solved_by(end, other, facing)) return finish();
    }
    return run_.give_up(node_count());
  }

 private:
  struct Side {
    Side(PlannerRun& run, int graph) : tree(run, graph) {}
    Tree tree;
    std::vector<int> phases, sample_counts;  ///< per node
    Weights weights;
  };

  [[nodiscard]] static std::span<const float> root(const Side& side) { return side.tree[0]; }
  [[nodiscard]] int node_count() const { return sides_[0].tree.size() + sides_[1].tree.size(); }
  PlanResult finish() { return run_.finish(node_count()); }

  /// Only ends of pieces can be sampled: other nodes have weight 0.
  int add(Side& side, std::span<const float> q, int parent, int phase, bool is_end) {
    side.phases.push_back(phase);
    side.sample_counts.push_back(0);
    side.weights.add(is_end ? 1 : 0);
    return side.tree.add(q, parent);
  }

  /// Nodes sampled less often are more likely.
  int sample_node(Side& side) {
    const int node = side.weights.sample(rng_.uniform());
    const auto i = static_cast<std::size_t>(node);
    side.weights.set(i, 1.0 / (1 + 100 * ++side.sample_counts[i]));
    return node;
  }

  /// Extends a random node of `side` by a piece of the path, to a random target in a box around the
  /// piece's end, or to the other root. Returns the last node, or -1.
  int grow(Side& side, const Side& other) {
    const int node = sample_node(side);
    const int phase = side.phases[static_cast<std::size_t>(node)];
    const int last = other.phases[0];
    const int span = kLeastSpan + static_cast<int>(rng_.index(kMostSpan - kLeastSpan + 1));
    const int to = last > 0 ? std::min(phase + span, last) : std::max(phase - span, last);
    if (to == last) return extend(side, node, to, root(other));
    std::vector<float> target(side.tree[node].begin(), side.tree[node].end());
    const float share = static_cast<float>(std::abs(to - phase)) / kPhases;
    for (std::size_t j = 0; j < target.size(); ++j) {
      const float offset = share * reaches_[j] * static_cast<float>(rng_.uniform(-1, 1));
      target[j] = into_limits(j, target[j] + prior_.change(phase, to, j) + offset);
    }
    std::uint8_t is_valid = 0;
    run_.check_states(target, {&is_valid, 1});
    return is_valid != 0 ? extend(side, node, to, target) : -1;
  }

  [[nodiscard]] float into_limits(std::size_t joint, float value) const {
    return run_.space().into_limits(static_cast<int>(joint), value);
  }

  /// Adds the piece of the path from the phase of `node` to phase `to`, sheared to `target`, if all
  /// of it is free. Returns the last node, or -1.
  int extend(Side& side, int node, int to, std::span<const float> target) {
    const std::vector<float> from(side.tree[node].begin(), side.tree[node].end());
    const std::vector<float> end(target.begin(), target.end());
    const int phase = side.phases[static_cast<std::size_t>(node)];
    const int count = std::max(1, std::abs(to - phase));
    std::vector<float> moved(from.size()), shear(from.size());
    for (std::size_t j = 0; j < from.size(); ++j) moved[j] = from[j] + prior_.change(phase, to, j);
    run_.space().difference(moved.data(), end.data(), shear.data());
    FloatPath piece = {from};
    for (int i = 1; i <= count; ++i) {
      const int at = phase + (to - phase) * i / count;
      const float part = static_cast<float>(i) / static_cast<float>(count);
      std::vector<float> q(from.size());
      for (std::size_t j = 0; j < q.size(); ++j) {
        q[j] = into_limits(j, from[j] + prior_.change(phase, at, j) + part * shear[j]);
      }
      if (i == count) q = end;
      if (!run_.is_motion_valid(piece.back(), q)) return -1;
      piece.push_back(std::move(q));
    }
    for (int i = 1; i <= count; ++i) {
      node = add(side, piece[static_cast<std::size_t>(i)], node, phase + (to - phase) * i / count,
                 i == count);
    }
    return node;
  }

  /// True if the path over `end` and the coincident node `facing` of the other tree is free.
  bool is_solved_by(int end, const Side& other, int facing) {
    if (end < 0) return false;
    const Side& side = sides_[&other == &sides_[0] ? 1 : 0];
    FloatPath path = side.tree.path_to(end);
    FloatPath rest = other.tree.path_to(facing);
    rest.pop_back();
    path.insert(path.end(), rest.rbegin(), rest.rend());
    if (&side == &sides_[1]) std::ranges::reverse(path);
    return run_.find_invalid_motion(path) < 0;
  }

  PlannerRun& run_;
  PriorPath prior_;
  Rng rng_;
  std::vector<float> reaches_;  ///< kTube; half as many metres for prismatic joints
  std::array<Side, 2> sides_;   ///< from the start, from the goal
};

/// The remembered path with the most similar ends, from the start to a goal; a straight path if
/// there is none.
struct PriorRows {
  std::vector<float> rows;
  std::size_t goal = 0;
};

/// Reverses a path if it leads from goal to start: retrieval returns both directions.
void reverse_if_needed(const ResolvedQuery& resolved, PriorRows& path) {
  const Robot& robot = resolved.checker.robot();
  const auto joints = static_cast<std::ptrdiff_t>(robot.joint_count());
  const Configuration first(path.rows.begin(), path.rows.begin() + joints);
  const Configuration last(path.rows.end() - joints, path.rows.end());
  const Configuration &start = resolved.ends.start, &goal = resolved.ends.goals[path.goal];
  const bool is_forward = robot.distance(first, start) + robot.distance(last, goal) <=
                          robot.distance(last, start) + robot.distance(first, goal);
  if (is_forward) return;
  std::vector<float> turned;
  for (auto end = path.rows.end(); end != path.rows.begin(); end -= joints) {
    turned.insert(turned.end(), end - joints, end);
  }
  path.rows = std::move(turned);
}

Result<PriorRows> find_most_similar(const ResolvedQuery& resolved) {
  const Query& query = resolved.query;
  const MemoryQuery request = memory_query(query.problem, resolved.ends.start, resolved.ends.goals);
  PriorRows found;
  double least = std::numeric_limits<double>::infinity();
  for (const KindSettings& kind : query.kinds) {
    if (kind.kind->bend == nullptr) continue;
    const auto primitives = MNEME_TRY(decompose(request, kind));
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const auto matches = MNEME_TRY(
          find_matches(*query.database, *kind.kind, primitives[i].primitive, {.max_matches = 1}));
      if (matches.empty() || matches.front().similarity_error >= least) continue;
      const Match& match = matches.front();
      least = match.similarity_error;
      found = {match.experience->path().waypoints, i};
    }
  }
  if (!found.rows.empty()) {
    reverse_if_needed(resolved, found);
    return found;
  }
  for (const Configuration* q : {&resolved.ends.start, &resolved.ends.goals.front()}) {
    found.rows.insert(found.rows.end(), q->begin(), q->end());
  }
  return found;
}

PlanResult plan(const ResolvedQuery& resolved, const PriorRows& path) {
  PlanSettings settings = resolved.query.settings.plan;
  settings.timeout_s = resolved.query.remaining_s();
  PathFinisher finisher(resolved.checker, settings.finish());
  const Robot& robot = resolved.checker.robot();
  const auto sampler = make_uniform_sampler(robot);
  PlannerRun run({resolved.checker, resolved.ends, *sampler, settings, finisher});
  PriorPath prior(robot, path.rows, run.start(), run.goals()[path.goal]);
  return ErtConnect(run, std::move(prior), path.goal).solve();
}

}  // namespace

Result<SolveResult> solve_by_ert_connect(const Problem& problem, Database* database,
                                         const SolveSettings& settings) {
  const Stopwatch stopwatch;
  const Query query = MNEME_TRY(make_query(problem, database, with_own_planner(settings)));
  const ResolvedQuery resolved = MNEME_TRY(resolve_goals(query));
  SolveResult result = describe(resolved);
  if (resolved.refusal) {
    result.plan = *resolved.refusal;
  } else {
    const Stopwatch retrieval;
    const PriorRows path = MNEME_TRY(find_most_similar(resolved));
    result.gl.retrieval_time_s = retrieval.elapsed_s();
    result.plan = plan(resolved, path);
    result.plan.planning_time_s += result.gl.retrieval_time_s;
  }
  result.total_time_s = stopwatch.elapsed_s();
  return result;
}

}  // namespace mneme::internal

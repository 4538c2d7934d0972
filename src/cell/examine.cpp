// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/examine.h"

#include "mneme/path.h"
#include "mneme/planning.h"

#include "base/as_index.h"
#include "base/fail.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mneme::internal {
namespace {

/// Distances that plans try to keep, metres: paths in the open serve larger boxes.
constexpr std::array kClearances = {kWidestClearance, 0.01, 0.0033, 0.0};
constexpr int kOwnPath = -1;    ///< origin of a box whose path was planned for it
constexpr int kNeighbours = 6;  ///< paths of other boxes to bend
constexpr int kFresh = 6;       ///< paths to plan
constexpr int kSolutions = 10;  ///< of inverse kinematics, to rate
/// Random steps along the self-motion that a solution tries: the first one's length in radians, its
/// factor after a step that does not improve the solution, and the number of steps.
constexpr double kFirstStep = 0.3, kShorter = 0.85;
constexpr int kImprovements = 12;
constexpr std::uint64_t kPlanIterations = 4000;
constexpr double kNever = 1e6;  ///< seconds
/// Rating that a radian between start and goal costs: motions to far branches take longer.
constexpr double kDetour = 1.5;
/// Boxes of more than this share of the region leave out branches that are farther from the start
/// than the nearest one, by this factor and so many radians: near branches serve parts of the box.
constexpr double kLargeShare = 0.02, kFarther = 1.3, kLittleFarther = 0.3;
/// Branches closer than this are the same, radians.
constexpr double kSameBranch = 0.02, kSameSolution = 0.1;
/// Boxes of less than this share of the region get fewer seeds.
constexpr double kSmallShare = 1e-3;
constexpr int kSeeds = 384, kFewSeeds = 128;
/// Solutions of inverse kinematics to search for, and their least distance, radians.
constexpr int kFoundSolutions = 16;
constexpr double kApart = 0.3;
/// Error of a pose, metres, that counts as reached, and the most steps of Newton's method to it
/// from solutions of inverse kinematics and from steps along the self-motion.
constexpr double kReached = 1e-8;
constexpr int kSolutionSteps = 10, kImprovedSteps = 6;
/// Equal steps in which the goal of a neighbour's path is moved to the box.
constexpr int kNeighbourSteps = 4;
/// Tenths of the tasks not served yet in which a branch must keep the limits, at least: by its
/// model, and by its linear motion before the model is fitted.
constexpr std::size_t kUsefulTenths = 3, kMaybeUsefulTenths = 2;
/// Added to sums of displacements (metres) and to counts, so that nothing is divided by zero.
constexpr double kAboveZero = 1e-9;
/// Failures beyond this share of the path are at its goal, where no other profile helps.
constexpr double kAtGoal = 0.98;
/// Ratings that solutions gain by the clearance that they keep: one for each of kClearances.
constexpr std::array kBonus = {0.3, 0.15, 0.05, 0.0};

}  // namespace

/// One call of Examiner::examine().
class Examination {
 public:
  Examination(const Examiner& examiner, const OpenBox& open, const std::vector<CellBox>& known,
              const std::array<int, kBendProfiles>& order)
      : e_(examiner),
        open_(open),
        box_(open.tasks),
        known_(known),
        order_(order),
        seed_(derive_seed(examiner.seed_, static_cast<std::uint64_t>(open.node))),
        rng_(seed_) {
    for (const std::vector<double>& u : e_.fitter_->probes()) {
      tasks_.push_back(box_.at(e_.frame().varying(), u.data()));
    }
    is_needed_.assign(tasks_.size(), true);
    needed_ = tasks_.size();
  }

  Examined run() {
    for (const int above : open_.above) serve(known_[as_index(above)]);
    result_.is_served = needed_ == 0;
    if (result_.is_served) return std::move(result_);
    const BlockedLink::Vicinity vicinity = e_.blocked_->look_around(box_, e_.margin_);
    if (vicinity.blocked) {
      result_.is_blocked = true;
      result_.gap = CellGap::blocked;
      return std::move(result_);
    }
    drop_blocked(vicinity);
    const std::size_t before = needed_;
    // No proof of the whole box can succeed where the link is too close to contact in a part of it.
    if (result_.blocked_by) {
      result_.gap = CellGap::contact;
    } else {
      result_.is_served = try_neighbours() || (!is_too_large_ && try_fresh());
    }
    const auto share_of = [&](std::size_t count) {
      return static_cast<double>(count) / static_cast<double>(tasks_.size());
    };
    result_.gained = share_of(before - needed_);
    result_.left = share_of(needed_);
    if (result_.is_served) return std::move(result_);
    note_contrast();
    if (!result_.failure && tightest_ > 0) {
      std::ranges::copy(limit_blame_, result_.blame.begin());
    }
    return std::move(result_);
  }

 private:
  // Tasks that are served.

  void serve(const CellBox& box) {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (!is_needed_[i] || !serves(box, tasks_[i], e_.frame(), e_.chain())) continue;
      is_needed_[i] = false;
      --needed_;
    }
  }

  /// Samples whose link is too close to contact are not needed: nothing can serve them.
  void drop_blocked(const BlockedLink::Vicinity& vicinity) {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (!is_needed_[i]) continue;
      auto found = e_.blocked_->find(vicinity, tasks_[i], e_.margin_);
      if (!found) continue;
      is_needed_[i] = false;
      --needed_;
      result_.blocked_by = std::move(found);
    }
  }

  void note_contrast() {
    for (std::size_t k = 0; k < e_.frame().varying().size(); ++k) {
      double below = 0, above = 0, belows = kAboveZero, aboves = kAboveZero;
      for (std::size_t i = 0; i < tasks_.size(); ++i) {
        const bool is_below = e_.fitter_->probes()[i][k] < 0;
        (is_below ? belows : aboves) += 1;
        if (is_needed_[i]) (is_below ? below : above) += 1;
      }
      result_.contrast[k] = std::abs(below / belows - above / aboves);
    }
  }

  /// True if the branch keeps the limits in enough of the tasks that are not served yet.
  [[nodiscard]] bool is_useful(const Branch& branch, const GoalShift& shift) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const std::vector<double>& u = e_.fitter_->probes()[i];
      if (is_needed_[i] && e_.chain().keeps_limits(branch.q0 + evaluate(shift, u.data()))) ++count;
    }
    return 10 * count >= kUsefulTenths * needed_;
  }

  /// The same to first order, for a fraction of the cost of a fit.
  [[nodiscard]] bool may_be_useful(const Branch& branch) const {
    const Eigen::MatrixXd motion = e_.fitter_->slopes(box_, branch);
    std::size_t count = 0;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const std::vector<double>& u = e_.fitter_->probes()[i];
      const Eigen::Map<const Eigen::VectorXd> at(u.data(), motion.cols());
      const JointVector q = branch.q0 + motion * at;
      if (is_needed_[i] && e_.chain().keeps_limits(q)) ++count;
    }
    return 10 * count >= kMaybeUsefulTenths * needed_;
  }

  // One branch.

  /// True if the branch has a model that is worth a proof.
  bool fit(const Branch& branch, GoalShift& shift) {
    FitFault fault = FitFault::limits;
    if (may_be_useful(branch)) fault = e_.fitter_->fit(box_, branch, shift);
    if (fault == FitFault::none && !is_useful(branch, shift)) fault = FitFault::limits;
    if (fault == FitFault::none) return true;
    const bool is_limit = fault == FitFault::limits;
    if (!result_.failure) result_.gap = is_limit ? CellGap::limits : CellGap::bends;
    if (is_limit) blame_limits(branch);
    return false;
  }

  /// Notes which parameters move the joint that is nearest to its limit.
  void blame_limits(const Branch& branch) {
    const Eigen::MatrixXd motion = e_.fitter_->slopes(box_, branch);
    const LimitSlack slack = e_.fitter_->slack(branch.q0, motion);
    if (slack.ratio <= tightest_) return;
    tightest_ = slack.ratio;
    for (Eigen::Index k = 0; k < motion.cols(); ++k) {
      limit_blame_[static_cast<std::size_t>(k)] = std::abs(motion(slack.joint, k));
    }
  }

  void blame(const ProofFailure& failure) {
    double sum = kAboveZero;
    for (std::size_t k = 0; k < kMostParameters; ++k) sum += failure.displacements[k + 1];
    for (std::size_t k = 0; k < kMostParameters; ++k) {
      result_.blame[k] += failure.displacements[k + 1] / sum;
    }
    result_.gap = failure.is_over_budget ? CellGap::budget : CellGap::contact;
    result_.failure = failure;
  }

  [[nodiscard]] ProofSettings proof_settings() const {
    ProofSettings settings;
    settings.margin = static_cast<float>(e_.margin_);
    settings.seed = seed_;
    return settings;
  }

  /// Proves that the goals are free, whatever the path: most proofs fail there.
  bool prove_goal(const Branch& branch, const GoalShift& shift) {
    BentPath goal;
    for (int end = 0; end < 2; ++end) {
      for (const double value : branch.q0) goal.rows.push_back(static_cast<float>(value));
      goal.shares.push_back(1);
    }
    ProofFailure failure;
    CheckCounters counters;
    if (prove(e_.levels_.back().checker, goal, shift, proof_settings(), failure, counters)) {
      return true;
    }
    failure.along = 1;
    blame(failure);
    is_too_large_ = failure.is_over_budget;
    return false;
  }

  /// Tries to prove one path over the box. True if all tasks are served then.
  bool prove_path(const JointPath& path, const GoalShift& shift, int origin) {
    const JointPath parts = with_short_turns(path, e_.chain());
    for (const int profile : order_) {
      const BentPath bent = bend(parts, profile);
      ProofFailure failure;
      CheckCounters counters;
      if (prove(e_.levels_.back().checker, bent, shift, proof_settings(), failure, counters)) {
        result_.boxes.push_back({box_, bent, shift, origin, true});
        result_.profiles.push_back(profile);
        serve(result_.boxes.back());
        return needed_ == 0;
      }
      blame(failure);
      is_too_large_ = failure.is_over_budget;
      // No profile helps at the goal; a proof that takes too long takes a smaller box.
      if (failure.along > kAtGoal || failure.is_over_budget) break;
    }
    return false;
  }

  // Paths of other boxes.

  bool try_neighbours() {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t i = 0; i < known_.size(); ++i) near.emplace_back(distance_to(known_[i]), i);
    const std::size_t count = std::min<std::size_t>(near.size(), 3 * kNeighbours);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    int tried = 0;
    std::vector<JointVector> seen;
    for (std::size_t i = 0; i < count && tried < kNeighbours; ++i) {
      const CellBox& box = known_[near[i].second];
      JointVector q = box.path.goal();
      if (!follow(e_.chain(), e_.frame(), box.tasks.center, box_.center, kNeighbourSteps, q))
        continue;
      if (!is_shortest_turn(q)) continue;
      if (is_among(seen, q, kSameBranch)) continue;
      seen.push_back(q);
      ++tried;
      if (try_neighbour(box, q)) return true;
      if (is_too_large_) return false;
    }
    return false;
  }

  bool try_neighbour(const CellBox& box, const JointVector& q) {
    const Branch branch = make_branch(e_.chain(), q);
    GoalShift shift;
    if (!fit(branch, shift)) return false;
    JointPath path;
    for (std::size_t i = 0; i < box.path.size(); ++i) {
      path.push_back(box.path.waypoint(i, branch.q0 - box.path.goal()));
    }
    path.back() = branch.q0;
    return prove_path(without_straights(path), shift, box.origin);
  }

  /// False if a whole turn of a continuous joint would bring `q` nearer to the start.
  [[nodiscard]] bool is_shortest_turn(const JointVector& q) const {
    for (int j = 0; j < e_.chain().joint_count(); ++j) {
      const double turn = q[j] - e_.start_[as_index(j)];
      if (e_.chain().wraps(j) && std::abs(turn) > std::numbers::pi) return false;
    }
    return true;
  }

  [[nodiscard]] double distance_to(const CellBox& box) const {
    double sum = 0;
    for (const int k : e_.frame().varying()) {
      const auto i = as_index(k);
      const double off = (box.tasks.center[i] - box_.center[i]) / e_.frame().half_extents()[i];
      sum += off * off;
    }
    return sum;
  }

  static bool is_among(const std::vector<JointVector>& list, const JointVector& q, double apart) {
    return std::ranges::any_of(list, [&](const auto& other) { return (other - q).norm() < apart; });
  }

  // New paths.

  struct Candidate {
    double rating = 0;
    JointVector q;
    std::size_t level = 0;  ///< the widest clearance that it keeps
  };

  bool try_fresh() {
    const std::vector<Candidate> candidates = find_candidates();
    if (candidates.empty() && !result_.failure) result_.gap = CellGap::unreachable;
    int tried = 0;
    std::vector<JointVector> seen;
    for (const Candidate& candidate : candidates) {
      if (tried >= kFresh) break;
      if (is_among(seen, candidate.q, kSameSolution)) continue;
      seen.push_back(candidate.q);
      GoalShift shift;
      const Branch branch = make_branch(e_.chain(), candidate.q);
      if (!fit(branch, shift) || !prove_goal(branch, shift)) {
        if (is_too_large_) return false;
        continue;
      }
      ++tried;
      if (try_candidate(candidate)) return true;
      if (is_too_large_) return false;
    }
    return false;
  }

  bool try_candidate(const Candidate& candidate) {
    const std::optional<JointPath> path = plan(candidate);
    if (!path) {
      if (!result_.failure) result_.gap = CellGap::no_path;
      return false;
    }
    // The plan may end at another turn of continuous joints.
    const Branch branch = make_branch(e_.chain(), path->back());
    GoalShift shift;
    if (!fit(branch, shift)) return false;
    return prove_path(*path, shift, kOwnPath);
  }

  std::vector<Candidate> find_candidates() {
    PoseGoal goal;
    goal.link = e_.link_;
    goal.pose = e_.frame().pose(box_.center);
    IkSettings settings;
    settings.seeds = open_.share < kSmallShare ? kFewSeeds : kSeeds;
    settings.solutions = kFoundSolutions;
    settings.apart = kApart;
    settings.seed = rng_.next();
    const IkResult found =
        e_.kinematics_->solve(goal, e_.start_, settings, &e_.levels_.back().checker, e_.margin_);
    std::vector<Candidate> candidates;
    for (const Configuration& solution : found.solutions) {
      JointVector q = to_vector(solution);
      if (!e_.chain().reach(goal.pose, e_.chain().response(q), kSolutionSteps, kReached, q))
        continue;
      if (e_.chain().keeps_limits(q)) candidates.push_back({rate(q), q, 0});
    }
    const auto is_better = [](const Candidate& a, const Candidate& b) {
      return a.rating > b.rating;
    };
    std::ranges::stable_sort(candidates, is_better);
    if (candidates.size() > kSolutions) candidates.resize(kSolutions);
    for (Candidate& candidate : candidates) improve(goal.pose, candidate);
    if (open_.share > kLargeShare) drop_far(candidates);
    std::ranges::stable_sort(candidates, is_better);
    return candidates;
  }

  [[nodiscard]] double distance_from_start(const JointVector& q) const {
    return (q - to_vector(e_.start_)).norm();
  }

  /// Larger is better.
  [[nodiscard]] double rate(const JointVector& q) const {
    return e_.fitter_->rate(box_, q) - kDetour * distance_from_start(q);
  }

  void drop_far(std::vector<Candidate>& candidates) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates) {
      nearest = std::min(nearest, distance_from_start(candidate.q));
    }
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return distance_from_start(candidate.q) > kFarther * nearest + kLittleFarther;
    });
  }

  [[nodiscard]] bool is_clear(const JointVector& q, std::size_t level) const {
    return e_.levels_[level].checker.is_valid(to_configuration(q));
  }

  /// Moves a solution along its self-motion to where the box needs less room.
  void improve(const Transform& pose, Candidate& candidate) {
    while (candidate.level + 1 < e_.levels_.size() && !is_clear(candidate.q, candidate.level)) {
      ++candidate.level;
    }
    double step = kFirstStep;
    for (int i = 0; i < kImprovements; ++i) {
      Jacobian jacobian;
      (void)e_.chain().place(candidate.q, &jacobian);
      const Response response = e_.chain().response(candidate.q);
      JointVector along(e_.chain().joint_count());
      for (double& value : along) value = step * rng_.normal();
      along -= response * (jacobian * along);
      JointVector q = candidate.q + along;
      step *= kShorter;
      if (!e_.chain().reach(pose, response, kImprovedSteps, kReached, q) ||
          !e_.chain().keeps_limits(q))
        continue;
      const double rating = rate(q);
      if (rating <= candidate.rating || !is_clear(q, candidate.level)) continue;
      candidate.q = q;
      candidate.rating = rating;
      step /= kShorter;
    }
    candidate.rating += kBonus[candidate.level];
  }

  std::optional<JointPath> plan(const Candidate& candidate) {
    const PlanQuery query{e_.start_, {to_configuration(candidate.q)}};
    PlanSettings settings;
    settings.seed = rng_.next() & 0xffff;
    settings.max_iterations = kPlanIterations;
    settings.timeout_s = kNever;  // time must not decide
    for (std::size_t level = candidate.level; level < e_.levels_.size(); ++level) {
      const CollisionChecker& checker = e_.levels_[level].checker;
      const PlanResult planned = plan_with(rrt_connect, checker, query, *e_.sampler_, settings);
      if (!planned.is_solved()) continue;
      // Planners wrap continuous joints, and boxes move them straight from row to row.
      JointPath path;
      const Robot& robot = checker.robot();
      for (const Configuration& q : unwrapped(robot, planned.path, e_.start_)) {
        path.push_back(to_vector(q));
      }
      return path;
    }
    return std::nullopt;
  }

  const Examiner& e_;
  const OpenBox& open_;
  const TaskBox& box_;
  const std::vector<CellBox>& known_;
  const std::array<int, kBendProfiles>& order_;
  std::uint64_t seed_;
  Rng rng_;
  std::vector<CellTask> tasks_;  ///< samples
  std::vector<bool> is_needed_;  ///< per sample
  std::size_t needed_ = 0;
  bool is_too_large_ = false;  ///< a proof took too long: smaller boxes will be cheaper
  double tightest_ = 0;
  std::array<double, kMostParameters> limit_blame_ = {};
  Examined result_;
};

Result<Examiner> Examiner::make(const CellRegion& region, const CellStart& start,
                                const CellSettings& settings) {
  Examiner examiner;
  const Robot& robot = region.problem.robot;
  examiner.link_ = region.middle().link;
  examiner.start_ = start.q;
  examiner.margin_ = settings.margin;
  examiner.seed_ = settings.seed;
  examiner.chain_ =
      std::make_unique<const LinkChain>(MNEME_TRY(LinkChain::make(robot, examiner.link_)));
  examiner.frame_ = std::make_unique<const TaskFrame>(region);
  examiner.fitter_ = std::make_unique<const BranchFitter>(*examiner.chain_, *examiner.frame_);
  examiner.kinematics_ = std::make_unique<const InverseKinematics>(
      MNEME_TRY(InverseKinematics::make(robot, examiner.link_)));
  examiner.sampler_ = make_uniform_sampler(robot);
  examiner.blocked_ = std::make_unique<const BlockedLink>(region, *examiner.frame_);
  for (const double clearance : kClearances) {
    CheckerSettings checker;
    checker.margin = clearance;
    examiner.levels_.push_back(
        {clearance, MNEME_TRY(CollisionChecker::make(robot, region.problem.scene, checker))});
  }
  return examiner;
}

Examined Examiner::examine(const OpenBox& box, const std::vector<CellBox>& known,
                           const std::array<int, kBendProfiles>& order) const {
  return Examination(*this, box, known, order).run();
}

void Examiner::describe(const ProofFailure& failure, UnprovenBox& box) const {
  internal::describe(levels_.front().checker, failure, box);
}

void describe(const CollisionChecker& wide, const ProofFailure& failure, UnprovenBox& box) {
  box.along = failure.along;
  const Configuration q = to_configuration(failure.q);
  const std::vector<Contact> contacts = wide.contacts(q);
  if (contacts.empty()) return;
  const Contact& nearest = *std::ranges::min_element(contacts, {}, &Contact::distance);
  box.first = nearest.link;
  box.other = nearest.other;
}

bool serves(const CellBox& box, const CellTask& task, const TaskFrame& frame,
            const LinkChain& chain) {
  if (!box.tasks.contains(task)) return false;
  const auto u = box.tasks.place_of(frame.varying(), task);
  const JointVector change = evaluate(box.shift, u.data());
  if (!takes_nearest_turns(box.path, chain, box.path.goal() + change)) return false;
  JointVector before = box.path.waypoint(0);
  for (std::size_t waypoint = 1; waypoint < box.path.size(); ++waypoint) {
    const JointVector q = box.path.waypoint(waypoint, change);
    if (!chain.keeps_limits(q) || !has_unique_turns(chain, before, q)) return false;
    before = q;
  }
  return true;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bent_path/bent_path.h"

#include "base/as_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

/// Shares of the path's length at its end that bend in full, and before these, that bend more and
/// more.
struct Profile {
  double full = 0, ramp = 0;
};
constexpr std::array<Profile, kBendProfiles> kProfiles = {
    {{0, 1}, {0, 0.6}, {0, 0.35}, {0.15, 0.4}, {0.3, 0.6}, {0.1, 0.2}}};
/// Waypoints closer than this to another are not added, radians.
constexpr double kLeastStretch = 1e-3;
/// Waypoints this close to the straight motion past them are dropped, radians.
constexpr double kStraight = 0.02;

void insert_at(double length, JointPath& path) {
  const std::vector<double> lengths = arc_lengths(path);
  for (std::size_t i = 1; i < lengths.size(); ++i) {
    if (length <= lengths[i - 1] + kLeastStretch || length >= lengths[i] - kLeastStretch) continue;
    const double share = (length - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
    const JointVector between = path[i - 1] + share * (path[i] - path[i - 1]);
    path.insert(path.begin() + static_cast<std::ptrdiff_t>(i), between);
    return;
  }
}

}  // namespace

JointVector evaluate(const GoalShift& shift, const double* u) {
  const auto joints = static_cast<Eigen::Index>(shift.constant.size());
  using Row = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 1>>;
  JointVector value = Row(shift.constant.data(), joints).cast<double>();
  for (int k = 0; k < shift.parameters; ++k) {
    JointVector slope = Row(shift.slopes.data() + k * joints, joints).cast<double>();
    for (int l = 0; l < shift.parameters; ++l) {
      const float* row = shift.curvatures.data() + (k * shift.parameters + l) * joints;
      slope += 0.5 * u[l] * Row(row, joints).cast<double>();
    }
    value += u[k] * slope;
  }
  return value;
}

std::vector<double> arc_lengths(const JointPath& path) {
  std::vector<double> lengths = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    lengths.push_back(lengths.back() + (path[i] - path[i - 1]).norm());
  }
  return lengths;
}

JointPath without_straights(const JointPath& path) {
  JointPath kept = {path.front()};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const JointVector chord = path[i + 1] - kept.back(), to = path[i] - kept.back();
    const double t = std::clamp(to.dot(chord) / std::max(chord.squaredNorm(), 1e-12), 0.0, 1.0);
    if ((to - t * chord).norm() > kStraight) kept.push_back(path[i]);
  }
  kept.push_back(path.back());
  return kept;
}

bool has_unique_turns(const LinkChain& chain, const JointVector& from, const JointVector& to) {
  constexpr double kMostTurn = std::numbers::pi - 1e-3;
  for (int j = 0; j < chain.joint_count(); ++j) {
    if (chain.wraps(j) && !(std::abs(to[j] - from[j]) <= kMostTurn)) return false;
  }
  return true;
}

bool takes_nearest_turns(const BentPath& path, const LinkChain& chain, const JointVector& goal) {
  // Boxes on both sides of half a turn overlap, or cuts would have to find the place.
  constexpr double kOverlap = 0.1;
  const std::span<const float> start = path.row(0), middle = path.row(path.size() - 1);
  for (int j = 0; j < chain.joint_count(); ++j) {
    if (!chain.wraps(j)) continue;
    const auto at = as_index(j);
    const double usual = std::abs(double{middle[at]} - double{start[at]});
    const double turn = std::abs(goal[j] - double{start[at]});
    if (turn > std::numbers::pi + kOverlap && usual <= std::numbers::pi) return false;
  }
  return true;
}

JointPath with_short_turns(const JointPath& path, const LinkChain& chain) {
  constexpr double kFar = 1.5;
  JointPath parts = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    double most = 0;
    for (int j = 0; j < chain.joint_count(); ++j) {
      if (chain.wraps(j)) most = std::max(most, std::abs(path[i][j] - path[i - 1][j]));
    }
    if (most > kFar) parts.emplace_back(0.5 * (path[i - 1] + path[i]));
    parts.push_back(path[i]);
  }
  return parts;
}

BentPath bend(JointPath path, int profile) {
  const Profile& shape = kProfiles.at(as_index(profile));
  const double length = arc_lengths(path).back();
  const double begin = length * std::max(0.0, 1 - shape.full - shape.ramp);
  const double end = length * (1 - shape.full);
  insert_at(begin, path);
  insert_at(end, path);
  BentPath bent;
  for (const double at : arc_lengths(path)) {
    const double share = std::clamp((at - begin) / std::max(end - begin, 1e-9), 0.0, 1.0);
    bent.shares.push_back(rounded(share, kPathStep));
  }
  bent.shares.front() = 0;
  bent.shares.back() = 1;
  for (const double value : path.front()) bent.rows.push_back(static_cast<float>(value));
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (const double value : path[i]) bent.rows.push_back(rounded(value, kPathStep));
  }
  return bent;
}

namespace {

constexpr std::size_t kBatch = 16;
/// Boxes in which nothing moves farther than this, metres, are not cut: too close to contact.
constexpr float kFinestBox = 5e-4f;
/// First boxes: shares of the bend, and radians of the motion.
constexpr double kFirstBend = 0.5, kFirstMotion = 0.25;

/// One call of prove().
class Prover {
 public:
  Prover(const CollisionChecker& checker, const BentPath& path, const GoalShift& shift,
         const ProofSettings& settings, ProofFailure& failure, CheckCounters& counters)
      : checker_(checker),
        path_(path),
        shift_(shift),
        settings_(settings),
        failure_(failure),
        counters_(counters),
        first_states_(counters.states),
        rng_(settings.seed) {}

  bool run() {
    // States at which bent paths are blocked most often decide cheaply, from the goal back.
    for (int round = 0; round < 3 && settings_.has_trials; ++round) {
      for (std::size_t i = path_.size() - 1; i > 0; --i) {
        if ((round == 0 || is_bent(i)) && !try_states(i, round == 0)) return false;
      }
    }
    for (std::size_t i = path_.size() - 1; i > 0; --i) {
      if (!prove_motion(i)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] std::size_t parameters() const { return as_index(shift_.parameters); }
  /// Motion i goes from waypoint i - 1 to waypoint i.
  [[nodiscard]] FamilyMotion motion(std::size_t i) const {
    return {&shift_, path_.row(i - 1), path_.row(i), path_.shares[i - 1], path_.shares[i]};
  }
  [[nodiscard]] bool is_bent(std::size_t i) const {
    return path_.shares[i - 1] > 0 || path_.shares[i] > 0;
  }

  /// Checks single states of motion i: at corners of the box at its end, or at random.
  bool try_states(std::size_t i, bool is_corner) {
    std::array<FamilyBox, kBatch> boxes;
    for (std::size_t lane = 0; lane < kBatch; ++lane) {
      const bool is_extreme = is_corner || lane % 2 == 1;
      boxes[lane].time = is_corner ? 1.0f : static_cast<float>(rng_.uniform());
      for (std::size_t k = 0; k < parameters(); ++k) {
        const bool is_high = is_corner ? (lane >> k & 1) != 0 : rng_.uniform() > 0.5;
        boxes[lane].at[k] =
            is_extreme ? (is_high ? 1.0f : -1.0f) : static_cast<float>(rng_.uniform(-1, 1));
      }
    }
    check(i, boxes);
    for (std::size_t lane = 0; lane < kBatch; ++lane) {
      if (!verdicts_[lane].is_free) return fail(i, boxes[lane], verdicts_[lane]);
    }
    return true;
  }

  void check(std::size_t i, std::span<const FamilyBox> boxes) {
    checker_.check_family(motion(i), boxes, settings_.margin, {verdicts_.data(), boxes.size()},
                          counters_, settings_.has_links);
  }

  bool fail(std::size_t i, const FamilyBox& box, const FamilyVerdict& verdict) {
    std::array<double, kMostParameters> u;
    std::ranges::copy(box.at, u.begin());
    const double share =
        path_.shares[i - 1] + double{box.time} * (path_.shares[i] - path_.shares[i - 1]);
    const JointVector from = path_.waypoint(i - 1), to = path_.waypoint(i);
    failure_.q = from + double{box.time} * (to - from) + share * evaluate(shift_, u.data());
    failure_.along =
        (static_cast<double>(i - 1) + double{box.time}) / static_cast<double>(path_.size() - 1);
    failure_.displacements = verdict.towards;
    return false;
  }

  bool prove_motion(std::size_t i) {
    push_first(i);
    std::array<FamilyBox, kBatch> boxes;
    while (!open_.empty()) {
      const std::size_t count = std::min(kBatch, open_.size());
      for (std::size_t k = 0; k < count; ++k) {
        boxes[k] = open_.back();
        open_.pop_back();
      }
      check(i, {boxes.data(), count});
      for (std::size_t k = 0; k < count; ++k) {
        if (verdicts_[k].is_free) continue;
        if (verdicts_[k].is_in_contact || linear(verdicts_[k]) < kFinestBox) {
          return fail(i, boxes[k], verdicts_[k]);
        }
        cut(boxes[k], verdicts_[k]);
      }
      if (counters_.states - first_states_ > settings_.most_states) {
        failure_.is_over_budget = true;
        return fail(i, boxes.front(), verdicts_.front());
      }
    }
    return true;
  }

  void push_first(std::size_t i) {
    const double turn = (path_.waypoint(i) - path_.waypoint(i - 1)).norm();
    const double bent = std::abs(path_.shares[i] - path_.shares[i - 1]);
    const int parts = std::max(static_cast<int>(std::ceil(bent / kFirstBend)),
                               1 + static_cast<int>(turn / kFirstMotion));
    for (int part = 0; part < parts; ++part) {
      FamilyBox box;
      box.half_time = 0.5f / static_cast<float>(parts);
      box.time = (static_cast<float>(part) + 0.5f) / static_cast<float>(parts);
      for (std::size_t k = 0; k < parameters() && is_bent(i); ++k) box.half[k] = 1;
      open_.push_back(box);
    }
  }

  /// Cuts a box across the direction in which most of the displacement is.
  void cut(const FamilyBox& box, const FamilyVerdict& verdict) {
    // What is bent shrinks with each direction's displacement.
    const float bent = verdict.bent / std::max(linear(verdict), 1e-9f);
    std::size_t k = 0;
    float most = -1;
    for (std::size_t i = 0; i < verdict.towards.size(); ++i) {
      const float gain = verdict.towards[i] + bent * verdict.displacements[i];
      if (gain <= most) continue;
      most = gain;
      k = i;
    }
    FamilyBox below = box, above = box;
    if (k == 0) {
      below.half_time = above.half_time = 0.5f * box.half_time;
      below.time -= below.half_time;
      above.time += above.half_time;
    } else {
      below.half[k - 1] = above.half[k - 1] = 0.5f * box.half[k - 1];
      below.at[k - 1] -= below.half[k - 1];
      above.at[k - 1] += above.half[k - 1];
    }
    open_.push_back(below);
    open_.push_back(above);
  }

  /// The part of a displacement that cutting a box makes less.
  static float linear(const FamilyVerdict& verdict) {
    float sum = 0;
    for (const float each : verdict.displacements) sum += each;
    return sum;
  }

  const CollisionChecker& checker_;
  const BentPath& path_;
  const GoalShift& shift_;
  const ProofSettings& settings_;
  ProofFailure& failure_;
  CheckCounters& counters_;
  std::uint64_t first_states_;
  Rng rng_;
  std::array<FamilyVerdict, kBatch> verdicts_;
  std::vector<FamilyBox> open_;
};

}  // namespace

bool prove(const CollisionChecker& checker, const BentPath& path, const GoalShift& shift,
           const ProofSettings& settings, ProofFailure& failure, CheckCounters& counters) {
  return Prover(checker, path, shift, settings, failure, counters).run();
}

}  // namespace mneme::internal

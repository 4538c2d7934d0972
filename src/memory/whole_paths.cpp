// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "path/waypoints.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace mneme {
namespace {

constexpr std::string_view kWholePathsVersion = "paths/1";

bool is_continuous(const Robot& robot, int joint) {
  return robot.group_joint(joint).type == JointType::continuous;
}

void append(const Robot& robot, std::span<const double> q, PrimitiveKey& key) {
  for (int i = 0; i < robot.joint_count(); ++i) {
    const double value = q[static_cast<std::size_t>(i)];
    if (is_continuous(robot, i)) {
      key.insert(key.end(), {std::cos(value), std::sin(value)});
    } else {
      key.push_back(value);
    }
  }
}

/// The same for any order of the constraints; 0 without any.
std::uint64_t hash_of(std::span<const OrientationConstraint> constraints) {
  std::uint64_t all = 0;
  for (const OrientationConstraint& constraint : constraints) {
    std::uint64_t one = 0;
    for (const char c : constraint.link) one = derive_seed(one, static_cast<std::uint64_t>(c));
    const Vec3 &axis = constraint.axis, &up = constraint.up;
    for (const double number :
         {axis.x(), axis.y(), axis.z(), up.x(), up.y(), up.z(), constraint.angle}) {
      // Adding 0 turns -0 into 0.
      one = derive_seed(one, std::bit_cast<std::uint64_t>(number + 0.0));
    }
    all += one;
  }
  return all;
}

}  // namespace

int query_key_size(const Robot& robot) {
  int end_size = 0;
  for (int i = 0; i < robot.joint_count(); ++i) end_size += is_continuous(robot, i) ? 2 : 1;
  return 1 + 2 * end_size;
}

LocalPrimitive make_query_primitive(const Robot& robot, std::span<const double> start,
                                    std::span<const double> goal,
                                    std::span<const OrientationConstraint> constraints) {
  LocalPrimitive primitive;
  primitive.kind = kWholePathsVersion;
  primitive.is_whole_query = true;
  PrimitiveKey& key = primitive.key;
  key.push_back(0);
  append(robot, start, key);
  const std::size_t end_size = key.size() - 1;
  append(robot, goal, key);
  double sum = 0;
  for (std::size_t i = 1; i <= end_size; ++i) sum += std::pow(key[i + end_size] - key[i], 2);
  key[0] = std::sqrt(sum);
  primitive.constraints = hash_of(constraints);
  return primitive;
}

namespace internal {
namespace {

/// Deforms remembered paths so that their ends match the query's: each waypoint is shifted by the
/// ends' offsets, weighted by the waypoint's arc length from the ends. Paths that match better in
/// reverse are reversed.
class PathWarper {
 public:
  PathWarper(const Robot& robot, std::span<const double> start, std::span<const double> goal)
      : space_(robot),
        joints_(static_cast<std::size_t>(robot.joint_count())),
        start_(start.begin(), start.end()),
        goal_(goal.begin(), goal.end()),
        start_shift_(joints_),
        goal_shift_(joints_),
        delta_(joints_),
        at_(joints_) {}

  /// Adds the waypoints between the ends, each twice: shifted in proportion, and unchanged.
  void add(std::span<const float> path, std::vector<float>& means) {
    const std::size_t count = path.size() / joints_;
    if (count < 3) return;
    measure(path, count);
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const float* q = path.data() + i * joints_;
      means.resize(means.size() + joints_);
      const float fraction = lengths_[i] / lengths_.back();
      write_bent(q, 1 - fraction, fraction, means.data() + means.size() - joints_);
      means.insert(means.end(), q, q + joints_);
    }
  }

  /// The whole path from the query's start to its goal. Beyond kRunPerShift times an end's shift
  /// the path is unchanged: near obstacles only the stored path is known to be free.
  std::vector<std::vector<float>> bend(std::span<const float> path) {
    const std::size_t count = path.size() / joints_;
    const bool is_reversed = measure(path, count);
    const float length = lengths_.back();
    const float start_run = run_of(start_off_), goal_run = run_of(goal_off_);
    std::vector<float> arc_lengths = lengths_;
    for (const float arc_length : {start_run, length - goal_run}) {
      if (arc_length > kLeastLength && arc_length < length - kLeastLength)
        arc_lengths.push_back(arc_length);
    }
    std::ranges::sort(arc_lengths);
    std::vector<std::vector<float>> bent;
    for (const float arc_length : arc_lengths) {
      write_at(path, arc_length, at_.data());
      write_bent(at_.data(), std::max(0.0f, 1 - arc_length / start_run),
                 std::max(0.0f, 1 - (length - arc_length) / goal_run),
                 bent.emplace_back(joints_).data());
    }
    if (is_reversed) std::ranges::reverse(bent);
    return bent;
  }

 private:
  float run_of(float shift) const {
    return std::clamp(kRunPerShift * shift, kLeastLength, lengths_.back());
  }

  /// The configuration at arc length `arc_length` from the path's start.
  void write_at(std::span<const float> path, float arc_length, float* q) {
    const auto next = std::ranges::upper_bound(lengths_, arc_length);
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(next - lengths_.begin()),
                                         lengths_.size() - 1) -
                   1;
    const float* from = path.data() + i * joints_;
    space_.difference(from, from + joints_, delta_.data());
    const float length = lengths_[i + 1] - lengths_[i];
    const float part = length > 0 ? (arc_length - lengths_[i]) / length : 0;
    for (std::size_t j = 0; j < joints_; ++j) q[j] = from[j] + part * delta_[j];
  }

  void write_bent(const float* q, float start_part, float goal_part, float* bent) const {
    for (std::size_t j = 0; j < joints_; ++j) {
      const float shift = goal_part * goal_shift_[j] + start_part * start_shift_[j];
      bent[j] = space_.into_limits(static_cast<int>(j), q[j] + shift);
    }
  }

  float distance(const float* a, const std::vector<float>& b) {
    return space_.difference(a, b.data(), delta_.data());
  }

  /// Computes the ends' shifts and each waypoint's arc length. Returns true if the path leads from
  /// the goal to the start.
  bool measure(std::span<const float> path, std::size_t count) {
    const float* first = path.data();
    const float* last = path.data() + (count - 1) * joints_;
    const bool is_reversed = distance(first, goal_) + distance(last, start_) <
                             distance(first, start_) + distance(last, goal_);
    start_off_ =
        space_.difference(first, (is_reversed ? goal_ : start_).data(), start_shift_.data());
    goal_off_ = space_.difference(last, (is_reversed ? start_ : goal_).data(), goal_shift_.data());
    lengths_.assign(count, 0);
    for (std::size_t i = 1; i < count; ++i) {
      const float* q = path.data() + i * joints_;
      lengths_[i] = lengths_[i - 1] + space_.difference(q - joints_, q, delta_.data());
    }
    lengths_.back() = std::max(lengths_.back(), kLeastLength);
    return is_reversed;
  }

  static constexpr float kLeastLength = 1e-6f;
  /// Smaller values make sharper corners.
  static constexpr float kRunPerShift = 2;
  JointSpace space_;
  std::size_t joints_;
  std::vector<float> start_, goal_, start_shift_, goal_shift_, delta_, at_, lengths_;
  float start_off_ = 0, goal_off_ = 0;  ///< lengths of the shifts
};

Result<std::vector<LocalPrimitive>> find_queries(const MemoryQuery& query, double) {
  if (query.start == nullptr) {
    return fail(ErrorCode::invalid, "scene '" + query.scene.name +
                                        "': memory of whole paths needs a problem with start and "
                                        "goal");
  }
  std::vector<LocalPrimitive> queries;
  auto violation = query.robot.describe_violation(*query.start, "start");
  for (const Configuration& goal : query.goals) {
    if (!violation) violation = query.robot.describe_violation(goal, "goal");
    if (violation) return fail(ErrorCode::invalid, *violation);
    queries.push_back(make_query_primitive(query.robot, *query.start, goal, query.constraints));
  }
  return queries;
}

/// The query and its reverse.
std::vector<KeyImage> images_of_query(const PrimitiveKey& canonical) {
  PrimitiveKey reversed = canonical;
  const auto ends = reversed.begin() + 1;
  std::rotate(ends, ends + (reversed.end() - ends) / 2, reversed.end());
  return {{canonical, false}, {std::move(reversed), false}};
}

/// `retrievals` has one entry per goal, in their order.
GaussianMixture warp_paths(const MemoryQuery& query,
                           std::span<const PrimitiveRetrieval> retrievals) {
  GaussianMixture mixture;
  mixture.joint_count = query.robot.joint_count();
  std::size_t size = 0;
  for (const PrimitiveRetrieval& retrieval : retrievals) {
    for (const Match& match : retrieval.matches) {
      size += 2 * match.experience->path().waypoints.size();
    }
  }
  mixture.means.reserve(size);
  mixture.sources.reserve(size / static_cast<std::size_t>(query.robot.joint_count()));
  for (std::size_t i = 0; i < retrievals.size(); ++i) {
    PathWarper warper(query.robot, *query.start, query.goals[i]);
    for (const Match& match : retrievals[i].matches) {
      warper.add(match.experience->path().waypoints, mixture.means);
    }
    mixture.sources.resize(static_cast<std::size_t>(mixture.component_count()),
                           static_cast<SampleSource>(i));
  }
  return mixture;
}

Path bend_path(const MemoryQuery& query, const Configuration& goal, const Experience& row) {
  if (row.path().waypoint_count() < 2) return {};
  const Robot& robot = query.robot;
  Path path = to_path(robot, PathWarper(robot, *query.start, goal).bend(row.path().waypoints));
  path.front() = robot.normalized(*query.start);
  path.back() = robot.normalized(goal);
  return path;
}

/// One row per path that is not empty: the key of its ends, and all its waypoints in order.
Result<std::vector<Experience>> remember_paths(const MemoryQuery& query,
                                               std::span<const Path> paths, double, double) {
  std::vector<Experience> rows;
  for (const Path& path : paths) {
    if (path.empty()) continue;
    Experience& row = rows.emplace_back();
    row.kind = kWholePathsVersion;
    LocalPrimitive primitive =
        make_query_primitive(query.robot, path.front(), path.back(), query.constraints);
    row.key = std::move(primitive.key);
    RememberedPath& remembered = row.content.emplace<RememberedPath>();
    remembered.joint_count = query.robot.joint_count();
    remembered.constraints = primitive.constraints;
    for (const Configuration& q : path) {
      remembered.waypoints.insert(remembered.waypoints.end(), q.begin(), q.end());
    }
  }
  return rows;
}

}  // namespace

extern constinit const MemoryKind kWholePaths = {
    .name = "paths",
    .version = kWholePathsVersion,
    .summary = "whole solved paths, found by their ends and bent to those of the query",
    .defaults = {.share = {.lambda = 0.7, .retrieve_after = 2500},
                 .sigma = 0.4,
                 .similarity = std::numeric_limits<double>::infinity(),
                 .max_matches = 50,
                 .drop_invalid_means = false,
                 .first_components = 20},
    .handles = [](const Robot&) { return true; },
    .rank_for_paths = 1,
    .key_size = query_key_size,
    .decompose = find_queries,
    .images = images_of_query,
    .synthesize = warp_paths,
    .bend = bend_path,
    .learn_from_paths = remember_paths,
};

}  // namespace internal
}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows of experience and robot signatures: the types that every database engine stores.
#pragma once

#include "mneme/base.h"
#include "mneme/sampling.h"

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mneme {

/// A local sampler p_i(x | lw_i): a mixture of configurations for one primitive, a small group of
/// obstacles, in the primitive's canonical frame (LocalPrimitive::key). Without components:
/// learning was tried and solved no local query.
struct LocalSampler : GaussianMixture {
  /// False if a time limit ended learning. A query that retrieves such a sampler continues to learn
  /// it.
  bool is_complete = true;
};

/// A path that solved a problem, or a part of it.
struct RememberedPath {
  int joint_count = 0;
  std::vector<float> waypoints;   ///< one configuration after the other, both ends included
  std::uint64_t constraints = 0;  ///< hash of the constraints that the whole path satisfies; 0:
                                  ///< none
  /// Number of states checked while the path was planned, without shortening and improving. Empty:
  /// not measured.
  std::optional<std::uint64_t> planning_states = {};
  /// Lower bound of the distance to obstacles where the path was learned, metres, per waypoint.
  /// Empty: unknown.
  std::vector<float> clearances = {};
  /// Configurations next to the path that obstacles blocked where it was learned, one after the
  /// other.
  std::vector<float> near_misses = {};

  [[nodiscard]] int waypoint_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(waypoints.size()) / joint_count;
  }
};

/// Kind of the rows that hold choices of tasks, one configuration per group of stages. No kind of
/// memory for paths reads them.
inline constexpr std::string_view kTaskRows = "tasks/1";
/// Kind of the rows that remember searches in vain; each holds the start alone.
inline constexpr std::string_view kUnsolvedRows = "unsolved/1";

/// Where a row comes from, as text for people; the program never parses it. If two databases hold
/// equal rows, a merge keeps the earlier provenance.
struct Provenance {
  std::string tool;           ///< such as "mneme 0.2.0"
  std::string settings = {};  ///< learning settings as text
  std::uint64_t seed = 0;
  std::string time = {};  ///< UTC, ISO 8601; filled in by Database::insert() if empty.
  /// Hash of the lesson that taught the row. A lesson is one unit of learning: a primitive or
  /// problem with learning settings and a seed. 0: none. Database::insert() records the lesson as
  /// finished (Database::finished_lessons()), even if an equal row is stored already. Not set in
  /// rows that are read.
  std::uint64_t lesson = 0;
};

/// A row of the database.
struct Experience {
  std::int64_t id = 0;      ///< assigned by the database
  std::string kind;         ///< meaning of the key, such as "pairs/1"; 1 to 64 bytes of UTF-8, no
                            ///< control characters
  std::vector<double> key;  ///< same length for all keys of a kind
  std::variant<LocalSampler, RememberedPath> content;
  Provenance provenance = {};

  [[nodiscard]] bool is_path() const { return std::holds_alternative<RememberedPath>(content); }
  // Precondition: the row holds one.
  [[nodiscard]] const LocalSampler& sampler() const {
    assert(!is_path());
    return *std::get_if<LocalSampler>(&content);
  }
  [[nodiscard]] LocalSampler& sampler() {
    assert(!is_path());
    return *std::get_if<LocalSampler>(&content);
  }
  [[nodiscard]] const RememberedPath& path() const {
    assert(is_path());
    return *std::get_if<RememberedPath>(&content);
  }
  [[nodiscard]] RememberedPath& path() {
    assert(is_path());
    return *std::get_if<RememberedPath>(&content);
  }
  /// Hash of the constraints that a path satisfies; 0 for a sampler.
  [[nodiscard]] std::uint64_t constraints() const { return is_path() ? path().constraints : 0; }
  /// Number of components of the sampler or of waypoints of the path.
  [[nodiscard]] int component_count() const {
    return is_path() ? path().waypoint_count() : sampler().component_count();
  }
};

/// Identifies the robot that experience was learned with, and thus the robots that may use it.
struct RobotSignature {
  std::string robot_name;  ///< for messages only
  /// Robot::kinematics_hash(); robots with an equal hash may use the rows.
  std::string kinematics_hash;
  std::string model_hash;  ///< Robot::hash()
  int joint_count = 0;
};
enum class OpenMode { read_only, read_write, create };

/// One damaged row, or damage to the database as a whole (id 0).
struct Damage {
  std::int64_t id = 0;
  std::string what;
  /// Set aside: searches skip the row, so that the other rows can be used.
  bool is_quarantined = false;
};

struct MergeSummary {
  std::int64_t read = 0;      ///< rows in the source
  std::int64_t added = 0;     ///< rows that the target did not have
  std::int64_t replaced = 0;  ///< rows that the target had with a later provenance; the earlier one
                              ///< is kept
};

}  // namespace mneme

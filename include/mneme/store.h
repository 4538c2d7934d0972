// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a database keeps, whatever keeps it, and its upkeep.
#pragma once

#include "mneme/base.h"
#include "mneme/sampling.h"

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace mneme {

/// A local sampler p_i(x | lw_i) in the canonical frame of its primitive. Without components: the
/// primitive was tried, and nothing passes it.
struct LocalSampler : GaussianMixture {
  /// False if a time budget ended its learning: a query that retrieves it learns on.
  bool is_complete = true;
};

/// A whole path that solved a problem.
struct RememberedPath {
  int joint_count = 0;
  std::vector<float> waypoints;   ///< row by row, both ends included
  std::uint64_t constraints = 0;  ///< hash of the constraints that all of it keeps; 0: none
  /// States that planning it has checked, shortening and improving not counted; nothing if it was
  /// not measured.
  std::optional<std::uint64_t> planning_states;

  [[nodiscard]] int waypoint_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(waypoints.size()) / joint_count;
  }
};

/// Where a row of experience came from: for people, and never parsed. By it a merge decides which
/// of two equal rows stays, and learning that is repeated knows what it has learned before.
struct Provenance {
  std::string tool;      ///< such as "mneme 0.2.0"
  std::string settings;  ///< of the learning, as text
  std::uint64_t seed = 0;
  std::string time;  ///< UTC, ISO 8601; filled in by insert() if empty
};

/// A row of the database.
struct Experience {
  std::int64_t id = 0;  ///< given by the database
  std::string kind;     ///< what the key means, such as "pairs/1": 1 to 64 bytes of UTF-8 without
                        ///< control characters
  std::vector<double> key;  ///< as many numbers as the other keys of its kind
  std::variant<LocalSampler, RememberedPath> content;
  Provenance provenance;

  [[nodiscard]] bool is_path() const { return std::holds_alternative<RememberedPath>(content); }
  // Only of a row that holds one.
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
  /// Hash of the constraints that a path keeps; 0 of a sampler.
  [[nodiscard]] std::uint64_t constraints() const { return is_path() ? path().constraints : 0; }
  /// Components of the sampler, or waypoints of the path.
  [[nodiscard]] int component_count() const {
    return is_path() ? path().waypoint_count() : sampler().component_count();
  }
};

/// The robot that experience was learned with: decides whether it applies at all.
struct RobotSignature {
  std::string robot_name;       ///< for messages only
  std::string kinematics_hash;  ///< Robot::kinematics_hash(): where it is the same, rows apply
  std::string model_hash;       ///< Robot::hash()
  int joint_count = 0;
};
enum class OpenMode { read_only, read_write, create };

/// One damaged row, or damage to the database itself (id 0).
struct Damage {
  std::int64_t id = 0;
  std::string what;
  bool is_quarantined = false;  ///< it is set aside, and the rest can be used
};

struct MergeSummary {
  std::int64_t read = 0;      ///< rows of the source
  std::int64_t added = 0;     ///< that the target did not have
  std::int64_t replaced = 0;  ///< that the target had, learned later; the earlier provenance stays
};

}  // namespace mneme

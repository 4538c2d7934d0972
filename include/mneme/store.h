// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a database keeps, whatever keeps it, and its upkeep.
#pragma once

#include "mneme/base.h"
#include "mneme/sampling.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mneme {

/// The parameters of p_i(x | lw_i) in the canonical frame of its primitive.
using LocalSampler = GaussianMixture;

/// Where a row of experience came from.
struct Provenance {
  std::string tool;      ///< such as "mneme 0.2.0"
  std::string settings;  ///< of the learning, as text
  std::uint64_t seed = 0;
  std::string time;  ///< UTC, ISO 8601; filled in by insert() if empty
};

/// A row of the database: key -> local sampler. An empty sampler says that the primitive was tried
/// and that nothing passes it.
struct Experience {
  std::int64_t id = 0;  ///< given by the database
  std::string kind;     ///< what the key means, such as "pairs/1": 1 to 64 bytes of UTF-8 without
                        ///< control characters
  std::vector<double> key;  ///< as many numbers as the other keys of its kind
  LocalSampler sampler;
  Provenance provenance;
};

/// What decides whether experience applies at all.
struct ExperienceSpace {
  std::string robot_name;  ///< for messages only
  /// Robot::kinematics_hash(), a slash and Robot::hash(): experience applies where the first is the
  /// same. Older databases have the second alone, which then has to be the same.
  std::string robot_hash;
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

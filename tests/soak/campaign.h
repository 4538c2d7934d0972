// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random plans whose paths FCL looks at again.
#pragma once

#include "mneme/pipeline.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mneme::soak {

struct CampaignSettings {
  int plans = 100;
  std::uint64_t seed = 1;
  std::uint64_t max_iterations = 5000;
  double margin = 0;       ///< metres
  double refinement = 20;  ///< FCL looks at states this many times closer than the planner
  bool verify = true;
  bool continuous = true;
  double near = 0;  ///< metres; above 0, starts and goals are at most so far from contact
};

/// Outcomes of the plans of one robot, planner and sampler.
struct Tally {
  int plans = 0;
  int solved = 0;
  int invalid = 0;     ///< paths that overlap something, leave the limits or have wrong ends
  int refused = 0;     ///< problems refused although FCL sees more than a tenth of a millimetre
  double deepest = 0;  ///< metres
};

struct CampaignResult {
  std::map<std::string, Tally> tallies;  ///< by "robot planner sampler"
  std::vector<std::string> findings;     ///< one line for each path or problem that was wrong
};

/// Plan i depends on the seed and i alone, memory aside: with the sampler "gl" a robot remembers
/// what it has solved before. Planners and samplers take turns; every third dozen of plans in space
/// keeps a cone, but for PRM, which cannot. A robot's databases are made in `directory`.
[[nodiscard]] Result<CampaignResult> run_campaign(const Robot& robot, const std::string& directory,
                                                  const CampaignSettings& settings);

}  // namespace mneme::soak

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"

#include "mneme/ompl.h"

#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/est/ProjEST.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/sbl/SBL.h>
#include <ompl/geometric/planners/stride/STRIDE.h>

#include <array>
#include <charconv>
#include <string>

namespace mneme {
namespace ompl {
namespace {

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

template <class Planner>
ob::PlannerPtr make(const ob::SpaceInformationPtr& information) {
  return std::make_shared<Planner>(information);
}

constexpr std::array kPlanners = {
    OmplPlanner{"RRT", make<og::RRT>},
    OmplPlanner{"RRTConnect", make<og::RRTConnect>},
    OmplPlanner{"RRTstar", make<og::RRTstar>},
    OmplPlanner{"InformedRRTstar", make<og::InformedRRTstar>},
    OmplPlanner{"PRM", make<og::PRM>, true},
    OmplPlanner{"PRMstar", make<og::PRMstar>, true},
    OmplPlanner{"LazyPRM", make<og::LazyPRM>},
    OmplPlanner{"EST", make<og::EST>},
    OmplPlanner{"BiEST", make<og::BiEST>},
    OmplPlanner{"ProjEST", make<og::ProjEST>},
    OmplPlanner{"KPIECE1", make<og::KPIECE1>},
    OmplPlanner{"BKPIECE1", make<og::BKPIECE1>},
    OmplPlanner{"LBKPIECE1", make<og::LBKPIECE1>},
    OmplPlanner{"SBL", make<og::SBL>},
    OmplPlanner{"STRIDE", make<og::STRIDE>},
    OmplPlanner{"BITstar", make<og::BITstar>},
    OmplPlanner{kLightning},
    OmplPlanner{kThunder},
};

}  // namespace

std::span<const OmplPlanner> ompl_planners() { return kPlanners; }

void set_range(ob::Planner& planner, double range) {
  if (!(range > 0) || !planner.params().hasParam("range")) return;
  // All digits, and a decimal point in any locale.
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), range);
  if (error == std::errc()) planner.params().setParam("range", {digits.data(), end});
}

}  // namespace ompl

void add_ompl_planners() {
  std::vector<PlannerEntry> entries;
  for (const ompl::OmplPlanner& planner : ompl::ompl_planners()) {
    const std::string name(planner.name);
    PlannerEntry& entry = entries.emplace_back();
    entry.name = "ompl:" + name;
    entry.summary = "OMPL's " + name;
    entry.plan = [&planner](const PlanTask& task) { return ompl::run(planner, task); };
    entry.samples_valid_states = planner.samples_valid_states;
    entry.is_exclusive = true;
    if (planner.make != nullptr) continue;
    entry.summary += ", which plans from its own experience";
    entry.train = [&planner](const Robot& robot, std::span<const Path> paths,
                             const std::string& file) {
      return ompl::train_experience(planner.name, robot, paths, file);
    };
  }
  add_planners(std::move(entries));
  ompl::add_valid_samplers();
}

}  // namespace mneme

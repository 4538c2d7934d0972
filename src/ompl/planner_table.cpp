// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"

#include <array>
#include <charconv>
#include <string>

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

#include "mneme/ompl.h"
#include "ompl/experience.h"

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

constexpr auto kNames = [] {
  std::array<std::string_view, kPlanners.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kPlanners[i].name;
  return names;
}();

}  // namespace

const OmplPlanner* find_ompl_planner(std::string_view name) {
  constexpr std::string_view kPrefix = "ompl:";
  if (name.starts_with(kPrefix)) name.remove_prefix(kPrefix.size());
  for (const OmplPlanner& planner : kPlanners) {
    if (planner.name == name) return &planner;
  }
  return nullptr;
}

void set_range(ob::Planner& planner, double range) {
  if (!(range > 0) || !planner.params().hasParam("range")) return;
  // All digits, and with a point whatever the program's locale says.
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), range);
  if (error == std::errc()) planner.params().setParam("range", {digits.data(), end});
}

}  // namespace ompl

std::span<const std::string_view> ompl_planner_names() { return ompl::kNames; }

}  // namespace mneme

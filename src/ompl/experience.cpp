// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/planner_table.h"

#include <ompl/geometric/planners/experience/LightningRetrieveRepair.h>
#include <ompl/geometric/planners/experience/ThunderRetrieveRepair.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/tools/lightning/LightningDB.h>
#include <ompl/tools/multiplan/ParallelPlan.h>
#include <ompl/tools/thunder/SPARSdb.h>
#include <ompl/tools/thunder/ThunderDB.h>

#include <array>
#include <filesystem>

namespace mneme {
namespace ompl {
namespace {

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;
namespace ot = ::ompl::tools;

/// The planners of ompl::tools::Lightning or Thunder as one planner.
class ExperiencePlanner final : public ob::Planner {
 public:
  /// `roadmap`: Thunder's, otherwise null.
  ExperiencePlanner(const ob::SpaceInformationPtr& information, ob::PlannerPtr repair,
                    ob::PlannerPtr scratch, ob::PlannerPtr roadmap)
      : Planner(information, repair->getName()),
        planners_{std::move(repair), std::move(scratch)},
        roadmap_(std::move(roadmap)) {}

  void setProblemDefinition(const ob::ProblemDefinitionPtr& definition) override {
    Planner::setProblemDefinition(definition);
    for (const ob::PlannerPtr& planner : planners_) planner->setProblemDefinition(definition);
    // The search in the roadmap uses the goal.
    if (roadmap_) roadmap_->setProblemDefinition(definition);
  }
  void clear() override {
    Planner::clear();
    for (const ob::PlannerPtr& planner : planners_) planner->clear();
  }
  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& limit) override {
    ot::ParallelPlan parallel(pdef_);
    for (const ob::PlannerPtr& planner : planners_) parallel.addPlanner(planner);
    return parallel.solve(limit, 1, 1, false);
  }

 private:
  std::array<ob::PlannerPtr, 2> planners_;
  ob::PlannerPtr roadmap_;
};

std::shared_ptr<ot::ThunderDB> make_thunder(const ob::SpaceInformationPtr& information) {
  auto roadmap = std::make_shared<og::SPARSdb>(information);
  roadmap->setProblemDefinition(std::make_shared<ob::ProblemDefinition>(information));
  roadmap->setup();
  // As ompl::tools::Thunder sets them.
  roadmap->setStretchFactor(1.2);
  roadmap->setSparseDeltaFraction(0.05);
  auto database = std::make_shared<ot::ThunderDB>(information->getStateSpace());
  database->setSPARSdb(roadmap);
  return database;
}

struct Repair {
  ob::PlannerPtr planner;  ///< null if OMPL cannot read the file
  ob::PlannerPtr roadmap;  ///< Thunder's, otherwise null
};

Repair make_repair(std::string_view name, const ob::SpaceInformationPtr& information,
                   const std::string& file, const ob::PlannerPtr& helper) {
  if (name == kThunder) {
    const auto database = make_thunder(information);
    if (!file.empty() && !database->load(file)) return {};
    auto planner = std::make_shared<og::ThunderRetrieveRepair>(information, database);
    planner->setRepairPlanner(helper);
    return {planner, database->getSPARSdb()};
  }
  const auto database = std::make_shared<ot::LightningDB>(information->getStateSpace());
  if (!file.empty() && !database->load(file)) return {};
  auto planner = std::make_shared<og::LightningRetrieveRepair>(information, database);
  planner->setRepairPlanner(helper);
  return {planner, nullptr};
}

/// OMPL would read beyond the end of short paths.
Result<void> check_path(const Robot& robot, const Path& path) {
  if (path.empty()) {
    return fail(ErrorCode::invalid, "a path without a configuration cannot be experience");
  }
  for (const Configuration& q : path) {
    if (auto flaw = robot.describe_violation(q, "a waypoint")) {
      return fail(ErrorCode::invalid, *std::move(flaw));
    }
  }
  return {};
}

template <class ExperienceDatabase>
bool write(ExperienceDatabase& database, const ob::SpaceInformationPtr& information,
           std::span<const Path> paths, const std::string& file) {
  for (const Path& path : paths) {
    og::PathGeometric states = to_ompl(path, information);
    double insertion_time = 0;
    database.addPath(states, insertion_time);
  }
  // OMPL reports success even if it cannot write.
  return database.save(file) && std::filesystem::exists(file) &&
         std::filesystem::file_size(file) > 0;
}

}  // namespace

Result<ob::PlannerPtr> make_experience_planner(std::string_view name,
                                               const ob::SpaceInformationPtr& information,
                                               const std::string& file, double range) {
  if (!file.empty() && !std::filesystem::exists(file)) {
    return fail(ErrorCode::io, "'" + file + "': no such file");
  }
  const auto scratch = std::make_shared<og::RRTConnect>(information);
  const auto helper = std::make_shared<og::RRTConnect>(information);
  set_range(*scratch, range);
  set_range(*helper, range);
  const Repair repair = make_repair(name, information, file, helper);
  if (!repair.planner) {
    return fail(ErrorCode::corrupt,
                "'" + file + "': OMPL cannot read it as experience of " + std::string(name));
  }
  return std::make_shared<ExperiencePlanner>(information, repair.planner, scratch, repair.roadmap);
}

Result<void> train_experience(std::string_view planner, const Robot& robot,
                              std::span<const Path> paths, const std::string& path) {
  for (const Path& solved : paths) {
    if (auto checked = check_path(robot, solved); !checked) return checked;
  }
  const Silence silence;
  try {
    // Experience is independent of scenes.
    const auto checker = MNEME_TRY(CollisionChecker::make(robot, Scene{}));
    const ::ompl::base::SpaceInformationPtr information = make_space_information(checker);
    bool is_written = false;
    if (planner == kThunder) {
      is_written = write(*make_thunder(information), information, paths, path);
    } else {
      ot::LightningDB database(information->getStateSpace());
      is_written = write(database, information, paths, path);
    }
    if (!is_written) return fail(ErrorCode::io, "'" + path + "': OMPL cannot write it");
  } catch (const std::exception& error) {
    return fail(ErrorCode::io, "'" + path + "': " + error.what());
  }
  return {};
}

}  // namespace ompl
}  // namespace mneme

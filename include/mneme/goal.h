// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From poses of links to configurations: inverse kinematics, and goals that are regions of poses.
#pragma once

#include "mneme/base.h"
#include "mneme/collision.h"
#include "mneme/problem.h"
#include "mneme/robot.h"
#include "mneme/sampling.h"

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace mneme {

struct IkSettings {
  int seeds = 2048;
  int solutions = 8;
  double position_tolerance = 1e-4;
  double rotation_tolerance = 1e-3;
  double apart = 0.1;
  std::uint64_t seed = 1;  ///< of the random configurations
  /// Called before every 16 seeds; true ends the search with the solutions so far. Empty: never.
  std::function<bool()> is_over = {};
};

/// Declares each setting once: name, range, meaning.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, IkSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("ik-seeds", s.seeds, 1, 100000000,
        "Largest number of configurations from which inverse kinematics starts, 16 at a time. All "
        "are tried only if there is no solution.");
  visit("ik-solutions", s.solutions, 1, 1000,
        "Number of solutions that end the search. Planners start with this number of goals.");
  visit("ik-position-tolerance", s.position_tolerance, 1e-5, 1.0,
        "Largest distance of a solution from the goal pose, metres. In a goal region the solution "
        "itself is within the region.");
  visit("ik-rotation-tolerance", s.rotation_tolerance, 1e-4, 1.0,
        "Largest angle between a solution and the goal pose, radians. In a goal region the "
        "solution itself is within the region.");
  visit("ik-apart", s.apart, 0.0, 1e3,
        "Joint-space distance below which two solutions count as one, radians.");
}

struct IkResult {
  /// Within the limits and apart from each other, nearest to the start of the search first.
  /// Continuous joints are shifted by whole turns to where they are nearest to that start.
  std::vector<Configuration> solutions;
  /// The first few configurations that reach the goal, but are in contact or within the margin.
  std::vector<Configuration> blocked = {};
  int seeds = 0;           ///< number of seeds tried
  PoseError closest = {};  ///< error of the seed's result closest to the goal
};

/// Inverse kinematics of one link, by Levenberg and Marquardt's method on 16 seeds at a time. For
/// any tree of joints, with limits, mimic and continuous joints.
class InverseKinematics {
 public:
  /// Errors: no such link; a link that no joint of the group moves, or more than the 32 joints of
  /// the kernels; an instruction set that this machine lacks.
  [[nodiscard]] static Result<InverseKinematics> make(const Robot& robot, const std::string& link,
                                                      Isa isa = Isa::automatic);

  /// Finds configurations that bring the link to `goal`. Precondition: `goal` is for this link, and
  /// describe_fault() returns nothing for it. Seeds are `near`, configurations around `near`, and
  /// uniform ones. Joints that do not move the link keep their values in `near`. With a checker of
  /// the same robot, solutions are free with `clearance` metres of margin. The result depends on
  /// the arguments alone.
  [[nodiscard]] IkResult solve(const PoseGoal& goal, std::span<const double> near,
                               const IkSettings& settings = {},
                               const CollisionChecker* checker = nullptr,
                               double clearance = 0) const;

 private:
  struct Chain;
  explicit InverseKinematics(std::shared_ptr<const Chain> chain) : chain_(std::move(chain)) {}
  std::shared_ptr<const Chain> chain_;
};

/// Returns the links at the ends of the planning group: the child links of its last joints. Where a
/// chain of fixed joints follows, its last link before the first branch, or Robot::tip() behind it.
[[nodiscard]] std::vector<std::string> find_tips(const Robot& robot);

/// Free configurations in regions of poses.
class PoseGoalSource final : public GoalSource {
 public:
  /// The search begins at `near`, usually the start. Errors: those of InverseKinematics::make().
  [[nodiscard]] static Result<PoseGoalSource> make(const CollisionChecker& checker,
                                                   std::span<const PoseGoal> goals,
                                                   Configuration near, const IkSettings& settings,
                                                   double clearance);

  /// Searches all regions with all the settings' seeds. Returns the nearest solutions first.
  [[nodiscard]] std::vector<Configuration> find_all();
  /// The first call is find_all() for up to IkSettings::solutions regions. With more regions, the
  /// first call tries a few seeds each and returns the first few solutions, so that planning can
  /// begin; it tries more seeds only while there is no solution. Each later call tries a few seeds
  /// for the next regions.
  [[nodiscard]] std::vector<Configuration> more() override;
  /// Returns the first few solutions of each region that are in contact.
  [[nodiscard]] std::vector<Configuration> blocked() const;
  /// Explains for the first regions why no call found a configuration: out of reach by a distance,
  /// not with this rotation, only in contact, or no solution from a number of seeds. Tries some
  /// more seeds for this, unless the search has ended.
  [[nodiscard]] std::string describe_failure() const;
  /// Returns a sentence for each region that find_all() did not reach. If there are too many
  /// regions for find_all(), returns one sentence with the number of regions that the first call of
  /// more() tried.
  [[nodiscard]] std::vector<std::string> describe_unreached() const;

 private:
  struct Region {
    PoseGoal goal;
    InverseKinematics kinematics;
    IkResult first;  ///< result of find_all() or the first call of more()
  };
  PoseGoalSource(const CollisionChecker& checker, Configuration near, const IkSettings& settings,
                 double clearance)
      : checker_(checker), near_(std::move(near)), settings_(settings), clearance_(clearance) {}
  [[nodiscard]] bool is_over() const { return settings_.is_over && settings_.is_over(); }
  [[nodiscard]] bool has_many_regions() const;
  [[nodiscard]] std::vector<Configuration> find_first();
  [[nodiscard]] std::vector<Configuration> sweep(int seeds);
  [[nodiscard]] std::vector<Configuration> search_next();
  void keep_new(std::vector<Configuration>& found);
  [[nodiscard]] std::string describe_failure(const Region& region) const;
  [[nodiscard]] std::string describe_blocked(const Region& region) const;

  CollisionChecker checker_;
  Configuration near_;
  IkSettings settings_;
  double clearance_;
  std::vector<Region> regions_;
  std::vector<Configuration> known_;
  std::uint64_t calls_ = 0;
  std::size_t next_ = 0;  ///< region of the next call
};

}  // namespace mneme

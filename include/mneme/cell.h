// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Certified cells: regions of tasks whose motions are proven free of contact before they are
/// requested.
#pragma once

#include "mneme/base.h"
#include "mneme/path.h"
#include "mneme/problem.h"

#include <array>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mneme {
namespace internal {
struct CellData;
}

/// Largest number of parameters of a task.
inline constexpr std::size_t kTaskSize = 4;
inline constexpr std::array<std::string_view, kTaskSize> kTaskNames = {"x", "y", "z", "yaw"};
/// Offset of the link from the middle of a region: x, y, z in metres, yaw in radians.
using CellTask = std::array<double, kTaskSize>;

struct CellStart {
  std::string name;
  Configuration q;
};

/// Tasks of a robot in a scene: from one of several starts to the poses of a link in a box.
struct CellRegion {
  /// Robot, scene and first start. The problem's one goal is the link's pose in the middle of the
  /// box.
  Problem problem;
  std::vector<CellStart> starts;  ///< at least one
  CellTask half_extents = {};     ///< of the box, each >= 0; 0: this parameter does not vary
  /// Columns: the directions of x, y and z in the root link's frame. Yaw turns about this z.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vec3 pivot = Vec3::Zero();  ///< the point that yaw keeps in place, in the link's frame
  std::string path = {};      ///< the file that the region was read from

  [[nodiscard]] const PoseGoal& middle() const { return problem.pose_goals.front(); }
};

/// Reads a problem file with the key `region` (docs/cells.md). Its goal is one pose without
/// tolerances. Errors name file, line and key; unsupported: constraints, and pairs that are checked
/// by exact geometry.
[[nodiscard]] Result<CellRegion> load_region(const std::string& path,
                                             const ProblemOptions& options = {});
/// Returns the region's file: the problem's with the key `region`. `robot` is written as given. The
/// region's z axis must be that of the root link: a file in a tilted frame cannot be written back.
[[nodiscard]] std::string to_yaml(const CellRegion& region, const std::string& robot);

/// Returns the link's pose for a task, in the root link's frame.
[[nodiscard]] Transform link_pose(const CellRegion& region, const CellTask& task);
/// Returns the task of a pose. Error: invalid, if the pose differs by more than 1e-6 (metres,
/// radians) from those of all tasks, or is beyond the box.
[[nodiscard]] Result<CellTask> task_of(const CellRegion& region, const Transform& pose);

struct CellSettings {
  double seconds = 60;
  std::uint64_t boxes = 1000000;
  int threads = 1;
  double margin = 5e-4;
  std::uint64_t seed = 1;
  /// Flag that another thread sets to end the build; may be null.
  const std::atomic<bool>* cancel = nullptr;
};

/// Declares settings once, as for PlanSettings.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, CellSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("seconds", s.seconds, 0.0, 1e6,
        "Time to build, seconds. More proves more: what is proven stays.");
  visit("boxes", s.boxes, std::uint64_t{1}, std::uint64_t{1000000},
        "Largest number of boxes to examine, for each start. With a seed it makes a build "
        "repeatable, whatever the time and the number of threads.");
  visit("threads", s.threads, 1, 64, "Threads that examine boxes. The cell does not depend on it.");
  visit(
      "margin", s.margin, 5e-5, 0.1,
      "Distance that proven motions keep from obstacles and between links, metres. Parts of links "
      "that cannot come within 1 mm of each other within the joint limits may be closer. Larger "
      "leaves more of the region unproven.");
  visit("seed", s.seed, std::uint64_t{0}, ~std::uint64_t{0}, "Seed of all random numbers.");
}

/// How an answer was found.
enum class CellTier {
  none,       ///< there is no path: none was found, or the task is beyond the region
  certified,  ///< from a box that was proven before
  verified,   ///< a path of the cell, deformed to lead to the task, and verified now
  planned,    ///< a new plan
};
[[nodiscard]] std::string_view to_string(CellTier tier);

struct CellAnswer {
  CellTier tier = CellTier::none;
  int box = -1;            ///< the box that `path` comes from; -1: none
  std::size_t start = 0;   ///< index of the task's start
  Path path = {};          ///< begins at the start as given, unwrapped; empty without an answer
  std::string note = {};   ///< why there is no path
  std::uint64_t cell = 0;  ///< hash of the cell that answered; 0: none
};

/// Why a part of the region is not proven. For boxes that were not examined before the build ended:
/// of the larger box around them.
enum class CellGap {
  blocked,      ///< the link or what it carries touches an obstacle in every task: proven
  unreachable,  ///< inverse kinematics found nothing free
  limits,       ///< the motions that were tried leave the joint limits
  bends,        ///< inverse kinematics bends too much over the smallest box
  contact,      ///< the motions that were tried come too close to contact
  no_path,      ///< planning found no path
  budget,       ///< the proof, or the build, ended before anything was decided
  changed,      ///< robot, scene or allowed contacts have changed since it was proven
};
inline constexpr int kCellGaps = 8;
/// Returns a short sentence.
[[nodiscard]] std::string_view to_string(CellGap gap);

/// A box of tasks that is not proven, at least in part.
struct UnprovenBox {
  CellTask center = {}, half_extents = {};
  CellGap gap = CellGap::budget;
  double share = 0;          ///< of the region's volume
  std::string first, other;  ///< links or obstacles that come too close; empty without contact
  double along = 0;          ///< where on the path, as a share of its length
};

/// A share of the region, by samples.
struct CellCoverage {
  int samples = 0;
  double proven = 0;
  std::array<double, kCellGaps> gaps = {};  ///< shares of the rest, by CellGap
};

/// A step of building, over all starts. Those that are not built yet count as 0.
struct CellProgress {
  double time_s = 0;
  int boxes = 0;       ///< proven
  double proven = 0;   ///< share of the region, by samples
  double decided = 0;  ///< share that is proven or proven to be blocked
};

/// The cost of a call of Cell::verify().
struct CellVerification {
  int proven = 0;   ///< boxes that passed
  int kept = 0;     ///< boxes that were proven against changed obstacles only
  int checked = 0;  ///< boxes
  double time_s = 0;
  int paths = 0;       ///< answers that were checked by exact distances
  int in_contact = 0;  ///< answers in contact among these: a fault of the proof
};

/// Neighbouring tasks whose paths differ.
struct CellJump {
  CellTask task = {};  ///< on the face between the boxes
  int box = -1, next = -1;
  double change = 0;  ///< largest difference of a joint at equal shares of the paths' lengths
};
struct CellContinuity {
  int faces = 0;                ///< between proven boxes, at whose middle tasks were compared
  std::vector<CellJump> jumps;  ///< the largest first
};

/// Boxes of tasks with a path each, which bends with the task. All motions of a proven box, for all
/// its tasks, are free of contact, with the margin, in the modelled scene. Copies share their data.
/// Const functions are parallel-safe.
class Cell {
 public:
  [[nodiscard]] const CellRegion& region() const;
  [[nodiscard]] double margin() const;
  [[nodiscard]] std::size_t box_count() const;
  [[nodiscard]] std::size_t proven_count() const;  ///< boxes; 0 after a change of the world
  [[nodiscard]] std::size_t path_count() const;    ///< paths that were planned for the boxes
  /// True if robot, scene, allowed contacts and starts are those of the build. Otherwise boxes are
  /// hints until verify().
  [[nodiscard]] bool is_of_this_world() const;
  /// True if robot, scene and allowed contacts of the problem are those of region().
  [[nodiscard]] bool is_of(const Problem& problem) const;
  [[nodiscard]] const std::vector<CellProgress>& progress() const;

  /// Makes what answers without a proven box need, which the first of them waits for otherwise:
  /// milliseconds.
  void prepare() const;
  /// Looks the task up among proven boxes. `start`, here and below, is an index of
  /// region().starts. Writes an answer of tier `certified` or `none`. Cost: microseconds, without
  /// allocation if `answer` is used again.
  void look_up(const CellTask& task, CellAnswer& answer, std::size_t start = 0) const;
  /// As look_up(). Without a certified answer, deforms the nearest boxes' paths to the task and
  /// verifies them; then plans for at most `timeout_s` seconds. A path of any tier is proven free
  /// before it is returned. `cancel`, unless null, ends planning soon after another thread sets it.
  [[nodiscard]] CellAnswer ask(const CellTask& task, std::size_t start = 0, double timeout_s = 1,
                               const std::atomic<bool>* cancel = nullptr) const;

  [[nodiscard]] CellCoverage coverage(std::size_t start = 0, int samples = 10000) const;
  /// Compares the paths of tasks on both sides of the faces between boxes. Jumps are changes of at
  /// least `least` radians or metres. Cost: some microseconds a box.
  [[nodiscard]] CellContinuity continuity(std::size_t start = 0, double least = 0.5) const;
  /// The parts that are not proven, largest first.
  [[nodiscard]] std::vector<UnprovenBox> unproven(std::size_t start = 0) const;

  /// Proves all boxes again in the present scene; those that fail become hints. If only obstacles
  /// have changed since the last proof, proves that boxes are free of these. Then checks `samples`
  /// answers, half of them at corners of boxes, by exact distances.
  CellVerification verify(int samples = 1000, std::uint64_t seed = 1, int threads = 1);

  /// Continues the build, as build_cell() does, with the cell's margin. Boxes that verify() did not
  /// prove are replaced. Errors: a setting out of range; invalid unless is_of_this_world().
  [[nodiscard]] Result<void> extend(
      const CellSettings& settings = {},
      const std::function<void(const CellProgress&)>& on_progress = {});

  /// Writes a file that load_cell() reads back to the same cell. Errors: io; those of
  /// check_cell_output().
  [[nodiscard]] Result<void> save(const std::string& path) const;

  /// For build_cell() and load_cell().
  explicit Cell(std::shared_ptr<const internal::CellData> data) : data_(std::move(data)) {}

 private:
  friend class CellMotions;
  std::shared_ptr<const internal::CellData> data_;
};

/// Describes the first start of the region in contact, or nearer than `margin`, metres. Returns
/// nothing if there is none. Errors: those of CollisionChecker::make().
[[nodiscard]] Result<std::optional<std::string>> find_invalid_start(const CellRegion& region,
                                                                    double margin);

/// Builds a cell, the largest boxes first, until nothing is left or the settings' time or number
/// of boxes for each start is spent. Calls `on_progress` after each round, in this thread. Errors:
/// a setting out of range; what load_region() refuses; a start outside the limits or in contact; a
/// link that fewer than six joints move.
[[nodiscard]] Result<Cell> build_cell(
    const CellRegion& region, const CellSettings& settings = {},
    const std::function<void(const CellProgress&)>& on_progress = {});

/// Answers a problem from a cell without planning. Returns nothing if the problem is no task of the
/// cell. In a task, the start is one of the region's starts, bit by bit, the one goal is a pose of
/// the region, and robot, scene and allowed contacts are those of the cell. Cost: that of
/// look_up(), and of reading the scene.
[[nodiscard]] std::optional<CellAnswer> answer_from(const Cell& cell, const Problem& problem);
/// Returns a sentence if the problem's start is within 1e-6 (radians, metres) of one of the cell's
/// starts, but another, so that answer_from() has no answer. Otherwise nothing.
[[nodiscard]] std::optional<std::string> describe_near_start(const Cell& cell,
                                                             const Problem& problem);

/// Reads a cell. The region's file is read, too: `region_path`, or the one that the cell was built
/// from. Errors: io; corrupt for a damaged file; wrong_robot.
[[nodiscard]] Result<Cell> load_cell(const std::string& path, const std::string& region_path = {},
                                     const ProblemOptions& options = {});
/// Checks a path for Cell::save(). Error: invalid, if it is a file that is neither empty nor a
/// cell.
[[nodiscard]] Result<void> check_cell_output(const std::string& path);

}  // namespace mneme

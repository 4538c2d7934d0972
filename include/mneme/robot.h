// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots: kinematic trees of links that carry spheres and capsules, read from URDF at run time.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace mneme {

enum class JointType { fixed, revolute, continuous, prismatic };
/// As URDF calls it.
[[nodiscard]] std::string_view to_string(JointType type);

/// A joint whose value follows another one: multiplier * (value of `joint`) + offset.
struct Mimic {
  int joint = -1;  ///< index of the joint that is followed, which follows none itself
  double multiplier = 1;
  double offset = 0;
};

/// A joint carries its child link: X_parent_child(q) = origin * motion(q) about or along `axis`.
struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  int parent_link = -1;
  int child_link = -1;
  Transform origin;           ///< pose of the joint frame in the parent link's frame
  Vec3 axis = Vec3::UnitX();  ///< unit vector in the joint frame
  double lower = 0;           ///< radians or metres; -pi for continuous joints
  double upper = 0;           ///< radians or metres; +pi for continuous joints
  double velocity = 1;        ///< its limit, >= 0: rad/s or m/s; 1 of a URDF that gives none
  std::optional<double> acceleration;  ///< its limit, >= 0: rad/s^2 or m/s^2, if the URDF gives one
  double fixed_value = 0;              ///< the value of a movable joint outside the planning group
  std::optional<Mimic> mimic;  ///< then the joint is in no group and has no value of its own
};

/// A triangle mesh in a file (STL, OBJ, DAE or PLY); spheres.h reads it.
struct MeshFile {
  std::string path;           ///< on this machine; `package://` is resolved
  Vec3 scale = Vec3::Ones();  ///< along the axes of the mesh, before `pose`
  Transform pose;             ///< of the mesh in the link's frame
};

/// Collision geometry that is not checked as it is, but approximated by spheres (spheres.h).
using Solid = std::variant<Box, Cylinder, MeshFile>;

/// The exact geometry that spheres of a link, or of an object that it carries, stand for.
struct SphereApproximation {
  Mesh surface;  ///< of the solids, in the link's frame; the spheres hold all that it encloses
  int sphere_count = 0;  ///< the last ones of the spheres are the approximation
  double excess = 0;     ///< metres that they stick out at most, by samples
};

struct Link {
  std::string name;
  int parent_joint = -1;                                  ///< -1 for the root
  std::vector<Sphere> spheres;                            ///< in the link's frame
  std::vector<Capsule> capsules;                          ///< in the link's frame
  std::vector<Solid> solids;                              ///< in the link's frame; a Robot has none
  std::optional<SphereApproximation> approximation = {};  ///< of solids that became spheres
};

/// An object that a link carries, such as what a gripper holds.
struct AttachedObject {
  std::string name;                   ///< of no link and no other attached object
  std::string link;                   ///< that carries it
  std::vector<Shape> shapes;          ///< in the link's frame
  std::vector<MeshFile> meshes = {};  ///< in the link's frame
  /// Links and attached objects that may touch it, besides the link that carries it and what is
  /// welded to that.
  std::vector<std::string> may_touch = {};
};

/// An object as it is checked: approximate_object (spheres.h) makes it.
struct ApproximatedObject {
  AttachedObject object;
  std::vector<Sphere> spheres;    ///< in the link's frame
  std::vector<Capsule> capsules;  ///< in the link's frame
  std::optional<SphereApproximation> approximation =
      {};  ///< of boxes, cylinders and meshes that became spheres
};

/// Choices that a URDF alone does not make.
struct RobotOptions {
  /// Names of the joints to plan for, in the order of a configuration. Empty: those of `group`.
  std::vector<std::string> joints = {};
  /// A group of the SRDF, or the chain of joints "base_link:tip_link"; both in tree order. Empty:
  /// the SRDF's only group that can move and is no end effector's; without groups all joints that
  /// move and follow no other, in tree order.
  std::string group = {};
  /// SRDF file with groups and allowed collisions. Empty: the file beside the URDF that differs
  /// from it by its suffix .srdf only, if there is one.
  std::string srdf_path = {};
  /// Directories in which the packages of `package://NAME/...` are looked for, in this order: each
  /// is the package's folder or holds it. Then those of ROS_PACKAGE_PATH, then the folders NAME
  /// that the URDF is in.
  std::vector<std::string> package_paths = {};
  /// Further pairs of links that may touch, besides those of the SRDF.
  std::vector<std::pair<std::string, std::string>> allowed_pairs = {};
  /// Values of movable joints outside the group, by name; default 0. Beyond limits: with a warning.
  std::map<std::string, double> fixed_values = {};

  friend bool operator==(const RobotOptions&, const RobotOptions&) = default;
};

/// A set of joints to plan for, as an SRDF names it.
struct JointGroup {
  std::string name;
  std::vector<std::string> joints;  ///< those that move and follow no other, in tree order
  bool is_end_effector = false;
};

/// Values of joints under a name, as an SRDF's group_state has them.
struct NamedState {
  std::string name;
  std::string group;
  std::map<std::string, double> values;  ///< by joint
};

/// Values of the group's joints in order, or the name of a state of the SRDF.
using GivenConfiguration = std::variant<Configuration, std::string>;

/// An immutable robot model with a planning group. Copies are cheap. All of it is const and
/// parallel-safe.
class Robot {
 public:
  [[nodiscard]] const std::string& name() const { return model_->name; }
  /// Links in tree order: a parent stands before its children.
  [[nodiscard]] std::span<const Link> links() const { return model_->links; }
  /// Index of the link of this name, if there is one.
  [[nodiscard]] std::optional<int> find_link(std::string_view name) const;
  /// Joints in tree order; joint `i` carries link `joints()[i].child_link`.
  [[nodiscard]] std::span<const Joint> joints() const { return model_->joints; }
  /// Indices into joints() of the planning group, in the order of a configuration.
  [[nodiscard]] std::span<const int> group() const { return model_->group; }
  /// Number of joints in the planning group.
  [[nodiscard]] int joint_count() const { return static_cast<int>(model_->group.size()); }
  [[nodiscard]] const Joint& group_joint(int index) const {
    return model_->joints[static_cast<std::size_t>(model_->group[static_cast<std::size_t>(index)])];
  }
  /// Names of the joints of the planning group, in the order of a configuration.
  [[nodiscard]] std::vector<std::string> joint_names() const;
  /// Pairs of link indices (first < second) that are checked against each other.
  [[nodiscard]] std::span<const std::pair<int, int>> self_pairs() const {
    return model_->self_pairs;
  }
  /// The named states of all groups of the SRDF, in its order.
  [[nodiscard]] std::span<const NamedState> named_states() const { return model_->states; }
  /// Notes on parts left aside or clamped, such as names in the SRDF that the model lacks.
  [[nodiscard]] std::span<const std::string> warnings() const { return model_->warnings; }
  /// 16 hexadecimal digits over what decides whether a configuration is valid: kinematics, limits,
  /// shapes, checked pairs, group and fixed values. Names of files, robots and links do not count,
  /// nor do limits of velocity and acceleration, nor what is attached: experience is of the robot,
  /// whatever it carries.
  [[nodiscard]] const std::string& hash() const { return model_->hash; }
  /// 16 hexadecimal digits over what experience depends on: the group's joints in their order, with
  /// the frames that they stand in (the first 8 digits) and their limits (the others). Shapes,
  /// tools, fingers, checked pairs and names do not count.
  [[nodiscard]] std::string kinematics_hash() const;
  /// The same for copies of a robot and for no other one, for as long as one of them lives.
  [[nodiscard]] std::weak_ptr<const void> identity() const { return model_; }
  /// True if every shape stays in the plane z = 0: all joints of the group turn about the z axis.
  [[nodiscard]] bool is_planar() const { return model_->is_planar; }

  /// Poses of all links in the root link's frame. `q` has joint_count() values. O(links).
  [[nodiscard]] std::vector<Transform> link_poses(std::span<const double> q) const;
  /// The values themselves, which describe_violation() judges, or those of the state. Error:
  /// invalid, if no state of this name has a value of each of the group's joints.
  [[nodiscard]] Result<Configuration> configuration_of(const GivenConfiguration& given) const;
  /// Why `q` is no configuration of this robot (count, NaN, limits; beyond 1e-5), or nothing if it
  /// is one. `what` names it in the message, such as "start".
  [[nodiscard]] std::optional<std::string> describe_violation(std::span<const double> q,
                                                              std::string_view what) const;
  /// `q` with continuous joints wrapped to [-pi, pi) and others clamped to their limits.
  [[nodiscard]] Configuration normalized(std::span<const double> q) const;
  /// Shortest joint-space displacement from `a` to `b`: continuous joints take the shorter way
  /// round.
  [[nodiscard]] Configuration difference(std::span<const double> a,
                                         std::span<const double> b) const;
  /// L2 norm of difference(a, b), in radians (metres for prismatic joints).
  [[nodiscard]] double distance(std::span<const double> a, std::span<const double> b) const;

  /// The objects that links carry. Each is one of the last links(), with a fixed joint of its name.
  [[nodiscard]] std::span<const ApproximatedObject> attached() const { return model_->attached; }
  /// This robot with further objects, which are checked against obstacles, against the links that
  /// move against them and against each other. Takes tens of microseconds; shares the kernels'
  /// tables of the bare robot. Errors: an unknown link, a name that is taken, an unknown name among
  /// those that may touch, an object without spheres and capsules.
  [[nodiscard]] Result<Robot> with_attached(std::vector<ApproximatedObject> objects) const;
  /// This robot without one of its objects. Error: it carries none of this name.
  [[nodiscard]] Result<Robot> without_attached(const std::string& name) const;
  /// This robot without any.
  [[nodiscard]] Robot without_attached() const;

  /// The parts of a robot, from which `make_robot` derives the model.
  struct Parts {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    std::vector<JointGroup> groups = {};
    /// The only pairs of links that may touch, besides those of RobotOptions. Nothing: links joined
    /// by one joint may touch.
    std::optional<std::vector<std::pair<std::string, std::string>>> allowed_pairs = std::nullopt;
    std::vector<std::string> warnings = {};
    std::vector<NamedState> states = {};
  };

 private:
  friend Result<Robot> make_robot(Parts parts, const RobotOptions& options);
  struct Model {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    std::vector<int> group;
    std::vector<std::pair<int, int>> self_pairs;
    std::string hash;
    bool is_planar = false;
    std::vector<std::string> warnings;
    std::vector<NamedState> states;
    std::vector<ApproximatedObject> attached = {};
    std::shared_ptr<const Model> bare = nullptr;  ///< null if nothing is attached
  };
  [[nodiscard]] std::shared_ptr<const Model> bare_model() const {
    return model_->bare ? model_->bare : model_;
  }
  explicit Robot(std::shared_ptr<const Model> model) : model_(std::move(model)) {}
  std::shared_ptr<const Model> model_;
};

/// Sorts the tree, folds chains of joints that follow each other, picks the group and derives the
/// pairs to check: all pairs of links with shapes that can move against each other, except allowed
/// ones (see Parts; fixed joints weld links into one body first). Errors: no root or several, a
/// loop, an unknown or doubled name, limits that are missing or reversed, links that have solids.
[[nodiscard]] Result<Robot> make_robot(Robot::Parts parts, const RobotOptions& options = {});

/// Reads a URDF file and its SRDF, and leaves what needs spheres in Link::solids. Strict: an
/// element that mneme cannot use exactly (an unknown shape, a missing mesh file, a malformed
/// number) is an error that names file, line and element. Names in an SRDF that the URDF lacks are
/// warnings.
/// `<capsule radius length>` is an extension; its length is the distance between the cap centres,
/// along z. A `<mimic>` of a fixed joint does not count.
[[nodiscard]] Result<Robot::Parts> read_robot(const std::string& path,
                                              const RobotOptions& options = {});
/// The same for URDF text; `source` names it in messages. Reads an SRDF only if the options name
/// it.
[[nodiscard]] Result<Robot::Parts> parse_robot_parts(std::string_view urdf,
                                                     const std::string& source,
                                                     const RobotOptions& options = {});

/// make_robot of read_robot: a robot whose shapes are spheres and capsules already.
[[nodiscard]] Result<Robot> load_robot(const std::string& path, const RobotOptions& options = {});
/// make_robot of parse_robot_parts.
[[nodiscard]] Result<Robot> parse_robot(std::string_view urdf, const std::string& source,
                                        const RobotOptions& options = {});

/// URDF text that reads back to the same parts, except groups, states, allowed pairs and warnings,
/// which are no matter of URDF. Solids are written too, meshes by their path on this machine.
/// `comment` stands at the top and holds no "--". The indices in `parts` are valid.
[[nodiscard]] std::string to_urdf(const Robot::Parts& parts, std::string_view comment = "");
/// SRDF text with the groups as lists of joints, the named states, the end effectors and the
/// allowed pairs. `reasons` says why each pair is allowed, such as "Adjacent"; "User" stands for
/// those that it leaves out. Read back, no others may touch: of parts without allowed pairs none,
/// not even neighbours.
[[nodiscard]] std::string to_srdf(const Robot::Parts& parts,
                                  std::span<const std::string> reasons = {},
                                  std::string_view comment = "");

/// URDF text of a planar arm: links along x in the plane z = 0, joints about z; the first is
/// continuous, the others are limited to [-pi, pi]. `lengths` in metres, each > 0; links are
/// capsules of `thickness` (diameter).
[[nodiscard]] Result<std::string> planar_arm_urdf(const std::string& name,
                                                  std::span<const double> lengths,
                                                  double thickness = 0.001);

/// The file of a robot that is named without a path, such as "planar8": searched in the directories
/// of MNEME_ROBOT_PATH (colon-separated), then among the robots that came with mneme.
[[nodiscard]] Result<std::string> find_robot(const std::string& name);
/// The URDF file that `robot`, a path or the name of a robot that find_robot knows, stands for.
[[nodiscard]] Result<std::string> robot_file(const std::string& robot);

}  // namespace mneme

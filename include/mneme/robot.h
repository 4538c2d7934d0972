// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots: kinematic trees of links with spheres and capsules, read from URDF at run time.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <array>
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
/// Returns the name that URDF uses.
[[nodiscard]] std::string_view to_string(JointType type);

/// A joint that follows another one: its value is multiplier * (value of `joint`) + offset.
struct Mimic {
  int joint = -1;  ///< Index of the leading joint, which follows none itself.
  double multiplier = 1;
  double offset = 0;
};

/// The pose of a planar or floating joint, which counts as fixed.
struct HeldPose {
  bool is_planar = false;  ///< a planar joint moves across Joint::axis and turns about it
  Transform pose = {};     ///< in the joint frame; Joint::origin contains it
};

/// A joint moves its child link: X_parent_child(q) = origin * motion(q) about or along `axis`.
struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  int parent_link = -1;
  int child_link = -1;
  Transform origin = {};      ///< Pose of the joint frame in the parent link's frame.
  Vec3 axis = Vec3::UnitX();  ///< Unit vector in the joint frame.
  double lower = 0;           ///< Radians or metres; -pi for continuous joints.
  double upper = 0;           ///< Radians or metres; +pi for continuous joints.
  double velocity = 1;        ///< Limit in rad/s or m/s, >= 0; 1 if the URDF gives none.
  /// Limit in rad/s^2 or m/s^2, >= 0, if the URDF gives one.
  std::optional<double> acceleration = {};
  std::optional<double> jerk = {};    ///< Limit in rad/s^3 or m/s^3, >= 0, if the URDF gives one.
  double fixed_value = 0;             ///< Value of a movable joint outside the planning group.
  std::optional<Mimic> mimic = {};    ///< Set for a follower, which is in no group.
  std::optional<HeldPose> held = {};  ///< Set for a planar or floating joint.
};

/// A triangle mesh in a file (STL, OBJ, DAE or PLY), not read yet.
struct MeshFile {
  std::string path;           ///< Path on this machine; `package://` is resolved.
  Vec3 scale = Vec3::Ones();  ///< Along the axes of the mesh, before `pose`.
  Transform pose = {};        ///< Pose of the mesh in the link's frame.
};

/// Collision geometry that spheres replace before collision checking (spheres.h).
using Solid = std::variant<Box, Cylinder, MeshFile>;

/// The exact geometry that some spheres of a link or attached object approximate.
struct SphereApproximation {
  Mesh surface;  ///< Surface of the solids in the link's frame; the spheres contain all that it
                 ///< encloses.
  int sphere_count = 0;   ///< The last `sphere_count` entries of `spheres` approximate it.
  int capsule_count = 0;  ///< The last `capsule_count` of `capsules` do so, too.
  double excess = 0;      ///< Largest distance that a sphere sticks out, metres, by samples.
};

struct Link {
  std::string name;
  int parent_joint = -1;             ///< -1 for the root.
  std::vector<Sphere> spheres = {};  ///< In the link's frame, as are capsules and solids.
  std::vector<Capsule> capsules = {};
  std::vector<Solid> solids = {};  ///< Empty in a Robot, where spheres replace them.
  std::optional<SphereApproximation> approximation = {};  ///< Set if solids became spheres.
};

/// An object that a link carries, such as one in a gripper.
struct AttachedObject {
  std::string name;                   ///< Differs from the names of all links and other attached
                                      ///< objects.
  std::string link;                   ///< Name of the link that carries the object.
  std::vector<Shape> shapes = {};     ///< In the link's frame.
  std::vector<MeshFile> meshes = {};  ///< In the link's frame.
  /// Names of links and attached objects that may touch this object. `link` and the links fixed to
  /// `link` always may.
  std::vector<std::string> may_touch = {};
};

/// An attached object as spheres and capsules; approximate_object (spheres.h) makes it.
struct ApproximatedObject {
  AttachedObject object;
  std::vector<Sphere> spheres = {};                       ///< In the link's frame.
  std::vector<Capsule> capsules = {};                     ///< In the link's frame.
  std::optional<SphereApproximation> approximation = {};  ///< Set if solids became spheres.
};

/// Options for reading a robot from a URDF.
struct RobotOptions {
  /// Names of the joints to plan for, in the order of a configuration. Default: those of `group`.
  std::vector<std::string> joints = {};
  /// A group of the SRDF or a chain of joints "base_link:tip_link", in tree order. Default: the
  /// SRDF's only movable group that is not an end effector; without groups all movable joints that
  /// follow no other.
  std::string group = {};
  /// SRDF file with groups and allowed collisions. Default: the file beside the URDF with the same
  /// name and the suffix .srdf, if it exists.
  std::string srdf_path = {};
  /// Directories to search for `package://NAME/...`: each is the package's folder or contains it.
  /// They are searched before the directories of ROS_PACKAGE_PATH and before folders called NAME in
  /// the directories above the URDF.
  std::vector<std::string> package_paths = {};
  /// Pairs of links that may touch, in addition to those of the SRDF.
  std::vector<std::pair<std::string, std::string>> allowed_pairs = {};
  /// Values of movable joints outside the group, by name. Default: 0. A value beyond the limits is
  /// used with a warning. A planar joint J has the values J/x, J/y and J/theta, a floating joint
  /// J/trans_x, J/trans_y, J/trans_z, J/rot_x, J/rot_y, J/rot_z and J/rot_w (a quaternion).
  std::map<std::string, double> fixed_values = {};
  /// Refuses what is otherwise tolerated with one warning, such as unknown elements and attributes
  /// in URDF and SRDF, missing limits and shapes without size.
  bool strict = false;
  /// Uses the limits of <limit> even if a <safety_controller> has narrower soft limits.
  bool hard_limits = false;

  friend bool operator==(const RobotOptions&, const RobotOptions&) = default;
};

/// A group of the SRDF.
struct JointGroup {
  std::string name;
  std::vector<std::string> joints;  ///< Movable joints that follow no other, in tree order.
  bool is_end_effector = false;
  /// The group's planar or floating joint between world and robot, which is not planned for. Empty:
  /// none.
  std::string virtual_joint = {};
  std::string tip = {};   ///< Last link of a group that is one chain; otherwise empty.
  std::string base = {};  ///< First link of such a chain, which the first joint need not carry.
};

/// An end_effector of the SRDF. Texts are as written there, also if the robot has no such link.
struct EndEffector {
  std::string name;
  std::string group;
  std::string parent_link = {}, parent_group = {};  ///< Empty: none.
};

/// A virtual_joint of the SRDF, between the world and the robot. Texts are as written there.
struct VirtualJoint {
  std::string name;
  std::string type = "fixed";                      ///< "fixed", "planar" or "floating"
  std::string parent_frame = {}, child_link = {};  ///< Empty: none.
};

/// A group_state of the SRDF.
struct NamedState {
  std::string name;
  std::string group;
  std::map<std::string, double> values;  ///< By joint.
};

/// Values of the group's joints in order, or the name of a state in the SRDF.
using GivenConfiguration = std::variant<Configuration, std::string>;

/// An immutable robot model with a planning group. Copies are cheap. All functions are
/// parallel-safe.
class Robot {
 public:
  [[nodiscard]] const std::string& name() const { return model_->name; }
  /// Links in tree order: parents before children.
  [[nodiscard]] std::span<const Link> links() const { return model_->links; }
  /// Returns the index of the link of this name, if there is one.
  [[nodiscard]] std::optional<int> find_link(std::string_view name) const;
  /// As find_link(), but root_frame() is a name of the root link, too.
  [[nodiscard]] std::optional<int> find_frame(std::string_view name) const;
  /// The frame that a fixed virtual joint of the SRDF holds the root link in, such as "world".
  /// Empty without one.
  [[nodiscard]] const std::string& root_frame() const { return model_->root_frame; }
  /// Joints in tree order; joint `i` moves link `joints()[i].child_link`.
  [[nodiscard]] std::span<const Joint> joints() const { return model_->joints; }
  /// Indices of the planning group in joints(), in the order of a configuration.
  [[nodiscard]] std::span<const int> group() const { return model_->group; }
  /// Number of joints in the planning group.
  [[nodiscard]] int joint_count() const { return static_cast<int>(model_->group.size()); }
  [[nodiscard]] const Joint& group_joint(int index) const {
    return model_->joints[static_cast<std::size_t>(model_->group[static_cast<std::size_t>(index)])];
  }
  /// The link that the planning group ends at, if it was given as a chain; otherwise empty.
  [[nodiscard]] const std::string& tip() const { return model_->tip; }
  /// Names of the joints of the planning group, in the order of a configuration.
  [[nodiscard]] std::vector<std::string> joint_names() const;
  /// Pairs of link indices (first < second) that are checked against each other.
  [[nodiscard]] std::span<const std::pair<int, int>> self_pairs() const {
    return model_->self_pairs;
  }
  /// The pairs among self_pairs() that are checked by exact geometry, because their spheres overlap
  /// in every configuration.
  [[nodiscard]] std::span<const std::pair<int, int>> exact_pairs() const {
    return model_->exact_pairs;
  }
  /// Pairs of link indices, without attached objects, that may touch: those of the SRDF and
  /// RobotOptions. Without an SRDF also links that a joint joins, directly or through links without
  /// shapes.
  [[nodiscard]] std::span<const std::pair<int, int>> allowed_pairs() const {
    return model_->allowed_pairs;
  }
  /// The named states of all groups of the SRDF, in its order.
  [[nodiscard]] std::span<const NamedState> named_states() const { return model_->states; }
  /// Warnings from reading, such as names in the SRDF that the URDF lacks.
  [[nodiscard]] std::span<const std::string> warnings() const { return model_->warnings; }
  /// 16 hexadecimal digits over everything that decides whether a configuration is valid:
  /// kinematics, limits, shapes, checked pairs, group and fixed values. Names, limits of velocity,
  /// acceleration and jerk, and attached objects do not count.
  [[nodiscard]] const std::string& hash() const { return model_->hash; }
  /// 16 hexadecimal digits over the group's joints in order: 8 over their frames, 8 over their
  /// limits. Shapes, tools, fingers, checked pairs and names do not count.
  [[nodiscard]] std::string kinematics_hash() const;
  /// Equal for copies of a robot, different for all others while one of the copies exists.
  [[nodiscard]] std::weak_ptr<const void> identity() const { return model_; }
  /// True if every shape stays in the plane z = 0: all joints of the group rotate about z.
  [[nodiscard]] bool is_planar() const { return model_->is_planar; }

  /// Returns the poses of all links in the root link's frame. `q` has joint_count() values. Cost:
  /// O(links).
  [[nodiscard]] std::vector<Transform> link_poses(std::span<const double> q) const;
  /// Returns the given values unchecked (see describe_violation()), or those of the named state.
  /// Error: invalid, if no state of this name has a value for each joint of the group.
  [[nodiscard]] Result<Configuration> configuration_of(const GivenConfiguration& given) const;
  /// Returns why `q` is not a configuration of this robot, otherwise nothing. Reasons: wrong count,
  /// not finite, more than 1e-5 beyond a limit, or a continuous joint beyond 1e4 rad. `what` names
  /// `q` in the message, such as "start".
  [[nodiscard]] std::optional<std::string> describe_violation(std::span<const double> q,
                                                              std::string_view what) const;
  /// Returns true if describe_violation() finds none.
  [[nodiscard]] bool is_configuration(std::span<const double> q) const {
    return !describe_violation(q, "");
  }
  /// Returns `q` with continuous joints wrapped to [-pi, pi) and others clamped to their limits.
  [[nodiscard]] Configuration normalized(std::span<const double> q) const;
  /// Returns `q` with continuous joints shifted by whole turns to where they are nearest to `near`.
  [[nodiscard]] Configuration turned_near(std::span<const double> q,
                                          std::span<const double> near) const;
  /// Returns the shortest displacement from `a` to `b`: continuous joints take the shorter
  /// direction.
  [[nodiscard]] Configuration difference(std::span<const double> a,
                                         std::span<const double> b) const;
  /// Returns the L2 norm of difference(a, b), in radians (metres for prismatic joints).
  [[nodiscard]] double distance(std::span<const double> a, std::span<const double> b) const;

  /// The attached objects. Each is one of the last links(), with a fixed joint of the same name.
  [[nodiscard]] std::span<const ApproximatedObject> attached() const { return model_->attached; }
  /// Returns true if an object of this name is attached.
  [[nodiscard]] bool is_attached(std::string_view name) const;
  /// Returns this robot with further attached objects. The objects are checked against obstacles,
  /// moving links and each other. Errors: an unknown link, a name that is taken, an unknown name in
  /// `may_touch`, an object without spheres and capsules, more than 500,000 pairs of links to
  /// check. Cost: tens of microseconds for a few objects; the tables of the bare robot are shared.
  [[nodiscard]] Result<Robot> with_attached(std::vector<ApproximatedObject> objects) const;
  /// Returns this robot without the attached object `name`. Error: there is none.
  [[nodiscard]] Result<Robot> without_attached(const std::string& name) const;
  /// Returns this robot without attached objects.
  [[nodiscard]] Robot without_attached() const;

  /// Returns this robot, without attached objects, with other limits of position [lower, upper] of
  /// joints by name.
  [[nodiscard]] Robot with_limits(const std::map<std::string, std::array<double, 2>>& limits) const;

  /// The parts from which make_robot() builds a Robot.
  struct Parts {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    std::vector<JointGroup> groups = {};
    /// Pairs of links that may touch, in addition to those of RobotOptions. Without a value, links
    /// that a joint joins may touch, directly or through links without shapes.
    std::optional<std::vector<std::pair<std::string, std::string>>> allowed_pairs = std::nullopt;
    std::vector<std::string> warnings = {};
    std::vector<NamedState> states = {};
    /// Pairs of links to check by exact geometry, unless a pair is allowed. At least one link of
    /// each pair has a sphere approximation.
    std::vector<std::pair<std::string, std::string>> exact_pairs = {};
    std::string root_frame = {};  ///< see Robot::root_frame()
    /// For to_srdf(): `groups` and `root_frame` say what they mean for planning.
    std::vector<EndEffector> end_effectors = {};
    std::vector<VirtualJoint> virtual_joints = {};
    std::vector<std::string> passive_joints = {};
  };

 private:
  friend Result<Robot> make_robot(Parts parts, const RobotOptions& options);
  struct Model {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    std::vector<int> group;
    std::string tip;
    std::vector<std::pair<int, int>> self_pairs, exact_pairs, allowed_pairs;
    std::string hash;
    bool is_planar = false;
    std::vector<std::string> warnings;
    std::vector<NamedState> states;
    std::string root_frame;
    std::vector<ApproximatedObject> attached = {};
    std::shared_ptr<const Model> bare = nullptr;  ///< Null if nothing is attached.
  };
  [[nodiscard]] std::shared_ptr<const Model> bare_model() const {
    return model_->bare ? model_->bare : model_;
  }
  explicit Robot(std::shared_ptr<const Model> model) : model_(std::move(model)) {}
  std::shared_ptr<const Model> model_;
};

/// Builds a robot: sorts the tree, resolves chains of mimic joints, selects the group and derives
/// the pairs to check. These are all pairs of links with shapes that can move relative to each
/// other, except allowed ones. Errors: no root or several, a loop, an unknown or repeated name,
/// missing or reversed limits, links with solids, a follower that jumps where a continuous joint of
/// the group wraps around.
[[nodiscard]] Result<Robot> make_robot(Robot::Parts parts, const RobotOptions& options = {});

/// Reads a URDF file and its SRDF. Boxes, cylinders and meshes stay in Link::solids. Errors name
/// file, line and element: an unknown shape, a missing mesh file, a malformed number. One warning
/// per file counts and names what was tolerated, unless RobotOptions::strict refuses that: unknown
/// elements and attributes, missing or infinite limits, shapes without size, planar and floating
/// joints, which stay at their origin. Names in the SRDF that the URDF lacks are warnings. A
/// `<capsule radius length>` lies along z; its length is the distance between the cap centres. A
/// `<mimic>` of a fixed joint is ignored.
[[nodiscard]] Result<Robot::Parts> read_robot(const std::string& path,
                                              const RobotOptions& options = {});
/// As read_robot() for URDF text, which messages call `source`. Reads an SRDF only if the options
/// name one.
[[nodiscard]] Result<Robot::Parts> parse_robot_parts(std::string_view urdf,
                                                     const std::string& source,
                                                     const RobotOptions& options = {});

/// Reads and builds a robot whose shapes are spheres and capsules already.
[[nodiscard]] Result<Robot> load_robot(const std::string& path, const RobotOptions& options = {});
/// As load_robot() for URDF text; see parse_robot_parts().
[[nodiscard]] Result<Robot> parse_robot(std::string_view urdf, const std::string& source,
                                        const RobotOptions& options = {});

/// Returns URDF text that reads back to the same parts. Groups, states, allowed pairs and warnings
/// are not part of a URDF. Meshes are written as paths on this machine. `comment` is placed at the
/// top and must not contain "--". Precondition: the indices in `parts` are valid.
[[nodiscard]] std::string to_urdf(const Robot::Parts& parts, std::string_view comment = "");
/// Returns SRDF text with groups, named states, end effectors, virtual and passive joints and
/// allowed pairs. A group is written as a chain if it has `base` and `tip`, otherwise as a list of
/// joints, also those of its links and subgroups. An end effector's group that `end_effectors`
/// lacks is written with the name of the group and the link that carries its first joint. `reasons`
/// says why each pair is allowed, such as "Adjacent"; missing ones become "User". An SRDF of parts
/// without allowed pairs allows none, not even neighbours.
[[nodiscard]] std::string to_srdf(const Robot::Parts& parts,
                                  std::span<const std::string> reasons = {},
                                  std::string_view comment = "");

/// Returns URDF text of a planar arm: links along x in the plane z = 0, joints about z. The first
/// joint is continuous, the others are limited to [-pi, pi]. `lengths` in metres, each > 0. Links
/// are capsules with the diameter `thickness` in metres.
[[nodiscard]] Result<std::string> planar_arm_urdf(const std::string& name,
                                                  std::span<const double> lengths,
                                                  double thickness = 0.001);

/// Returns the URDF file of a robot name such as "planar8". Searches the directories of
/// MNEME_ROBOT_PATH (colon-separated), then the bundled robots. Error: io; lists what was searched.
[[nodiscard]] Result<std::string> find_robot(const std::string& name);
/// Returns `robot` if it is a path, otherwise find_robot(robot).
[[nodiscard]] Result<std::string> robot_file(const std::string& robot);

}  // namespace mneme

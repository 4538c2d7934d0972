// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::kPi;
using test::require;
using test::require_error;

/// A robot of two links; line numbers count from the line of <robot>.
const std::string kArm = R"(<robot name="arm">
  <link name="base"/>
  <link name="tool">
    <collision>
      <origin xyz="0.5 0 0" rpy="0 0 0"/>
      <geometry>
        <sphere radius="0.1"/>
      </geometry>
    </collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <child link="tool"/>
    <origin xyz="0 0 1" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.5" effort="1" velocity="1"/>
  </joint>
</robot>
)";

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kArm;
  const std::size_t at = text.find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  return text.replace(at, from.size(), to);
}

RobotOptions strictly() {
  RobotOptions options;
  options.strict = true;
  return options;
}

Robot require_parsed(const std::string& urdf, const RobotOptions& options = {}) {
  return require(parse_robot(urdf, "arm.urdf", options));
}

/// One replacement that breaks kArm, and what the message must begin with and contain.
struct MalformedUrdf {
  std::string from, to;
  int line;
  std::string part;
  ErrorCode code = ErrorCode::parse;
};

void check_refusals(const std::vector<MalformedUrdf>& cases) {
  for (const MalformedUrdf& c : cases) {
    CAPTURE(c.from);
    CAPTURE(c.to);
    const Error error = require_error(parse_robot(replaced(c.from, c.to), "arm.urdf", strictly()));
    const std::string& message = error.message;
    CHECK_MESSAGE(message.starts_with("arm.urdf:" + std::to_string(c.line) + ": "), message);
    CHECK_MESSAGE(contains(message, c.part), message);
    CHECK(error.code == c.code);
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a small robot is read with all its values") {
    const Robot robot = require_parsed(kArm);
    CHECK(robot.name() == "arm");
    REQUIRE(robot.links().size() == 2);
    REQUIRE(robot.links()[1].spheres.size() == 1);
    CHECK(robot.links()[1].spheres[0].center == Vec3(0.5, 0, 0));
    CHECK(robot.links()[1].spheres[0].radius == 0.1);
    const Joint& joint = robot.group_joint(0);
    CHECK(joint.type == JointType::revolute);
    CHECK(joint.origin.translation == Vec3(0, 0, 1));
    CHECK(joint.axis == Vec3::UnitY());
    CHECK(joint.lower == -1);
    CHECK(joint.upper == 1.5);
    const Vec3 center = robot.link_poses(std::vector{0.5 * kPi})[1] * Vec3(0.5, 0, 0);
    CHECK((center - Vec3(0, 0, 0.5)).norm() < 1e-15);
  }

  TEST_CASE("a capsule lies along z of its origin, its length between the cap centres") {
    const Robot robot = require_parsed(replaced(R"(rpy="0 0 0"/>
      <geometry>
        <sphere radius="0.1"/>)",
                                                R"(rpy="-1.5707963267948966 0 0"/>
      <geometry>
        <capsule radius="0.2" length="3"/>)"));
    const Capsule& capsule = robot.links()[1].capsules.at(0);
    CHECK((capsule.a - Vec3(0.5, -1.5, 0)).norm() < 1e-15);
    CHECK((capsule.b - Vec3(0.5, 1.5, 0)).norm() < 1e-15);
    CHECK(capsule.radius == 0.2);
  }

  TEST_CASE("origin and axis may be missing and mean what URDF says") {
    const Robot robot = require_parsed(replaced(R"(    <origin xyz="0 0 1" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
)",
                                                ""));
    CHECK(robot.group_joint(0).origin.translation == Vec3::Zero());
    CHECK(robot.group_joint(0).axis == Vec3::UnitX());
  }

  TEST_CASE("limits of velocity and acceleration are read, and do not count for the hash") {
    const Robot plain = require_parsed(kArm);
    CHECK(plain.group_joint(0).velocity == 1);
    CHECK_FALSE(plain.group_joint(0).acceleration.has_value());
    const Robot fast =
        require_parsed(replaced(R"(velocity="1")", R"(velocity="2.5" acceleration="7")"));
    CHECK(fast.group_joint(0).velocity == 2.5);
    CHECK(fast.group_joint(0).acceleration == 7);
    CHECK(fast.hash() == plain.hash());
    CHECK(require_parsed(replaced(R"( velocity="1")", "")).group_joint(0).velocity == 1);
    std::string turning =
        replaced(R"(lower="-1" upper="1.5" effort="1" velocity="1")", R"(velocity="3")");
    turning.replace(turning.find("revolute"), 8, "continuous");
    CHECK(require_parsed(turning).group_joint(0).velocity == 3);
  }

  TEST_CASE("what has no influence on motion is ignored") {
    const Robot plain = require_parsed(kArm);
    const std::string link_extras =
        R"(<visual><geometry><mesh filename="a.dae"/></geometry></visual><inertial><mass value="x"/>
           </inertial><contact/><collision>)";
    CHECK(require_parsed(replaced("<collision>", link_extras)).hash() == plain.hash());
    const std::string joint_extras =
        R"(<dynamics damping="1"/><safety_controller k_velocity="1"/><calibration/></joint>)";
    CHECK(require_parsed(replaced("</joint>", joint_extras)).hash() == plain.hash());
    const std::string robot_extras =
        R"(<material name="m"/><gazebo><x/></gazebo><transmission><joint name="turn"/>
           </transmission><ros2_control name="c" type="system"><joint name="turn"/></ros2_control>
           <sensor name="eye"><parent link="tool"/></sensor><!-- a comment --></robot>)";
    CHECK(require_parsed(replaced("</robot>", robot_extras)).hash() == plain.hash());
  }

  TEST_CASE("links may follow the joints that name them") {
    const std::string link = R"(  <link name="base"/>
)";
    CHECK(
        require_parsed(replaced(link, "").replace(kArm.size() - link.size() - 9, 0, link)).hash() ==
        require_parsed(kArm).hash());
  }

  TEST_CASE("shapes that are malformed or unknown are refused at their line") {
    check_refusals({
        {"radius=\"0.1\"", "radius=\"-0.1\"", 7, "link 'tool': <sphere>: radius is -0.1"},
        {"radius=\"0.1\"", "radius=\"0.1m\"", 7, "link 'tool': <sphere>: radius is '0.1m'"},
        {"radius=\"0.1\"", "radius=\"nan\"", 7, "link 'tool': <sphere>: radius is 'nan'"},
        {"radius=\"0.1\"", "radius=\"inf\"", 7, "link 'tool': <sphere>: radius is 'inf'"},
        {"radius=\"0.1\"", "radius=\"0,1\"", 7, "link 'tool': <sphere>: radius is '0,1'"},
        {"radius=\"0.1\"", "", 7, "<sphere>: attribute 'radius' is missing"},
        {"radius=\"0.1\"", "radius=\"0.1\" lenght=\"1\"", 7, "unknown attribute 'lenght'"},
        {"<sphere radius=\"0.1\"/>", "<capsule radius=\"1\"/>", 7, "'length' is missing"},
        {"<sphere radius=\"0.1\"/>", "", 6, "<geometry>: expected exactly one shape"},
        {"<sphere radius=\"0.1\"/>", "<sphere radius=\"1\"/><capsule/>", 6, "exactly one shape"},
        {"<sphere radius=\"0.1\"/>", "<cone radius=\"1\"/>", 7, "unknown element <cone>"},
        {"xyz=\"0.5 0 0\"", "xyz=\"0.5 0\"", 5, "link 'tool': <origin>: xyz is '0.5 0'"},
        {"xyz=\"0.5 0 0\"", "xzy=\"0.5 0 0\"", 5, "<origin>: unknown attribute 'xzy'"},
        {"<geometry>", "<geometry/><geometry>", 6, "there is a second <geometry>"},
        {"<collision>", "<collision/><collision>", 4, "the element <geometry> is missing"},
        {"<collision>", "<collison/><collision>", 4, "unknown element <collison> in <link>"},
        {"<collision>", "<collision>oops", 4, "text 'oops"},
    });
  }

  TEST_CASE("joints that are malformed are refused at their line") {
    check_refusals({
        {"upper=\"1.5\"", "upper=\"-1.5\"", 11, "joint 'turn': its lower limit -1 is above"},
        {"upper=\"1.5\"", "upper=\"1.5 2\"", 16, "joint 'turn': <limit>: upper is '1.5 2'"},
        {"upper=\"1.5\"", "", 16, "joint 'turn': <limit>: attribute 'upper' is missing"},
        {"<limit lower=\"-1\" upper=\"1.5\" effort=\"1\" velocity=\"1\"/>", "", 11,
         "joint 'turn': <joint>: the element <limit> is missing"},
        {"velocity=\"1\"", "velocity=\"-1\"", 16, "joint 'turn': <limit>: velocity is -1"},
        {"velocity=\"1\"", "velocity=\"nan\"", 16, "velocity is nan, expected a finite number"},
        {"velocity=\"1\"", "velocity=\"inf\"", 16, "velocity is inf, expected a finite number"},
        {"upper=\"1.5\"", "upper=\"inf\"", 16, "upper is 'inf', expected a finite number"},
        {"velocity=\"1\"", "velocity=\"fast\"", 16, "<limit>: velocity is 'fast'"},
        {"velocity=\"1\"", "acceleration=\"-1\"", 16, "<limit>: acceleration is -1"},
        {"xyz=\"0 1 0\"", "xyz=\"0 1e-10 0\"", 11, "joint 'turn': its axis"},
        {"xyz=\"0 1 0\"", "xyz=\"0 1 1 0\"", 15, "joint 'turn': <axis>: xyz is '0 1 1 0'"},
        {"xyz=\"0 1 0\"", "", 15, "<axis>: attribute 'xyz' is missing"},
        {"type=\"revolute\"", "type=\"revolut\"", 11, "prismatic, or planar or floating"},
        {"type=\"revolute\"", "", 11, "attribute 'type' is missing"},
        {"<parent link=\"base\"/>", "<parent link=\"bass\"/>", 12, "there is no link 'bass'"},
        {"<parent link=\"base\"/>", "", 11, "joint 'turn': <joint>: the element <parent>"},
        {"<child link=\"tool\"/>", "<child/>", 13, "<child>: attribute 'link' is missing"},
        {"<axis", "<axle/><axis", 15, "unknown element <axle> in <joint>"},
        {"<axis", "<axis xyz=\"1 0 0\"/><axis", 15, "there is a second <axis>"},
    });
  }

  TEST_CASE("joints of a kind that mneme lacks are unsupported") {
    const ErrorCode code = ErrorCode::unsupported;
    check_refusals({
        {"type=\"revolute\"", "type=\"planar\"", 11, "joint 'turn': <joint>: type 'planar'", code},
        {"type=\"revolute\"", "type=\"floating\"", 11, "type 'floating' is not supported", code},
    });
  }

  TEST_CASE("a joint may follow one that stands below it in the file") {
    const Robot robot = require_parsed(replaced("</robot>", R"(<link name="hand"/>
      <joint name="grip" type="prismatic"><parent link="tool"/><child link="hand"/>
      <limit lower="0" upper="1"/><mimic joint="slide" multiplier="-2" offset="0.5"/></joint>
      <link name="other"/><joint name="slide" type="prismatic"><parent link="tool"/>
      <child link="other"/><limit lower="0" upper="1"/></joint></robot>)"));
    REQUIRE(robot.joint_count() == 2);
    CHECK(robot.group_joint(1).name == "slide");
    const Joint& grip = robot.joints()[1];
    REQUIRE(grip.name == "grip");
    REQUIRE(grip.mimic.has_value());
    CHECK(robot.joints()[static_cast<std::size_t>(grip.mimic->joint)].name == "slide");
    CHECK(grip.mimic->multiplier == -2);
    CHECK(grip.mimic->offset == 0.5);
  }

  TEST_CASE("a fixed joint that should follow another stays fixed") {
    const std::string fixed = R"(<link name="hand"/><joint name="grip" type="fixed">
      <parent link="tool"/><child link="hand"/><mimic joint="nobody"/></joint></robot>)";
    CHECK_FALSE(require_parsed(replaced("</robot>", fixed)).joints()[1].mimic.has_value());
  }

  TEST_CASE("joints that cannot follow are refused at their line") {
    check_refusals({
        {"<axis", "<mimic joint=\"x\"/><axis", 15, "joint 'turn': <mimic>: there is no joint 'x'"},
        {"<axis", "<mimic/><axis", 15, "joint 'turn': <mimic>: attribute 'joint' is missing"},
        {"<axis", "<mimic joint=\"turn\"/><axis", 11, "joint 'turn': the joints that it follows"},
        {"<axis", "<mimic joint=\"turn\" multiplier=\"x\"/><axis", 15, "multiplier is 'x'"},
        {"<axis", "<mimic joint=\"turn\" ofset=\"1\"/><axis", 15, "unknown attribute 'ofset'"},
    });
  }

  TEST_CASE("documents and trees that are malformed are refused") {
    check_refusals({
        {"</robot>", "", 1, "malformed XML"},
        {"</link>", "</lnk>", 3, "malformed XML"},
        {"<robot name=\"arm\">", "<robot>", 1, "<robot>: attribute 'name' is missing"},
        {"</robot>", "</robot><robot/>", 18, "more than one <robot>"},
        {"</robot>", "<model/></robot>", 18,
         "unknown element <model> in <robot>; expected one of: link,"},
        {"</robot>", "<xacro:property name=\"x\"/></robot>", 18,
         "expected URDF, which xacro writes: xacro FILE.xacro > FILE.urdf"},
        {"<link name=\"base\"/>", "<link/>", 2, "<link>: attribute 'name' is missing"},
        {"<link name=\"base\"/>", "<link name=\"\"/>", 2, "<link>: 'name' is empty"},
        {"</robot>", "<link name=\"tool\"/></robot>", 18, "link 'tool' is defined twice"},
        {"</robot>", "<link name=\"far\"/></robot>", 18, "several root links: neither 'base'"},
        {"<parent link=\"base\"/>", "<parent link=\"tool\"/>", 11,
         "1 joint(s) form a loop: 'turn'"},
        {"</robot>",
         "<joint name=\"turn\" type=\"fixed\"><parent link=\"base\"/><child link=\"tool\"/></joint>"
         "</robot>",
         18, "joint 'turn' is defined twice"},
        {"</robot>",
         "<joint name=\"b\" type=\"fixed\"><parent link=\"base\"/><child "
         "link=\"tool\"/></joint></robot>",
         18, "link 'tool' is the child of two joints, 'turn' and 'b'"},
        {"</robot>",
         "<joint name=\"b\" type=\"fixed\"><parent link=\"tool\"/><child "
         "link=\"base\"/></joint></robot>",
         18, "2 joint(s) form a loop"},
    });
  }
}

namespace {

struct Tolerated {
  std::string from, to;
  std::string finding;
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("foreign parts are ignored with one warning that counts and names them") {
    std::string text = replaced("<axis", "<axle/><axis");
    text.replace(text.find("</robot>"), 8,
                 "<sim:group xmlns:sim=\"x\"><sim:member/></sim:group><sim:group/>\n"
                 "<drake:loop/></robot>");
    text.insert(text.find("<collision>"), "<weightless>0</weightless>oops");
    const Robot robot = require_parsed(text);
    CHECK(robot.hash() == require_parsed(kArm).hash());
    REQUIRE(robot.warnings().size() == 1);
    CHECK(robot.warnings()[0] ==
          "arm.urdf: tolerated 6 faults (an error if strict): unknown element <sim:group> in "
          "<robot> (2 times, first in line 18); unknown element <drake:loop> in <robot> (line 19); "
          "unknown element <weightless> in <link> (line 4); text 'oops' in <link> (line 4); "
          "unknown element <axle> in <joint> (line 15)");
  }

  TEST_CASE("many findings are counted, and the first dozen named") {
    std::string more;
    for (int i = 0; i < 100'000; ++i) more += "<x" + std::to_string(i) + "/>";
    const Robot robot = require_parsed(replaced("</robot>", more + "</robot>"));
    REQUIRE(robot.warnings().size() == 1);
    CHECK(contains(robot.warnings()[0], "tolerated 100000 faults"));
    CHECK(robot.warnings()[0].ends_with("<x11> in <robot> (line 18); and 99988 more"));
  }

  TEST_CASE("faults whose meaning is clear are tolerated by name, and refused if strict") {
    const std::string shape = "<sphere radius=\"0.1\"/>";
    const std::vector<Tolerated> cases{
        {"<robot name=\"arm\">", "<robot>", "<robot>: no name, 'arm' is used (line 1)"},
        {"<robot name=\"arm\">", "<robot name=\"\">", "no name, 'arm' is used"},
        {"xyz=\"0 0 1\"", "xyz=\"0 0 1\" rpi=\"0 0 0\"",
         "unknown attribute 'rpi' of <origin>; did you mean 'rpy'? (line 14)"},
        {"<robot name=\"arm\">", "<robot name=\"arm\" author=\"me\">",
         "unknown attribute 'author' of <robot>"},
        {"<link name=\"tool\"", "<link name=\"tool\" concave=\"true\"",
         "unknown attribute 'concave' of <link>"},
        {"type=\"revolute\"", "type=\"revolute\" default=\"0.3\"",
         "unknown attribute 'default' of <joint>"},
        {"type=\"revolute\"", "type=\"continuous\"",
         "joint 'turn': <limit>: lower and upper of a continuous joint are ignored"},
        {"lower=\"-1\" upper=\"1.5\"", "lower=\"-1e16\" upper=\"1e16\"",
         "<limit>: both limits are infinite, so that the joint counts as continuous"},
        {"upper=\"1.5\"", "upper=\"1e5\"", "<limit>: upper is 1e+05 and taken for 12.57"},
        {"velocity=\"1\"", "velocity=\"1\" jerk=\"-2\"", "<limit>: jerk is -2 and counts as none"},
        {"effort=\"1\"", "command_effort=\"2\"", "unknown attribute 'command_effort' of <limit>"},
        {"<geometry>", "<surface/><geometry>", "unknown element <surface> in <collision> (line 6)"},
        {"<axis", "<axis xyz=\"0 1 0\"/><axis", "a second <axis> in <joint> (line 15)"},
        {"lower=\"-1\"", "", "joint 'turn': <limit>: lower is missing and taken for 0"},
        {"rpy=\"0 0 0\"", "rpy=\"0 0 90\"",
         "<origin>: an angle of rpy exceeds a turn; expected radians"},
        {"velocity=\"1\"", "velocity=\"inf\"", "<limit>: velocity is inf and counts as none"},
        {"velocity=\"1\"", "velocity=\"1e400\"", "<limit>: velocity is inf and counts as none"},
        {"velocity=\"1\"", "velocity=\"nan\"", "<limit>: velocity is nan and counts as none"},
        {"lower=\"-1\" upper=\"1.5\"", "lower=\"-1e5\" upper=\"inf\"",
         "<limit>: both limits are infinite, so that the joint counts as continuous"},
        {"</joint>", "<safety_controller soft_lower=\"1\"/></joint>",
         "unknown attribute 'soft_lower' of <safety_controller>"},
        {"velocity=\"1\"", "velocity=\"-1\"", "<limit>: velocity is -1 and counts as none"},
        {"upper=\"1.5\"", "upper=\"inf\"", "<limit>: upper is inf and taken for 12.57"},
        {"<limit lower=\"-1\" upper=\"1.5\" effort=\"1\" velocity=\"1\"/>", "",
         "joint 'turn': <joint>: no limits, so that the joint stays at 0"},
        {"</robot>",
         "<link name=\"cart\"/><joint name=\"drive\" type=\"planar\"><parent link=\"cart\"/>"
         "<child link=\"base\"/></joint></robot>",
         "joint 'drive': <joint>: a planar joint cannot be planned for and stays at its fixed "
         "values"},
        {"<collision>", "<collision/><collision>", "link 'tool': <collision>: it has no shape"},
        {shape, shape + shape, "<geometry>: several shapes, which are all used"},
        {"<geometry>", "<geometry/><geometry>",
         "a second <geometry> in <collision>, which is used"},
        {shape, "<sphere radius=\"0\"/>", "<sphere>: the shape has no size and is ignored"},
        {shape, "<capsule radius=\"0\" length=\"0\"/>", "<capsule>: the shape has no size"},
        {shape, shape + "<box size=\"0 0 0\"/>", "<box>: the shape has no size and is ignored"},
    };
    for (const Tolerated& c : cases) {
      CAPTURE(c.to);
      const std::string text = replaced(c.from, c.to);
      const Robot robot = require_parsed(text);
      REQUIRE(robot.warnings().size() == 1);
      CHECK_MESSAGE(contains(robot.warnings()[0], c.finding), robot.warnings()[0]);
      CHECK_FALSE(parse_robot(text, "arm.urdf", strictly()).has_value());
    }
  }

  TEST_CASE("missing and infinite limits have values that are safe or clear") {
    const auto joint_of = [](const std::string& limit) {
      const std::string known = "lower=\"-1\" upper=\"1.5\" effort=\"1\" velocity=\"1\"";
      return require_parsed(replaced(known, limit)).group_joint(0);
    };
    CHECK(joint_of("upper=\"1.5\" velocity=\"-1\"").lower == 0);
    CHECK(joint_of("upper=\"1.5\" velocity=\"-1\"").velocity == 1);
    CHECK(joint_of("velocity=\"2\"").upper == 0);
    CHECK(joint_of("lower=\"-inf\" upper=\"inf\"").type == JointType::continuous);
    CHECK(joint_of("lower=\"-1e16\" upper=\"3.4e38\"").type == JointType::continuous);
    CHECK(joint_of("lower=\"-1e400\" upper=\"1e400\"").type == JointType::continuous);
    CHECK(joint_of("lower=\"-inf\" upper=\"1\"").type == JointType::revolute);
    CHECK(joint_of("lower=\"-inf\" upper=\"1\"").lower == -4 * kPi);
    CHECK(joint_of("lower=\"0\" upper=\"1\" drake:acceleration=\"3\"").acceleration == 3);
    CHECK(joint_of("lower=\"0\" upper=\"1\" jerk=\"20\"").jerk == 20);
    std::string slide = replaced("lower=\"-1\"", "lower=\"-inf\"");
    slide.replace(slide.find("revolute"), 8, "prismatic");
    CHECK(require_parsed(slide).group_joint(0).lower == -100);
  }

  TEST_CASE("limits that leave one value are named: exporters write them where none were given") {
    const Robot robot =
        require_parsed(replaced("lower=\"-1\" upper=\"1.5\"", "lower=\"0\" upper=\"0\""));
    REQUIRE(robot.warnings().size() == 1);
    CHECK(robot.warnings()[0] ==
          "arm.urdf: lower and upper are the same for 'turn', which cannot move; expected the "
          "limits of the robot");
  }

  TEST_CASE("soft limits narrow a joint with a note, unless hard limits are wanted") {
    const auto with = [](const std::string& attributes) {
      return replaced("</joint>", "<safety_controller " + attributes + "/></joint>");
    };
    const std::string text = with("soft_lower_limit=\"-0.5\" soft_upper_limit=\"9\"");
    const Robot soft = require_parsed(text);
    CHECK(soft.group_joint(0).lower == -0.5);
    CHECK(soft.group_joint(0).upper == 1.5);
    REQUIRE(soft.warnings().size() == 1);
    CHECK(soft.warnings()[0] ==
          "arm.urdf: <safety_controller> narrows the limits of 'turn' to [-0.5, 1.5] (the limits "
          "of <limit> apply with --hard-limits, hard_limits)");
    RobotOptions hard;
    hard.hard_limits = true;
    CHECK(require_parsed(text, hard).group_joint(0).lower == -1);
    CHECK(require_parsed(text, hard).warnings().empty());
    CHECK(require_parsed(with("k_velocity=\"1\"")).warnings().empty());
    const Robot unset = require_parsed(with("soft_lower_limit=\"0\" soft_upper_limit=\"0\""));
    CHECK(unset.group_joint(0).upper == 1.5);
    CHECK(contains(unset.warnings()[0], "its soft limits leave no range and are ignored"));
  }

  TEST_CASE("soft limits keep a joint with infinite limits from turning without end") {
    const auto joint_of = [](const std::string& soft) {
      std::string text = replaced("lower=\"-1\" upper=\"1.5\"", "lower=\"-inf\" upper=\"1e16\"");
      text.replace(text.find("</joint>"), 0, "<safety_controller " + soft + "/>");
      return require_parsed(text).group_joint(0);
    };
    const Joint both = joint_of("soft_lower_limit=\"-1\" soft_upper_limit=\"1\"");
    CHECK(both.type == JointType::revolute);
    CHECK(both.lower == -1);
    CHECK(both.upper == 1);
    const Joint one = joint_of("soft_lower_limit=\"-1\"");
    CHECK(one.type == JointType::revolute);
    CHECK(one.lower == -1);
    CHECK(one.upper == 4 * kPi);
    CHECK(joint_of("k_velocity=\"1\"").type == JointType::continuous);
  }

  TEST_CASE("soft limits of a continuous joint are ignored by name, and refused if strict") {
    std::string text = replaced(
        "</joint>", "<safety_controller soft_lower_limit=\"-1\" soft_upper_limit=\"1\"/></joint>");
    text.replace(text.find("revolute"), 8, "continuous");
    const Robot robot = require_parsed(text);
    REQUIRE(robot.warnings().size() == 1);
    CHECK(contains(robot.warnings()[0], "soft limits of a continuous joint are ignored"));
    CHECK_FALSE(parse_robot(text, "arm.urdf", strictly()).has_value());
  }

  TEST_CASE("zeros and endless limits of a continuous joint mean that there are none") {
    for (const char* limits : {"", "lower=\"0\" upper=\"0\"", "lower=\"-1e16\" upper=\"inf\""}) {
      std::string text = replaced("lower=\"-1\" upper=\"1.5\"", limits);
      text.replace(text.find("revolute"), 8, "continuous");
      CHECK(require_parsed(text, strictly()).warnings().empty());
    }
  }

  TEST_CASE("names that are not UTF-8 are refused with their line") {
    const auto refusal = [](const std::string& from, const std::string& to) {
      return parse_robot(replaced(from, to), "arm.urdf").error().message;
    };
    CHECK(
        contains(refusal("name=\"turn\"", "name=\"\xe4\""), "name is '\\xe4', which is not UTF-8"));
    CHECK(contains(refusal("name=\"arm\"", "name=\"\xe4\""), "which is not UTF-8"));
  }

  TEST_CASE("an origin may have a quaternion, but not angles too") {
    const std::string half = "quat_xyzw=\"0 0 0.7071067811865476 0.7071067811865476\"";
    const Robot robot = require_parsed(replaced("xyz=\"0 0 1\" rpy=\"0 0 0\"", half));
    CHECK(robot.group_joint(0).origin.rotation.isApprox(rotation_about(Vec3::UnitZ(), kPi / 2)));
    const auto refusal = [](const std::string& origin) {
      return parse_robot(replaced("xyz=\"0 0 1\"", origin), "arm.urdf").error().message;
    };
    CHECK(contains(refusal(half), "<origin>: expected either rpy or quat_xyzw, got both"));
  }

  TEST_CASE("shapes that are unknown are refused though the reader is lenient") {
    const std::string text = replaced("<sphere radius=\"0.1\"/>", "<ellipsoid/>");
    CHECK(contains(parse_robot(text, "arm.urdf").error().message,
                   "arm.urdf:7: link 'tool': unknown element <ellipsoid> in <geometry>"));
    CHECK(contains(
        parse_robot(replaced("</robot>", "<xacro:arm/></robot>"), "arm.urdf").error().message,
        "xacro FILE.xacro > FILE.urdf"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("every prefix of a file is refused and no single damaged byte brings the reader down") {
    for (std::size_t length = 0; length + 2 < kArm.size(); ++length) {
      const auto robot = parse_robot(kArm.substr(0, length), "arm.urdf");
      CHECK_FALSE(robot.has_value());
    }
    Rng rng(41);
    for (int repetition = 0; repetition < 5000; ++repetition) {
      std::string text = kArm;
      const auto at = rng.index(static_cast<std::uint32_t>(text.size()));
      text[at] = static_cast<char>(rng.index(256));
      const auto robot = parse_robot(text, "arm.urdf");
      if (!robot) CHECK(robot.error().message.starts_with("arm.urdf:"));
    }
  }
}

}  // namespace mneme

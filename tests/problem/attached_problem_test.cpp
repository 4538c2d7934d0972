// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Attached objects and allowed contact in problem files.
#include "mneme/problem.h"

#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "input/input.h"
#include "support/support.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

namespace mneme::test {
namespace {

using Names = std::vector<std::string>;

/// lifter.urdf and problem files beside it.
class Files {
 public:
  Files() { write_file(directory_ / "lifter.urdf", kLiftUrdf); }
  /// The link, which has no shape in kLiftUrdf, is a ball.
  explicit Files(const std::string& link) {
    std::string urdf = kLiftUrdf;
    const std::string name = "<link name=\"" + link + "\"", bare = name + "/>";
    urdf.replace(
        urdf.find(bare), bare.size(),
        name + "><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>");
    write_file(directory_ / "lifter.urdf", urdf);
  }

  /// A problem of the lifter with a table, a cup and these further keys.
  [[nodiscard]] Result<Problem> read(const std::string& keys) const {
    write_file(directory_ / "p.yaml", kHead + keys);
    return load_problem(directory_ / "p.yaml");
  }
  /// The message without the directory.
  [[nodiscard]] std::string refusal(const std::string& keys) const {
    const Error error = require_error(read(keys));
    const std::string& message = error.message;
    const std::string prefix = directory_ / "";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return directory_ / name; }
  /// Gives the link "base" the name of the obstacle "cup".
  void name_base_as_cup() const {
    std::string urdf = read_file(directory_ / "lifter.urdf");
    for (std::size_t at = urdf.find("\"base\""); at != std::string::npos;
         at = urdf.find("\"base\"")) {
      urdf.replace(at, 6, "\"cup\"");
    }
    write_file(directory_ / "lifter.urdf", urdf);
  }

 private:
  static constexpr const char* kHead = R"(robot: lifter.urdf
joints: [lift, turn]
start: [0.1, 0]
goal: [0.2, 1]
scene:
  obstacles:
    - {name: table, type: box, position: [0, 0, 0], size: [1, 1, 0.1]}
    - {name: cup, type: sphere, position: [1, 0, 1], radius: 0.1}
)";
  TemporaryDirectory directory_;
};

TEST_SUITE("unit") {
  TEST_CASE("attached objects have a link, shapes and what may touch them") {
    const Files files;
    const Problem problem = require(files.read(R"(attached:
  - {name: box, link: finger, type: box, position: [0, 0, 0.1], size: [0.1, 0.1, 0.1], touch: [carriage, rod]}
  - {name: rod, link: arm, shapes: [{type: capsule, a: [0, 0, 0], b: [1, 0, 0], radius: 0.02}, {type: sphere, position: [1, 0, 0], radius: 0.1}]}
)"));
    const auto attached = problem.robot.attached();
    REQUIRE(attached.size() == 2);
    CHECK(attached[0].object.link == "finger");
    CHECK(attached[0].object.may_touch == Names{"carriage", "rod"});
    CHECK(std::get<Box>(attached[0].object.shapes.at(0)).pose.translation == Vec3(0, 0, 0.1));
    CHECK(attached[1].capsules.size() == 1);
    CHECK(attached[1].spheres.size() == 1);
    CHECK(problem.warnings.empty());
  }

  TEST_CASE("pairs that may touch are taken to links, attached objects and obstacles") {
    const Files files;
    const Problem problem = require(files.read(R"(attached:
  - {name: box, link: finger, type: sphere, position: [0, 0, 0.1], radius: 0.1}
allow: [[arm, table], [cup, box], [base, box], [base, arm]]
)"));
    CHECK(problem.scene.obstacles[0].may_touch == Names{"arm"});
    CHECK(problem.scene.obstacles[1].may_touch == Names{"box"});
    CHECK(problem.robot.attached()[0].object.may_touch == Names{"base"});
    CHECK(require(files.read("")).scene.obstacles[0].may_touch.empty());
  }

  TEST_CASE("two links that may touch are not checked against each other") {
    const Files files("base");
    CHECK(require(files.read("")).robot.self_pairs().size() == 1);
    CHECK(require(files.read("allow: [[arm, base]]\n")).robot.self_pairs().empty());
  }

  TEST_CASE("contact of a name with two meanings is refused") {
    const Files files;
    files.name_base_as_cup();
    const std::string fault =
        "\"cup\" is a link of robot lifter and an obstacle; rename the obstacle";
    CHECK(contains(files.refusal("allow: [[cup, arm]]\n"), fault));
    CHECK(contains(files.refusal("allow: [[arm, cup]]\n"), fault));
    CHECK(contains(files.refusal("allow: [{pair: [arm, cup], at_ends: 0.01}]\n"), fault));
    CHECK(require(files.read("allow: [[arm, table]]\n")).scene.obstacles[0].may_touch ==
          Names{"arm"});
    CHECK(files.read("").has_value());
    CHECK(contains(
        files.refusal("attached: [{name: table, link: arm, type: sphere, position: [0, 0, 0], "
                      "radius: 0.1}]\nallow: [[finger, table]]\n"),
        "\"table\" is an attached object and an obstacle; rename one of them"));
  }

  TEST_CASE("a scene that allows contact of a name with two meanings is refused") {
    const Files files;
    files.name_base_as_cup();
    const Problem problem = require(files.read(""));
    const auto failure = [&](const std::string& allow) {
      const std::string source = "request";
      const internal::InputValue value =
          internal::parse_yaml("start: [0, 0]\ngoal: [1, 1]\n", source);
      const internal::Input input(value, source);
      const Scene scene = require(
          parse_scene("obstacles: [{name: cup, type: sphere, position: [9, 0, 0], radius: 0.1},\n"
                      "  {name: table, type: sphere, position: [8, 0, 0], radius: 0.1}]\n" +
                          allow,
                      "s"));
      const auto read = internal::without_throwing([&] {
        return internal::read_problem_of({"", problem.robot, {}}, {input, input, "p", "", {scene}});
      });
      return read ? "" : read.error().message;
    };
    for (const char* pair : {"[arm, cup]", "[cup, table]", "{pair: [arm, cup], at_ends: 1}"}) {
      CHECK(
          contains(failure(fmt::format("allow: [{}]", pair)), "\"cup\" is a link of robot lifter"));
    }
    CHECK(failure("allow: [[arm, table]]").empty());
  }

  TEST_CASE("pairs of links are refused where the robot is given") {
    const Files files("base");
    const Problem problem = require(files.read(""));
    const auto failure = [&](const std::string& allow) {
      const std::string source = "request";
      const internal::InputValue value =
          internal::parse_yaml("start: [0, 0]\ngoal: [1, 1]\nallow: " + allow, source);
      const internal::Input input(value, source);
      const auto read = internal::without_throwing([&] {
        return internal::read_problem_of({"", problem.robot, {}},
                                         {input, input, "p", "", {problem.scene}});
      });
      return read ? "" : read.error().message;
    };
    CHECK(failure("[[arm, table]]").empty());
    CHECK(failure("[[arm, table], [arm, base]]") ==
          "request:3: key allow: expected pairs of a link and an obstacle or an attached object: "
          "the robot is given, got its links \"arm\" and \"base\"");
  }

  TEST_CASE("a link that stands on an obstacle is a note") {
    const Files files("world");
    CHECK(require(files.read("")).warnings ==
          Names{"link world touches obstacle table, and no joint of the group moves it: this "
                "contact is ignored"});
    CHECK(require(files.read("allow: [[world, table]]\n")).warnings.empty());
  }

  TEST_CASE("a problem that is written reads back with what is attached and may touch") {
    const Files files("base");
    const Problem problem = require(files.read(R"(attached:
  - {name: box, link: finger, type: box, position: [0, 0, 0.1], size: [0.1, 0.2, 0.3], touch: [carriage]}
allow: [[arm, table], [box, cup], [base, arm]]
)"));
    write_file(files / "again.yaml", to_yaml(problem, files / "lifter.urdf"));
    const auto again = require(load_problem(files / "again.yaml"));
    REQUIRE(again.robot.attached().size() == 1);
    const AttachedObject& object = again.robot.attached()[0].object;
    CHECK(object.name == "box");
    CHECK(object.link == "finger");
    CHECK(object.may_touch == Names{"carriage"});
    CHECK(std::get<Box>(object.shapes.at(0)).half_extents == Vec3(0.05, 0.1, 0.15));
    CHECK(again.scene.obstacles[0].may_touch == Names{"arm"});
    CHECK(again.scene.obstacles[1].may_touch == Names{"box"});
    CHECK(again.robot.self_pairs().size() == problem.robot.self_pairs().size());
    CHECK(again.allowed_pairs == problem.allowed_pairs);
    write_file(files / "again.json", to_compact_json(problem, files / "lifter.urdf"));
    const auto compact = require(load_problem(files / "again.json#" + problem.name));
    CHECK(compact.allowed_pairs == problem.allowed_pairs);
    CHECK(compact.robot.hash() == problem.robot.hash());
    CHECK(compact.scene.obstacles[0].may_touch == Names{"arm"});
    CHECK(!contains(to_compact_json(problem, ""), R"("base", "arm")"));
  }

  TEST_CASE("a problem that is written elsewhere finds the meshes that it carries") {
    const Files files;
    write_file(files / "cube.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    require(files.read(
        "attached: [{name: box, link: finger, type: mesh, file: cube.obj, scale: 0.1}]\n"));
    const auto problem =
        require(load_problem(std::filesystem::relative(files / "p.yaml").string()));
    std::filesystem::create_directory(files / "sub");
    write_file(files / "sub/again.yaml", to_yaml(problem, files / "lifter.urdf"));
    const auto again = require(load_problem(files / "sub/again.yaml"));
    CHECK(again.robot.attached()[0].object.meshes.size() == 1);
  }

  TEST_CASE("a scene without its robot keeps what links may touch, not attached objects") {
    const Files files;
    require(files.read(R"(attached:
  - {name: box, link: finger, type: sphere, position: [0, 0, 0.1], radius: 0.1}
allow: [[arm, table], [cup, box], [table, base]]
)"));
    const auto framed = require(extract_scene(files / "p.yaml"));
    CHECK(framed.scene.obstacles[0].may_touch == Names{"arm", "base"});
    CHECK(framed.scene.obstacles[1].may_touch.empty());
    write_file(files / "scene.json", to_compact_json(framed));
    const auto again = require(extract_scene(files / ("scene.json#" + framed.scene.name)));
    CHECK(again.scene.obstacles[0].may_touch == Names{"arm", "base"});
  }

  TEST_CASE("compact problems carry and allow, too") {
    const Files files;
    write_file(files / "c.json", R"({"robot": "lifter.urdf", "joints": ["lift", "turn"],
      "problems": [{"name": "a", "start": [0.1, 0], "goal": [0.2, 1],
        "obstacles": [{"name": "cup", "type": "sphere", "p": [1, 0, 1], "radius": 0.1}],
        "attached": [{"name": "can", "link": "finger", "touch": ["arm"], "type": "cylinder",
                      "p": [0, 0, 0.1], "radius": 0.03, "length": 0.1}],
        "allow": [["can", "cup"]]}]})");
    const auto problem = require(load_problem(files / "c.json#a"));
    CHECK(problem.robot.attached()[0].object.may_touch == Names{"arm"});
    CHECK(problem.scene.obstacles[0].may_touch == Names{"can"});
  }

  TEST_CASE("what is wrong with attached objects is refused with line and key") {
    const Files files;
    const auto refusal = [&](const std::string& object) {
      return files.refusal("attached:\n  - {" + object + "}\n");
    };
    const std::string ball = ", type: sphere, position: [0, 0, 0], radius: 0.1";
    CHECK(refusal("name: box, link: hand" + ball) ==
          "p.yaml:10: key attached[0].link: expected a link of robot lifter to carry \"box\", got "
          "\"hand\"");
    CHECK(refusal("name: arm, link: finger" + ball) ==
          "p.yaml:10: key attached[0].name: expected a unique name, got \"arm\", which names a "
          "link");
    CHECK(refusal("name: box, link: arm" + ball + "}\n  - {name: box, link: finger" + ball) ==
          "p.yaml:11: key attached[1].name: expected a unique name, got \"box\", which names "
          "another attached object");
    CHECK(refusal("name: box, link: arm, touch: [thumb]" + ball) ==
          "p.yaml:10: key attached[0].touch[0]: expected a link of robot lifter or an attached "
          "object, got \"thumb\"");
    CHECK(contains(refusal("name: box, link: arm, type: cone"), "expected sphere, box, cylinder"));
    CHECK(refusal("name: box, link: arm, shapes: []") ==
          "p.yaml:10: key attached[0].shapes: expected at least one shape, got a list of 0");
    CHECK(contains(refusal("name: box, link: arm, body: b" + ball),
                   "key attached[0].body: unknown key"));
    CHECK(contains(refusal("link: arm" + ball), "expected the key name"));
    CHECK(contains(refusal("name: box, link: arm, type: mesh, file: none.stl"), "none.stl"));
    CHECK(refusal("name: box, link: arm, type: mesh, file: a.stl, scale: 0") ==
          "p.yaml:10: key attached[0].scale: expected a number above 0, got 0");
  }

  TEST_CASE("what is wrong with pairs that may touch is refused with line and key") {
    const Files files;
    CHECK(files.refusal("allow: [[arm, shelf]]\n") ==
          "p.yaml:9: key allow[0]: expected a link of robot lifter, an attached object or an "
          "obstacle, got \"shelf\"");
    CHECK(files.refusal("allow: [[arm, table], [hand, table]]\n") ==
          "p.yaml:9: key allow[1]: expected a link of robot lifter, an attached object or an "
          "obstacle, got \"hand\"");
    CHECK(files.refusal("allow: [[table, cup]]\n") ==
          "p.yaml:9: key allow[0]: expected a link or an attached object to touch obstacle "
          "\"table\", got obstacle \"cup\"");
    CHECK(files.refusal("allow: [[arm, arm]]\n") ==
          "p.yaml:9: key allow[0]: expected two names, got \"arm\" twice");
    CHECK(files.refusal("allow: [[arm]]\n")
              .starts_with("p.yaml:9: key allow[0]: expected two names that may touch, as in "
                           "[base_link, table] or "));
    CHECK(files.refusal("allow: [{pair: [hand, table], at_ends: 0.01}]\n") ==
          "p.yaml:9: key allow[0]: expected a link of robot lifter, an attached object or an "
          "obstacle, got \"hand\"");
    CHECK(contains(files.refusal("allow: [{pair: [arm, table]}]\n"), "at_ends"));
    CHECK(contains(files.refusal("allow: {arm: table}\n"), "key allow: expected a list"));
  }

  TEST_CASE("a scene file may say what links may touch its obstacles") {
    const auto scene = require(
        parse_scene("obstacles: [{name: cup, type: sphere, position: [0, 0, 0], radius: 0.1}]\n"
                    "allow: [[arm, cup], [finger, cup]]\n",
                    "s.yaml"));
    CHECK(scene.obstacles[0].may_touch == Names{"arm", "finger"});
    CHECK(parse_scene(to_yaml(scene), "again")->obstacles[0].may_touch == Names{"arm", "finger"});
    CHECK(parse_scene("allow: [[arm, cup]]\n", "s.yaml").error().message ==
          "s.yaml:1: key allow[0]: expected a link and an obstacle; the scene has no obstacle "
          "\"cup\"");
    CHECK(require_error(to_moveit_yaml({scene, "world"}))
              .message.starts_with("\"arm\" may touch obstacle \"cup\"; expected a scene"));
  }
}

}  // namespace
}  // namespace mneme::test

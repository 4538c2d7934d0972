// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

TEST_SUITE("flow") {
  TEST_CASE("a robot is shown by name and by file, with the same hash") {
    const ProgramRun by_name = run_program({"robot", "info", "planar8", "--json"});
    const ProgramRun by_file =
        run_program({"robot", "info", source_file("robots/planar8.urdf"), "--json"});
    REQUIRE_MESSAGE(by_name.exit_code == 0, by_name.err);
    REQUIRE_MESSAGE(by_file.exit_code == 0, by_file.err);
    const Json json = Json::parse(by_name.out);
    CHECK(json["hash"] == planar8().hash());
    CHECK(json["hash"] == Json::parse(by_file.out)["hash"]);
    CHECK(json["joint_count"] == 8);
    CHECK(json["joints"][0]["type"] == "continuous");
    CHECK(json["is_planar"] == true);
    CHECK(contains(run_program({"robot", "info", "planar8"}).out, planar8().hash()));
  }

  TEST_CASE("robots are found in the directories of MNEME_ROBOT_PATH") {
    const PlanarFiles files;
    static_cast<void>(files.short_arm_problem());
    require_run({"robot", "info", "short"}, {{"MNEME_ROBOT_PATH=" + files / ""}, false});
  }

  TEST_CASE("an arm that was made is a robot of that many joints") {
    const PlanarFiles files;
    const std::string path = files / "arm of 3.urdf";
    require_run({"robot", "planar", "--links", "1.5,1,.5", "--name", "three", "-o", path});
    const ProgramRun shown = require_run({"robot", "info", path, "--json"});
    CHECK(Json::parse(shown.out)["joint_count"] == 3);
    CHECK(Json::parse(shown.out)["name"] == "three");
    CHECK(run_program({"robot", "planar", "--links", "1.5,1,.5", "--name", "three"}).out ==
          read_file(path));
  }

  TEST_CASE("check says what touches") {
    const PlanarFiles files;
    const ProgramRun valid = require_run(
        {"robot", "check", "planar8", "--q", "0,0,0,0,0,0,0,0", "--scene", files.problem()});
    CHECK(valid.out.starts_with("valid\ntip link_8 at "));
    const ProgramRun touching =
        run_program({"robot", "check", "planar8", "--q", "-2.2,0,0,0,0,0,0,0", "--scene",
                     files.problem(), "--json"});
    CHECK_MESSAGE(touching.exit_code == 4, touching.err);
    const Json json = Json::parse(touching.out);
    CHECK(json["is_valid"] == false);
    REQUIRE(json["contacts"].size() >= 1);
    REQUIRE(json["tips"].size() == 1);
    CHECK(json["tips"][0]["link"] == "link_8");
    CHECK(json["tips"][0]["position"].size() == 3);
    CHECK(json["tips"][0]["quat_xyzw"].size() == 4);
    CHECK(json["contacts"][0]["is_self"] == false);
    CHECK(json["contacts"][0]["other"] == make_circle_scene("", kTwoCircles).obstacles[1].name);
  }

  TEST_CASE("check tells contacts of spheres from those of exact geometry") {
    const PlanarFiles files;
    const auto check = [&](double z) {
      write_file(files / "slab.yaml",
                 fmt::format("obstacles: [{{name: slab, type: box, position: [0.8, 0, {}], "
                             "size: [0.1, 0.3, 0.2]}}]\n",
                             z));
      return run_program({"robot", "check", source_file("examples/own_robot/arm.urdf"), "--q",
                          "0,0,0", "--scene", files / "slab.yaml"})
          .out;
    };
    // The box of the link ends at 0.27 m.
    CHECK(contains(check(0.165), "); by spheres: the exact geometry is 0.005000 m away\n"));
    CHECK(contains(check(0.175), "); the exact geometry touches, too\n"));
  }

  TEST_CASE("check finds links that cross, and configurations that are none") {
    const ProgramRun crossing =
        run_program({"robot", "check", "planar8", "--q", "0,2.5,2.5,0,0,0,0,0"});
    CHECK_MESSAGE(crossing.exit_code == 4, crossing.err);
    CHECK(contains(crossing.out, "touches link"));
    for (const char* q : {"1,2", "nan,0,0,0,0,0,0,0", "0,4,0,0,0,0,0,0"}) {
      CHECK(run_program({"robot", "check", "planar8", "--q", q}).exit_code == 4);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("joints outside the group stand where --fix says, planar ones too") {
    const PlanarFiles files;
    const std::string cart = files / "cart.urdf";
    write_file(
        cart,
        "<robot name=\"cart\"><link name=\"ground\"/><link name=\"cart\"/><link name=\"arm\">"
        "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>"
        "<joint name=\"base\" type=\"planar\"><parent link=\"ground\"/>"
        "<child link=\"cart\"/></joint>"
        "<joint name=\"turn\" type=\"continuous\"><parent link=\"cart\"/>"
        "<child link=\"arm\"/><axis xyz=\"0 0 1\"/></joint></robot>");
    const ProgramRun run =
        run_program({"robot", "check", cart, "--q", "0", "--fix", "base/x=1,base/y=-2"});
    CHECK_MESSAGE(contains(run.out, "tip arm at 1.000000, -2.000000, 0.000000"),
                  (run.out + run.err));
    check_bad_inputs({
        {{"robot", "check", cart, "--q", "0", "--fix", "base/x"}, 2, {"--fix", "JOINT=VALUE"}},
        {{"robot", "check", cart, "--q", "0", "--fix", "base/x=one"}, 2, {"base/x=one"}},
        {{"robot", "check", cart, "--q", "0", "--fix", "base/x=1,base/x=2"},
         2,
         {"--fix", "'base/x' has two values"}},
        {{"robot", "check", cart, "--q", "0", "--fix", "lift=1"}, 1, {"there is no joint 'lift'"}},
    });
  }

  TEST_CASE("wrong robots end with a message and an exit code") {
    const PlanarFiles files;
    write_file(files / "empty.urdf", "");
    write_file(files / "loop.urdf",
               "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>"
               "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
               "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>"
               "</robot>");
    write_file(files / "stone.urdf",
               "<robot name=\"stone\"><link name=\"a\"><collision><geometry>"
               "<sphere radius=\"1\"/></geometry></collision></link></robot>");
    const std::string unwritable = files / "no/directory/arm.urdf";
    check_bad_inputs({
        {{"robot", "info"}, 2, {"ROBOT is required"}},
        {{"robot", "info", "nobody"}, 1, {"nobody"}},
        {{"robot", "info", files / "missing.urdf"}, 1, {"missing.urdf"}},
        {{"robot", "info", files / "empty.urdf"}, 1, {"empty.urdf"}},
        {{"robot", "info", files / "loop.urdf"}, 1, {"loop.urdf"}},
        {{"robot", "info", files / "stone.urdf"}, 1, {"stone", "no joint that can move"}},
        {{"plan", files.problem(), "--robot", files / "stone.urdf"},
         1,
         {"stone", "no joint that can move"}},
        {{"robot", "check", "planar8"}, 2, {"--q is required"}},
        {{"robot", "check", "planar8", "--q", "1;2"}, 2, {"--q", "'1;2'"}},
        {{"robot", "check", "planar8", "--q", "0,0,0,0,0,0,0,0", "--scene", files / "none.yaml"},
         1,
         {"none.yaml"}},
        {{"robot", "planar"}, 2, {"--links is required"}},
        {{"robot", "planar", "--links", "1,0"}, 2, {"--links"}},
        {{"robot", "planar", "--links", "1,-2"}, 2, {"--links", "-2"}},
        {{"robot", "planar", "--links", "1e300"}, 2, {"--links", "1e+300", "less than 1000000 m"}},
        {{"robot", "planar", "--links", "1,nan"}, 2, {"--links"}},
        {{"robot", "planar", "--links", "1,2", "--thickness", "-1"}, 2, {"--thickness"}},
        {{"robot", "planar", "--links", "1,2", "--json"}, 2, {"--json", "-o"}},
        {{"robot", "planar", "--links", "1,2", "-o", unwritable}, 1, {unwritable}},
    });
  }
}

}  // namespace
}  // namespace mneme::test

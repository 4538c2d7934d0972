// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

std::string link_of(const std::string& name, const std::string& geometry) {
  return "<link name=\"" + name + "\"><collision><geometry>" + geometry +
         "</geometry></collision></link>";
}

std::string joint_of(const std::string& name, const std::string& parent, const std::string& child) {
  return "<joint name=\"" + name + "\" type=\"revolute\"><origin xyz=\"0.4 0 0\"/><parent link=\"" +
         parent + "\"/><child link=\"" + child +
         "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>"
         "</joint>";
}

/// A box, a cylinder, a sphere and a mesh file of one triangle in a row.
struct ArmFiles {
  ArmFiles() {
    write_file(urdf, "<robot name=\"arm\">" + link_of("a", "<box size=\"0.3 0.08 0.08\"/>") +
                         link_of("b", "<cylinder radius=\"0.05\" length=\"0.2\"/>") +
                         link_of("c", "<sphere radius=\"0.07\"/>") +
                         link_of("d", "<mesh filename=\"part.obj\"/>") + joint_of("j", "a", "b") +
                         joint_of("k", "b", "c") + joint_of("l", "c", "d") + "</robot>");
    write_file(files / "part.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  }
  TemporaryDirectory files;
  std::string urdf = files / "arm.urdf";
  std::string out = files / "out.urdf";
  std::string srdf = files / "out.srdf";
};

TEST_SUITE("flow") {
  TEST_CASE("a robot of boxes, cylinders and meshes becomes one of spheres") {
    const ArmFiles arm;
    const ProgramRun run = require_run({"robot", "spheres", arm.urdf, "-o", arm.out, "--srdf-out",
                                        arm.srdf, "--samples", "500", "--json"});
    const Json json = Json::parse(run.out);
    REQUIRE(json["links"].size() == 3);
    for (const Json& link : json["links"]) {
      CHECK(link["uncovered"] == 0);
      CHECK(link["max_excess"] < 0.04);
      CHECK(link["mean_excess"] <= link["max_excess"]);
    }
    CHECK(json["allowed_pairs"]["Adjacent"] == 3);

    const auto robot = require(load_robot(arm.out));
    CHECK(robot.joint_count() == 3);
    std::size_t spheres = 0;
    for (const Link& link : robot.links()) spheres += link.spheres.size();
    CHECK(json["spheres"] == spheres);
    CHECK(robot.links()[2].spheres.size() == 1);
    CHECK(robot.links()[2].spheres[0].radius == doctest::Approx(0.07));
  }

  TEST_CASE("the table names each link, and settings bound its spheres") {
    const ArmFiles arm;
    const ProgramRun run =
        require_run({"robot", "spheres", arm.urdf, "-o", arm.out, "--max-per-link", "2"});
    CHECK(contains(run.out, "uncovered"));
    CHECK(contains(run.out, "\na "));
    CHECK(contains(run.out, "wrote " + arm.out));
    const auto robot = require(load_robot(arm.out));
    for (const Link& link : robot.links()) CHECK(link.spheres.size() <= 2);
  }

  TEST_CASE("a link may have an excess of its own") {
    const ArmFiles arm;
    const auto spheres_of = [&](std::vector<std::string> more) {
      more.insert(more.begin(), {"robot", "spheres", arm.urdf, "-o", arm.out, "--json"});
      const ProgramRun run = require_run(more);
      CHECK(Json::parse(run.out)["links"].size() == 3);
      const auto robot = require(load_robot(arm.out));
      return std::pair(robot.links()[0].spheres.size(), robot.links()[1].spheres.size());
    };
    const auto [first, second] = spheres_of({});
    const auto [finer, same] = spheres_of({"--link-excess", "a=0.008"});
    CHECK(finer > first);
    CHECK(same == second);
    require_run({"robot", "spheres", "--link-excess", "a=0.008", arm.urdf, "-o", arm.out});
  }

  TEST_CASE("pairs of an SRDF are kept with those that sampling finds") {
    const ArmFiles arm;
    write_file(arm.files / "own.srdf",
               "<robot name=\"arm\"><group name=\"g\"><joint name=\"j\"/></group>"
               "<disable_collisions link1=\"a\" link2=\"d\" reason=\"mine\"/></robot>");
    require_run({"robot", "spheres", arm.urdf, "-o", arm.out, "--srdf-out", arm.srdf, "--srdf",
                 arm.files / "own.srdf", "--samples", "2000"});
    const std::string text = read_file(arm.srdf);
    CHECK(contains(text, "<disable_collisions link1=\"a\" link2=\"d\" reason=\"User\"/>"));
    CHECK(contains(text, "<disable_collisions link1=\"a\" link2=\"b\" reason=\"Adjacent\"/>"));
    CHECK(load_robot(arm.out)->joint_count() == 1);
  }

  TEST_CASE(
      "info and plan approximate what needs it, say so, and find it in the cache from then on") {
    const ArmFiles arm;
    const ProcessChanges with_cache{{"XDG_CACHE_HOME=" + arm.files / "cache"}, false};
    const ProgramRun info = require_run({"robot", "info", arm.urdf, "--json"}, with_cache);
    CHECK(contains(info.err, "mneme: warning: approximated the geometry of 3 links by"));
    CHECK_FALSE(contains(info.err, "from the cache"));
    write_file(arm.files / "problem.yaml",
               "robot: arm.urdf\nscene:\n  obstacles:\n"
               "    - {name: ball, type: sphere, position: [0, 5, 0], radius: 0.1}\n"
               "start: [0, 0, 0]\ngoal: [0.5, 0.2, 0.3]\n");
    const ProgramRun plan =
        require_run({"plan", arm.files / "problem.yaml", "--sampler", "uniform"}, with_cache);
    CHECK(contains(plan.err, "; 3 from the cache " + arm.files / "cache/mneme"));
    // Whichever way a command comes by a robot, it says the same of it.
    const std::string said = run_program({"robot", "info", arm.urdf}, with_cache).err;
    CHECK(contains(said, "mneme: warning: approximated the geometry of 3 links by"));
    CHECK(contains(plan.err, said));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong input ends with a message and an exit code") {
    const ArmFiles arm;
    const std::string bad_mesh = arm.files / "bad.urdf";
    write_file(bad_mesh, "<robot name=\"r\">" + link_of("a", "<box size=\"1 1 1\"/>") +
                             link_of("b", "<mesh filename=\"bad.stl\"/>") +
                             joint_of("j", "a", "b") + "</robot>");
    write_file(arm.files / "bad.stl", "rubbish");
    const std::string unwritable = arm.files / "no/directory/out.urdf";
    const std::vector<std::string> good = {"robot", "spheres", arm.urdf, "-o", arm.out};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), good.begin(), good.end());
      return more;
    };
    check_bad_inputs({
        {{"robot", "spheres", arm.urdf}, 2, {"--output is required"}},
        {with({"--excess", "0"}), 2, {"--excess"}},
        {with({"--excess", "nan"}), 2, {"--excess"}},
        {with({"--max-per-link", "0"}), 2, {"--max-per-link"}},
        {with({"--samples", "0"}), 2, {"--samples"}},
        {with({"--link-excess", "a"}), 1, {"--link-excess a: expected LINK=METRES"}},
        {with({"--link-excess", "x=0.01"}), 1, {"--link-excess x=0.01", "a link of the robot"}},
        {with({"--link-excess", "c=0.01"}), 1, {"boxes, cylinders or meshes"}},
        {with({"--link-excess", "a=0"}), 1, {"--link-excess a=0: expected metres"}},
        {{"robot", "spheres", arm.files / "missing.urdf", "-o", arm.out}, 1, {"missing.urdf"}},
        {{"robot", "spheres", bad_mesh, "-o", arm.out}, 1, {bad_mesh, "link 'b'", "bad.stl"}},
        {{"robot", "spheres", arm.urdf, "-o", unwritable}, 1, {unwritable}},
        {{"robot", "spheres", arm.urdf, "-o", arm.urdf}, 1, {"choose another output"}},
        {with({"--srdf-out", arm.urdf}), 1, {"choose another output"}},
        {with({"--srdf", arm.files / "none.srdf"}), 1, {"none.srdf"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test

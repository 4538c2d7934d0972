// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

TEST_SUITE("flow") {
  TEST_CASE("a problem's obstacles, primitives and gaps are shown") {
    const PlanarFiles files;
    const ProgramRun run = require_run({"scene", "info", files.problem(), "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["obstacles"].size() == 2);
    REQUIRE(json["primitives"].size() == 1);
    const double gap = std::hypot(5.75 - 2.1, 2.85 - 1.15) - 1.73 - 1.88;
    CHECK(json["primitives"][0]["gap"].get<double>() == doctest::Approx(gap));
    CHECK(json["primitives"][0]["key"].size() == 6);
    CHECK(contains(run_program({"scene", "info", files.problem()}).out, "primitives  1"));
  }

  TEST_CASE("a scene alone has primitives only for a robot") {
    const PlanarFiles files;
    const std::string scene = files / "scene.yaml";
    write_file(scene, to_yaml(make_circle_scene("two", kTwoCircles)));
    const ProgramRun alone = require_run({"scene", "info", scene, "--json"});
    CHECK(Json::parse(alone.out)["primitives"].is_null());
    const ProgramRun with_robot =
        require_run({"scene", "info", scene, "--robot", "planar8", "--json"});
    CHECK(Json::parse(with_robot.out)["primitives"].size() == 1);
  }

  TEST_CASE("a file that is neither a scene nor a problem is refused with one reason") {
    const PlanarFiles files;
    write_file(files / "limits.yaml", "joint_limits: {joint_1: {max_velocity: 1}}");
    const ProgramRun limits = run_program({"scene", "info", files / "limits.yaml"});
    CHECK(limits.exit_code == 1);
    CHECK(contains(limits.err,
                   "limits.yaml:1: key joint_limits: unknown key, expected one of name, "
                   "circles, obstacles, allow\n"));
    write_file(files / "wrong.yaml", "robot: planar8\nscene: {circles: {a: [1, 2]}}\n");
    const ProgramRun wrong = run_program({"scene", "info", files / "wrong.yaml"});
    CHECK(wrong.exit_code == 1);
    CHECK(contains(wrong.err, "wrong.yaml:2: key scene.circles.a: expected 3 numbers"));
    CHECK(!contains(wrong.err, "unknown key"));
  }

  TEST_CASE("an interrupt before the first problem leaves earlier files alone") {
    const PlanarFiles files;
    const std::string problems = files / "problems.json", lessons = files / "lessons.json";
    for (const int wait_ms : {50, 200, 800}) {
      write_file(problems, "old");
      write_file(lessons, "old");
      RunningProgram program({"scene", "composed", "--robot", "fetch", "-n", "100000", "-o",
                              problems, "--lessons", lessons});
      std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
      program.send(SIGINT);
      const ProgramRun run = program.wait();
      CHECK_MESSAGE(run.exit_code == 130, run.err);
      for (const std::string& file : {problems, lessons}) {
        const std::string text = read_file(file);
        CHECK((text == "old" || !Json::parse(text).at("problems").empty()));
      }
    }
  }

  TEST_CASE("what was left aside of a scene's files is told") {
    const PlanarFiles files;
    write_file(files / "scan.ply",
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n1 2 3\nnan 0 0\n");
    write_file(files / "scan.yaml",
               "obstacles: [{name: scan, type: points, file: scan.ply, radius: 0.01}]\n");
    const ProgramRun run = require_run({"scene", "info", files / "scan.yaml"});
    CHECK(contains(run.err, "1 of 2 points are not finite and ignored"));
  }

  TEST_CASE("the largest gap decides what is a primitive") {
    const PlanarFiles files;
    const ProgramRun run =
        require_run({"scene", "info", files.problem(), "--max-gap", "0.1", "--json"});
    CHECK(Json::parse(run.out)["primitives"].empty());
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a scene goes round through every format") {
    const PlanarFiles files;
    const auto convert = [&](const std::string& from, const std::string& to,
                             const std::vector<std::string>& flags) {
      std::vector<std::string> arguments = {"scene", "convert", from, "-o", to};
      arguments.insert(arguments.end(), flags.begin(), flags.end());
      require_run(arguments);
    };
    convert(files.problem(), files / "a.yaml", {"--format", "moveit", "--frame", "base"});
    convert(files / "a.yaml", files / "b.json", {});
    convert(files / "b.json#two", files / "c.yaml", {});
    const Scene first = extract_scene(files.problem()).value().scene;
    const Scene last = load_scene(files / "c.yaml").value();
    CHECK(to_yaml(last) == to_yaml(first));
    CHECK(contains(read_file(files / "c.yaml"), "# in the frame of base\n"));
    CHECK(contains(run_program({"scene", "convert", files / "a.yaml"}).out, "obstacles:"));
  }

  TEST_CASE("a scene is moved from the frame that it or --frame names") {
    const PlanarFiles files;
    write_file(files / "stand.urdf",
               "<robot name='stand'><link name='floor'/><link name='base'/><link name='arm'/>"
               "<joint name='leg' type='fixed'><parent link='floor'/><child link='base'/>"
               "<origin xyz='0 0 0.5'/></joint>"
               "<joint name='turn' type='continuous'><parent link='base'/><child link='arm'/>"
               "<axis xyz='0 0 1'/></joint></robot>");
    write_file(files / "ball.yaml",
               "obstacles: [{name: ball, type: sphere, position: [1, 0, 0.25], radius: 0.125}]\n");
    const auto convert = [&](const std::string& scene, const std::string& frame) {
      return run_program({"scene", "convert", files / scene, "--robot", files / "stand.urdf",
                          "--frame", frame, "-o", files / "moved.yaml"});
    };
    const std::string moved = "position: [1, 0, 0.75]";
    CHECK(convert("ball.yaml", "base").exit_code == 0);
    CHECK(contains(read_file(files / "moved.yaml"), moved));
    CHECK(contains(convert("ball.yaml", "wall").err, "robot stand as frame, got \"wall\""));
    CHECK(contains(convert("ball.yaml", "arm").err, "which joint turn moves"));

    require_run({"scene", "convert", files / "ball.yaml", "--format", "moveit", "--frame", "base",
                 "-o", files / "framed.yaml"});
    CHECK(contains(convert("framed.yaml", "floor").err, "--frame floor is ignored"));
    CHECK(contains(read_file(files / "moved.yaml"), moved));
  }

  TEST_CASE("a conversion tells which frame the scene file cannot name") {
    const PlanarFiles files;
    const auto notes = [&](const std::vector<std::string>& flags) {
      std::vector<std::string> arguments = {"scene", "convert", files.problem()};
      arguments.insert(arguments.end(), flags.begin(), flags.end());
      return require_run(arguments).err;
    };
    CHECK(contains(notes({"--frame", "base"}), "write 'frame: base' in the problems"));
    CHECK(notes({"--frame", "base", "--format", "compact"}).empty());
    CHECK(notes({"--robot", "planar8"}).empty());
    CHECK(notes({}).empty());
  }

  TEST_CASE("what a conversion leaves aside is told") {
    const PlanarFiles files;
    write_file(files / "cloud.yaml",
               "obstacles: [{name: a, type: points, points: [], radius: 0.1}, {name: b, type: "
               "sphere, position: [1, 0, 0], radius: 0.1}]\n");
    CHECK(contains(require_run({"scene", "convert", files / "cloud.yaml"}).err,
                   "there are no points, and the cloud is left out"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("names of a scene cannot steer a terminal") {
    const PlanarFiles files;
    const std::string problem =
        "robot: planar8\nstart: [-2.2, 0, 0, 0, 0, 0, 0, 0]\ngoal: [0, 0, 0, 0, 0, 0, 0, 0]\n"
        "scene: {circles: {\"a\\nb\\e[31m\\x9b2J\": [-5.75, -1.15, 1.73]}}\n";
    write_file(files / "odd.yaml", problem);
    const std::string shown = "a\\x0ab\\x1b[31m\\xc2\\x9b2J";
    const ProgramRun info = require_run({"scene", "info", files / "odd.yaml"});
    CHECK_MESSAGE(contains(info.out, shown), info.out);
    const ProgramRun check = run_program(
        {"robot", "check", "planar8", "--q", "-2.94,0,0,0,0,0,0,0", "--scene", files / "odd.yaml"});
    CHECK(check.exit_code == 4);
    CHECK_MESSAGE(contains(check.out, "obstacle " + shown), check.out);
    const ProgramRun plan =
        run_program({"plan", files / "odd.yaml", "--start", "-2.94,0,0,0,0,0,0,0"});
    CHECK(plan.exit_code == 4);
    CHECK_MESSAGE(contains(plan.err, shown), plan.err);
    for (const std::string& text : {info.out, check.out, plan.out, plan.err}) {
      CHECK_FALSE(contains(text, "\x1b"));
      CHECK_FALSE(contains(text, "\xc2\x9b"));
    }
    const ProgramRun json = run_program({"scene", "info", files / "odd.yaml", "--json"});
    CHECK(Json::parse(json.out)["obstacles"][0]["name"] ==
          "a\nb\x1b[31m\xc2\x9b"
          "2J");
  }

  TEST_CASE("wrong scenes end with a message and an exit code") {
    const PlanarFiles files;
    write_file(files / "list.yaml", "[1, 2]\n");
    write_file(files / "far.yaml", "circles: {a: [1, 2, 1e300]}\n");
    write_file(files / "negative.yaml", "circles: {a: [1, 2, -3]}\n");
    check_bad_inputs({
        {{"scene", "info"}, 2, {"SCENE is required"}},
        {{"scene", "info", files / "none.yaml"}, 1, {"none.yaml"}},
        {{"scene", "info", files / "list.yaml"}, 1, {"list.yaml"}},
        {{"scene", "info", files / "negative.yaml"}, 1, {"negative.yaml", "-3"}},
        {{"scene", "info", files / "far.yaml"}, 1, {"far.yaml:1", "within 10000 m"}},
        {{"scene", "info", files.problem(), "--robot", "nobody"}, 1, {"nobody"}},
        {{"scene", "info", files.problem(), "--max-gap", "-1"}, 2, {"--max-gap"}},
        {{"scene", "convert", files / "none.yaml"}, 1, {"none.yaml"}},
        {{"scene", "convert", files.problem(), "--format", "dae"}, 2, {"--format", "dae"}},
        {{"scene", "convert", files.problem(), "--format", "moveit"}, 1, {"frame"}},
        {{"scene", "convert", files.problem(), "-o", files / "no/s.yaml"}, 1, {"no/s.yaml"}},
        {{"scene", "composed", "-o", "-", "--modules", "2"}, 2, {"--modules", "2 are fewer than"}},
        {{"scene", "composed", "-o", "-", "--passages", "1:9"}, 2, {"--passages", "from 1 to 8"}},
        {{"scene", "composed", "-o", "-", "--passages", "nan"}, 2, {"--passages"}},
        {{"scene", "threaded", "-o", "-", "--depth", "3:4.5"}, 2, {"--depth", "3:4.5 is no range"}},
    });
  }
}

TEST_SUITE("flow") {
  TEST_CASE("random scenes like a given one are written, the same for the same seed") {
    const PlanarFiles files;
    write_file(files / "v.yaml", "obstacles: {circle_*: {position: {uniform: [0.1, 0.1, 0]}}}\n");
    const auto vary = [&](const std::string& directory, const std::string& seed) {
      const ProgramRun run =
          require_run({"scene", "vary", files.problem(), "--variations", files / "v.yaml", "-n",
                       "3", "--seed", seed, "-o", files / directory, "--json"});
      const Json json = Json::parse(run.out);
      REQUIRE(json["files"].size() == 3);
      return read_file(json["files"][1].get<std::string>());
    };
    const std::string once = vary("a", "5");
    CHECK(once == vary("b", "5"));
    CHECK(once != vary("c", "6"));
    CHECK(parse_scene(once, "scene").has_value());
  }

  TEST_CASE("variations of obstacles that are not there are refused by name") {
    const PlanarFiles files;
    write_file(files / "v.yaml", "obstacles: {cup: {rpy: {uniform: [0, 0, 1]}}}\n");
    const ProgramRun run = run_program(
        {"scene", "vary", files.problem(), "--variations", files / "v.yaml", "-o", files / "out"});
    CHECK(run.exit_code == 1);
    CHECK(contains(run.err, "'cup'"));
    CHECK(contains(run.err, "v.yaml"));
  }
}

}  // namespace
}  // namespace mneme::test

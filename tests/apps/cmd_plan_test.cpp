// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <chrono>
#include <thread>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

std::string list_of(const Configuration& q) {
  std::string text;
  for (const double value : q) text += (text.empty() ? "" : ",") + std::to_string(value);
  return text;
}

TEST_SUITE("flow") {
  TEST_CASE("a problem is solved without memory, and the JSON has the stable keys") {
    const PlanarFiles files;
    const ProgramRun run = require_run({"plan", files.problem(), "--json", "--seed", "7"});
    const Json json = Json::parse(run.out);
    for (const char* key : {"status",
                            "solved",
                            "path",
                            "path_length",
                            "total_time_s",
                            "planning_time_s",
                            "retrieval_time_s",
                            "learning_time_s",
                            "simplification_time_s",
                            "verification_time_s",
                            "load_time_s",
                            "iterations",
                            "states_checked",
                            "motions_checked",
                            "primitives",
                            "retrieved",
                            "components",
                            "sampler",
                            "planner",
                            "seed",
                            "isa"}) {
      CHECK_MESSAGE(json.contains(key), key);
    }
    CHECK(json["status"] == "solved");
    CHECK(json["sampler"] == "uniform");
    CHECK(json["planner"] == "rrt_connect");
    CHECK(json["seed"] == 7);
    CHECK(json["load_time_s"] > 0);
    const auto path = json["path"].get<std::vector<Configuration>>();
    REQUIRE(path.size() >= 2);
    CHECK(planar8().distance(path.front(), kStart) < 1e-6);
    CHECK(planar8().distance(path.back(), kGoal) < 1e-6);
  }

  TEST_CASE(
      "a trajectory is written in the format of the file's ending, and its duration is told") {
    const PlanarFiles files;
    const std::vector<std::string> command = {"plan", files.problem(), "--json", "--trajectory"};
    const auto run_with = [&](const std::string& file, const std::vector<std::string>& more = {}) {
      std::vector<std::string> words = command;
      words.push_back(files / file);
      words.insert(words.end(), more.begin(), more.end());
      const ProgramRun run = require_run(words);
      return Json::parse(run.out);
    };
    const double duration = run_with("m.csv")["duration_s"];
    CHECK(duration > 1);
    const std::string csv = read_file(files / "m.csv");
    CHECK(csv.starts_with("time,joint_1.position,joint_2.position,"));
    CHECK(std::ranges::count(csv, '\n') == 2 + std::round(duration / 0.01));
    run_with("m.yaml");
    CHECK(contains(read_file(files / "m.yaml"), "joint_names:\n- joint_1\n"));
    write_file(files / "limits.yaml", "joint_limits: {joint_1: {max_velocity: 0.1}}");
    const Json slow = run_with("m.json", {"--velocity-scale", "0.5", "--dt", "0.1",
                                          "--joint-limits", files / "limits.yaml"});
    CHECK(slow["duration_s"] > 2 * duration);
    const Json motion = Json::parse(read_file(files / "m.json"));
    CHECK(motion["duration_s"] == slow["duration_s"]);
    CHECK(motion["times"][1] == 0.1);
    for (const char* key : {"velocity_use", "acceleration_use", "jerk_use"}) {
      REQUIRE(slow["motion"][key].size() == 8);
      for (const double share : slow["motion"][key]) CHECK(share <= 1 + 1e-6);
    }
    run_with("moving.json", {"--start-velocity", "-0.05,0,0,0,0,0,0,0"});
    CHECK(Json::parse(read_file(files / "moving.json"))["velocities"][0][0].get<double>() ==
          doctest::Approx(-0.05));
    run_with("ending.json", {"--end-velocity", "0,0.04,0,0,0,0,0,0"});
    CHECK(Json::parse(read_file(files / "ending.json"))["velocities"].back()[1].get<double>() ==
          doctest::Approx(0.04));
    const ProgramRun told = run_program({"plan", files.problem(), "--trajectory", files / "m.csv"});
    CHECK(contains(told.out, "\nmotion      "));
    CHECK(contains(told.out, "\nimproved    in "));
    const ProgramRun none = run_program(
        {"plan", files.problem(), "--max-iterations", "1", "--trajectory", files / "none.csv"});
    CHECK(none.exit_code == 3);
    CHECK(contains(none.err, "none.csv' was not written: there is no path"));
    CHECK_FALSE(std::filesystem::exists(files / "none.csv"));
  }

  TEST_CASE("a trajectory that cannot be written costs nothing else") {
    const PlanarFiles files;
    const ProgramRun run =
        run_program({"plan", files.problem(), "--json", "--svg", files / "plan.svg", "--trajectory",
                     files / "m.csv", "--dt", "0.0001", "--velocity-scale", "0.001"});
    CHECK(run.exit_code == 1);
    CHECK_MESSAGE(contains(run.err, "points"), run.err);
    CHECK(Json::parse(run.out)["path"].size() >= 2);
    CHECK(std::filesystem::exists(files / "plan.svg"));
  }

  TEST_CASE("a list of velocities ends with its word: the problem may follow") {
    const PlanarFiles files;
    for (const char* flag : {"--start-velocity", "--end-velocity"}) {
      require_run({"plan", flag, "0,0.01,0,0,0,0,0,0", files.problem()});
    }
  }

  TEST_CASE("flags of trajectories that are wrong are refused before anything is planned") {
    const PlanarFiles files;
    const std::string problem = files.problem(), csv = files / "m.csv";
    write_file(files / "bad.yaml", "joint_limits: {joint_1: {max_velocity: -1}}");
    check_bad_inputs(
        {{{"plan", problem, "--trajectory", "m.txt"}, 2, {"'m.txt'", "expected .csv, .json"}},
         {{"plan", problem, "--trajectory", csv, "--velocity-scale", "0"}, 2, {"0.001 to 1"}},
         {{"plan", problem, "--trajectory", csv, "--velocity-scale", "2"}, 2, {"--velocity-scale"}},
         {{"plan", problem, "--trajectory", csv, "--acceleration-scale", "nan"}, 2, {"nan"}},
         {{"plan", problem, "--trajectory", csv, "--dt", "0"}, 2, {"--dt"}},
         {{"plan", problem, "--trajectory", csv, "--dt", "-1"}, 2, {"--dt"}},
         {{"plan", problem, "--trajectory", csv, "--path-tolerance", "-1"}, 2, {"-1"}},
         {{"plan", problem, "--dt", "0.1"}, 2, {"--dt", "--trajectory"}},
         {{"plan", problem, "--joint-limits", csv}, 2, {"--joint-limits", "--trajectory"}},
         {{"plan", problem, "--trajectory", csv, "--joint-limits", files / "bad.yaml"},
          1,
          {"bad.yaml:1", "max_velocity", "above 0"}},
         {{"plan", problem, "--trajectory", csv, "--joint-limits", "/nowhere"}, 1, {"/nowhere"}},
         {{"plan", problem, "--trajectory", problem}, 1, {"the problem"}},
         {{"plan", problem, "--trajectory", "/nowhere/m.csv"}, 1, {"/nowhere/m.csv"}}});
  }

  TEST_CASE("the words for people name status, times, memory and path") {
    const PlanarFiles files;
    const ProgramRun run =
        require_run({"plan", files.problem(), "--db", files.database(), "--retrieve-after", "0"});
    CHECK(contains(run.out, "solved: rrt_connect, sampler gl, seed 1"));
    CHECK(contains(run.out, "1 primitive, 1 sampler retrieved"));
    CHECK(contains(run.out, "similarity error 0.000"));
    CHECK(contains(run.out, "configurations, length"));
  }

  TEST_CASE("the same seed gives the same path, and with memory the sampler is gl") {
    const PlanarFiles files;
    const std::vector<std::string> command = {
        "plan", files.problem(), "--db", files.database(), "--retrieve-after", "0", "--walk",
        "0",    "--seed",        "3",    "--json"};
    const Json first = Json::parse(run_program(command).out);
    const Json second = Json::parse(run_program(command).out);
    CHECK(first["sampler"] == "gl");
    CHECK(first["retrieved"] == 1);
    CHECK(first["components"] > 0);
    CHECK(first["path"] == second["path"]);
  }

  TEST_CASE("a database that may not be in memory gives the same path") {
    const PlanarFiles files;
    const std::vector<std::string> arguments = {"plan", files.problem(), "--db", files.database(),
                                                "--json"};
    const ProgramRun whole = run_program(arguments);
    CHECK_FALSE(std::filesystem::exists(files.database() + ".index"));
    std::vector<std::string> small = arguments;
    small.insert(small.end(), {"--db-memory", "0"});
    const ProgramRun partial = require_run(small);
    CHECK(std::filesystem::exists(files.database() + ".index"));
    CHECK(Json::parse(partial.out)["path"] == Json::parse(whole.out)["path"]);
    CHECK(Json::parse(partial.out)["components"] == Json::parse(whole.out)["components"]);
  }

  TEST_CASE("every planner and sampler of the help can be chosen") {
    const PlanarFiles files;
    for (const PlannerEntry& planner : planners()) {
      for (const char* sampler : {"gl", "uniform", "halton"}) {
        const ProgramRun run =
            run_program({"plan", files.problem(), "--planner", std::string(planner.name),
                         "--sampler", sampler, "--max-iterations", "50", "--json"});
        INFO(planner.name << " " << sampler << ": " << run.err);
        REQUIRE((run.exit_code == 0 || run.exit_code == 3));
        CHECK(Json::parse(run.out)["planner"] == planner.name);
        CHECK(Json::parse(run.out)["sampler"] == sampler);
      }
    }
  }

  TEST_CASE("an instruction set can be forced") {
    const PlanarFiles files;
    const ProgramRun run = require_run({"plan", files.problem(), "--isa", "scalar", "--json"});
    CHECK(Json::parse(run.out)["isa"] == "scalar");
  }

  TEST_CASE("a picture is written, also to a file with odd characters in its name") {
    const PlanarFiles files;
    const std::string picture = files / "a picture; of \"two\" \xc3\xa4\xff%s.svg";
    require_run({"plan", files.problem(), "--svg", picture});
    CHECK(contains(read_file(picture), "<svg"));
    CHECK(contains(read_file(picture), "</svg>"));
  }

  TEST_CASE("problems, databases and robots may have odd characters in their names") {
    const PlanarFiles files;
    const std::string problem = files / "-a b'c\"d$e \xff.yaml";
    const std::string database = files / "m m#?%20'.db";
    const std::string robot = files / "r [1].urdf";
    std::filesystem::copy_file(files.problem(), problem);
    std::filesystem::copy_file(files.database(), database);
    std::filesystem::copy_file(source_file("robots/planar8.urdf"), robot);
    const ProgramRun run = require_run(
        {"plan", problem, "--db", database, "--robot", robot, "--retrieve-after", "0", "--json"});
    CHECK(Json::parse(run.out)["retrieved"] == 1);
  }

  TEST_CASE("a primitive that the memory lacks is learned on the spot and kept") {
    const PlanarFiles files;
    const std::vector<std::string> command = {
        "plan",  files.problem(),     "--db", files / "new.db",    "--learn-budget",
        "30",    "--starts-per-link", "1",    "--paths-per-start", "1",
        "--json"};
    const ProgramRun first = require_run(command);
    CHECK(Json::parse(first.out)["learning_time_s"] > 0);
    const ProgramRun second = require_run(command);
    CHECK(Json::parse(second.out)["retrieved"] == 1);
    CHECK(Json::parse(second.out)["learning_time_s"] == 0);
  }

  TEST_CASE("problems of a compact file are planned by name") {
    const auto problems = data_file("planar/problems.json");
    if (!problems) return;
    require_run({"plan", *problems + "#S1", "--json"});
    check_bad_inputs({{{"plan", *problems + "#S99"}, 1, {"S99"}}});
  }

  TEST_CASE("an interrupt ends a search with exit code 130") {
    const PlanarFiles files;
    // A wall along the x axis that the first link cannot cross.
    std::vector<std::array<double, 3>> wall;
    for (double x = 0.5; x < 12; x += 0.4) {
      wall.push_back({x, 0, 0.3});
      wall.push_back({-x, 0, 0.3});
    }
    write_file(files / "locked.yaml", planar_problem_text(wall));
    RunningProgram program({"plan", files / "locked.yaml", "--sampler", "gl", "--timeout", "100",
                            "--start", "1.57,0,0,0,0,0,0,0", "--goal", "-1.57,0,0,0,0,0,0,0"});
    // The note that there is no memory comes once interrupts are caught.
    REQUIRE(contains(program.read_err(), "no memory"));
    program.send(SIGINT);
    const ProgramRun run = program.wait();
    CHECK_MESSAGE(run.exit_code == 130, run.err);
    CHECK(contains(run.out, "cancelled"));
  }

  TEST_CASE("an interrupt while a path is improved gives the best path so far, with a note") {
    const PlanarFiles files;
    for (const int signal_number : {SIGINT, SIGTERM}) {
      // An interrupt that comes before there is a path is tried again later.
      for (int wait_ms = 20; wait_ms <= 20480; wait_ms *= 2) {
        RunningProgram program({"plan", files.problem(), "--sampler", "gl", "--timeout", "1000",
                                "--improve", "900", "--json"});
        REQUIRE(contains(program.read_err(), "no memory"));
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
        program.send(signal_number);
        const ProgramRun run = program.wait();
        if (run.exit_code == 130 && wait_ms < 20480) continue;
        REQUIRE_MESSAGE(run.exit_code == 0, run.err);
        CHECK(Json::parse(run.out)["path"].size() >= 2);
        CHECK_MESSAGE(contains(run.err, "interrupted: the path is the best found so far"), run.err);
        CHECK_FALSE(contains(run.err, "takes too long"));
        break;
      }
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong flags are usage errors") {
    const std::string problem = "any.yaml";
    check_bad_inputs({
        {{"plan", problem, "--planner", "rrtt"}, 2, {"unknown planner 'rrtt'", "rrt_connect"}},
        {{"plan", problem, "--sampler", "sobol"}, 2, {"unknown sampler 'sobol'", "halton"}},
        {{"plan", problem, "--sampler", "cvae"}, 2, {"cvae needs a database: --db FILE"}},
        {{"plan", problem, "--bogus", "1"}, 2, {"--bogus"}},
        {{"plan", problem, "--upright", "fore:-1"}, 2, {"--upright", "'fore:-1'", "0.001 radians"}},
        {{"plan", problem, "--upright", "fore:nan"}, 2, {"--upright", "0.001 radians"}},
        {{"plan", problem, "--view", ""}, 2, {"--view", "expected the name of a file"}},
        {{"plan", problem, "--range", "-0.4"}, 2, {"--range", "'-0.4'", "0.001 to 1000"}},
        {{"plan", problem, "--lambda", "1.5"}, 2, {"--lambda", "'1.5'", "0 to 1"}},
        {{"plan", problem, "--lambda", "nan"}, 2, {"--lambda", "'nan'"}},
        {{"plan", problem, "--timeout", "1s"}, 2, {"--timeout", "'1s'", "a number"}},
        {{"plan", problem, "--timeout", "-1"}, 2, {"--timeout", "'-1'"}},
        {{"plan", problem, "--max-matches", "2.5"}, 2, {"--max-matches", "a whole number"}},
        {{"plan", problem, "--max-matches", "0"}, 2, {"--max-matches", "'0'", "1 to 1000000"}},
        {{"plan", problem, "--kind", "nope"}, 2, {"--kind", "'nope'", "pairs, body_pairs"}},
        {{"plan", problem, "--seed", "-1"}, 2, {"--seed", "'-1'"}},
        {{"plan", problem, "--seed", "99999999999999999999"}, 2, {"--seed"}},
        {{"plan", problem, "--start", "1,2,x"}, 2, {"--start", "item 3 is 'x'"}},
        {{"plan", problem, "--goal", "1,,2"}, 2, {"--goal", "item 2 is ''"}},
        {{"plan", problem, "--start", "0x10"}, 2, {"--start", "item 1 is '0x10'"}},
        {{"plan", problem, "--isa", "mmx"}, 2, {"--isa", "mmx"}},
        {{"plan", problem, "--learn-budget", "1"}, 2, {"--learn-budget", "--db"}},
        {{"plan", problem, "--remember-after", "0"}, 2, {"--remember-after", "--db"}},
        {{"plan", problem, "--replay", "0.5"}, 2, {"--replay", "--db"}},
        {{"plan", problem, "--timeout"}, 2, {"--timeout"}},
        {{"plan", problem, "--db", "m.db", "--db-memory", "-1"},
         2,
         {"--db-memory", "'-1'", "0 to 1000000"}},
        {{"plan", problem, "--db-memory", "1"}, 2, {"--db-memory", "requires --db"}},
        {{"plan", problem, "--db", ""}, 2, {"--db", "got an empty text"}},
    });
    const PlanarFiles files;
    check_bad_inputs({{{"plan", files.problem(), "--sampler", "gaussian"},
                       1,
                       {"'gaussian' is for planners", "ompl:PRM", "not 'rrt_connect'"}}});
  }

  TEST_CASE("files that are missing or malformed are failures that name the file") {
    const PlanarFiles files;
    write_file(files / "broken.yaml", "robot: [planar8\n");
    write_file(files / "scalar.yaml", "just text\n");
    write_file(files / "broken.json", "{\"problems\": [");
    write_file(files / "binary.yaml", std::string("\0\1\2\xff", 4));
    write_file(files / "broken.urdf", "<robot name=\"r\"><link name=\"a\">");
    write_file(files / "mesh.urdf",
               "<robot name=\"r\"><link name=\"a\"><collision><geometry>"
               "<mesh filename=\"m.stl\"/></geometry></collision></link></robot>");
    check_bad_inputs({
        {{"plan", files / "missing.yaml"}, 1, {"missing.yaml"}},
        {{"plan", files / "broken.yaml"}, 1, {"broken.yaml"}},
        {{"plan", files / "scalar.yaml"}, 1, {"scalar.yaml"}},
        {{"plan", files / "binary.yaml"}, 1, {"binary.yaml"}},
        {{"plan", files / "broken.json#a"}, 1, {"broken.json"}},
        {{"plan", files / ""}, 1, {files / ""}},
        {{"plan", files.problem(), "--robot", files / "missing.urdf"}, 1, {"missing.urdf"}},
        {{"plan", files.problem(), "--robot", "no_such_robot"}, 1, {"no_such_robot"}},
        {{"plan", files.problem(), "--robot", files / "broken.urdf"}, 1, {"broken.urdf"}},
        {{"plan", files.problem(), "--robot", files / "mesh.urdf"}, 1, {"mesh.urdf", "mesh"}},
    });
  }

  TEST_CASE("a start or goal that is no free configuration has an exit code of its own") {
    const PlanarFiles files;
    const std::string straight = "-2.2,0,0,0,0,0,0,0";
    check_bad_inputs({
        {{"plan", files.problem(), "--start", "1,2"}, 4, {"start", "8"}},
        {{"plan", files.problem(), "--start", "nan,0,0,0,0,0,0,0"}, 4, {"start"}},
        {{"plan", files.problem(), "--goal", "0,inf,0,0,0,0,0,0"}, 4, {"goal"}},
        {{"plan", files.problem(), "--goal", "0,3.5,0,0,0,0,0,0"}, 4, {"goal", "3.5"}},
        {{"plan", files.problem(), "--start", straight}, 4, {"start is in contact", "link"}},
        {{"plan", files.problem(), "--goal", straight}, 4, {"goal is in contact", "link"}},
    });
    const ProgramRun run = run_program({"plan", files.problem(), "--start", straight, "--json"});
    CHECK(Json::parse(run.out)["status"] == "invalid_start");
    CHECK(Json::parse(run.out)["solved"] == false);
    const std::string circle = make_circle_scene("", kTwoCircles).obstacles[1].name;
    CHECK_MESSAGE(contains(run.err, "'" + circle + "'"), run.err);
  }

  TEST_CASE("no path within the limit has an exit code of its own, with the result printed") {
    const PlanarFiles files;
    check_bad_inputs({{{"plan", files.problem(), "--timeout", "0"}, 3, {"no path"}},
                      {{"plan", files.problem(), "--max-iterations", "1"}, 3, {"no path"}}});
    const ProgramRun run = run_program({"plan", files.problem(), "--timeout", "0", "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["status"] == "timeout");
    CHECK(json["solved"] == false);
    CHECK(json["path"].empty());
  }

  TEST_CASE("a database that does not fit is refused") {
    const PlanarFiles files;
    write_file(files / "text.db", std::string(5000, 'x'));
    const std::string text = read_file(files.database());
    write_file(files / "half.db", text.substr(0, text.size() / 2));
    const std::string problem = files.problem();
    check_bad_inputs({
        {{"plan", problem, "--db", files / "missing.db"}, 1, {"missing.db", "'mneme learn' makes"}},
        {{"plan", problem, "--db", files / "text.db"}, 5, {"text.db"}},
        {{"plan", problem, "--db", files / "half.db"}, 5, {"half.db"}},
        {{"plan", problem, "--db", "postgresql://127.0.0.1:1/x"}, 1, {"postgresql"}},
        {{"plan", problem, "--db", "mysql://127.0.0.1/x"}, 1, {"mysql"}},
        {{"plan", files.short_arm_problem(), "--db", files.database()}, 5, {"planar8", "short"}},
        {{"plan", problem, "--db", files.database(), "--kind", "paths", "--learn-budget", "1"},
         1,
         {"learn-budget", "'paths'", "cannot learn while planning"}},
    });
    CHECK_FALSE(std::filesystem::exists(files / "missing.db"));
  }

  TEST_CASE("what is refused makes no memory") {
    const PlanarFiles files;
    const std::string database = files / "new.db";
    const auto plan = [&](const std::vector<std::string>& more) {
      std::vector<std::string> words = {"plan", files.problem(), "--db", database};
      words.insert(words.end(), more.begin(), more.end());
      return words;
    };
    check_bad_inputs({
        {plan({"--learn-budget", "1", "--kind", "paths"}), 1, {"cannot learn while planning"}},
        {plan({"--learn-budget", "1", "--sampler", "halton"}),
         1,
         {"'halton' does not query memory"}},
        {plan({"--learn-budget", "1", "--improve-rounds", "3"}), 1, {"improve-rounds"}},
        {plan({"--learn-budget", "1", "--planner", "prm", "--upright", "link_8:0.1"}),
         1,
         {"'prm' cannot keep constraints"}},
        {plan({"--remember-after", "1", "--replay", "1", "--kind", "pairs"}),
         1,
         {"'replay'", "'pairs'"}},
    });
    CHECK_FALSE(std::filesystem::exists(database));
  }

  TEST_CASE("a picture that cannot be written is a failure that names the file") {
    const PlanarFiles files;
    const std::string unwritable = files / "no/such/directory/p.svg";
    check_bad_inputs({{{"plan", files.problem(), "--svg", unwritable}, 1, {unwritable}},
                      {{"plan", files.problem(), "--svg", files / ""}, 1, {"cannot be written"}}});
    for (const char* flag : {"--svg", "--view", "--trace"}) {
      const ProgramRun early = run_program({"plan", files.problem(), flag, unwritable});
      CHECK_MESSAGE(early.out.empty(), early.out);
      CHECK(early.err ==
            "mneme: error: " + unwritable + ": cannot be written: No such file or directory\n");
    }
  }

  TEST_CASE("a new file may be named from where the program runs") {
    const PlanarFiles files;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(files / "");
    const ProgramRun run = run_program({"plan", "problem.yaml", "--svg", "p.svg"});
    std::filesystem::current_path(before);
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    CHECK(std::filesystem::exists(files / "p.svg"));
  }

  TEST_CASE("a path in space becomes a picture that moves, and no path none") {
    const PlanarFiles files;
    const std::string problem = source_file("scenes/shelf/thin.yaml");
    require_run({"plan", problem, "--svg", files / "moving.svg"});
    CHECK(contains(read_file(files / "moving.svg"), "<animate"));
    const ProgramRun stopped = run_program({"plan", problem, "--max-iterations", "1", "--svg",
                                            files / "p.svg", "--view", files / "p.html"});
    CHECK(stopped.exit_code == 3);
    CHECK(contains(stopped.err, "p.svg' was not written: there is no path"));
    CHECK(std::filesystem::exists(files / "p.html"));
    CHECK_FALSE(std::filesystem::exists(files / "p.svg"));
  }

  TEST_CASE("a memory that was not used says so") {
    const PlanarFiles files;
    const ProgramRun late = require_run(
        {"plan", files.problem(), "--db", files.database(), "--retrieve-after", "1000000"});
    CHECK(contains(late.out, "memory      not used: solved before"));
    const ProgramRun without =
        require_run({"plan", files.problem(), "--db", files.database(), "--sampler", "uniform"});
    CHECK_FALSE(contains(without.out, "memory"));
    CHECK(contains(without.err, "--db has no effect: the sampler 'uniform' uses no memory"));
    const ProgramRun off =
        require_run({"plan", files.problem(), "--db", files.database(), "--memory", "off"});
    CHECK(contains(off.out, "sampler uniform"));
  }

  TEST_CASE("a new memory of an arm in space remembers what was solved, and is found again") {
    const PlanarFiles files;
    const std::string problem = source_file("examples/own_robot/problem.yaml");
    const ProgramRun first =
        require_run({"plan", problem, "--db", files / "own.db", "--remember-after", "0", "--json"});
    CHECK(Json::parse(first.out)["remembered"] == "queued");
    const ProgramRun again = require_run({"plan", problem, "--db", files / "own.db", "--replay",
                                          "0", "--retrieve-after", "0", "--json"});
    const ProgramRun words = run_program(
        {"plan", problem, "--db", files / "own.db", "--replay", "0", "--retrieve-after", "0"});
    CHECK(
        contains(words.out, "\n  query to goal 1: 1 match, similarity error 0.000 to 0.000 rad^2"));
    CHECK(Json::parse(again.out)["retrieved"] > 0);
    const ProgramRun uniform = run_program(
        {"plan", problem, "--db", files / "own.db", "--sampler", "uniform", "--replay", "0.5"});
    CHECK(contains(uniform.out, "\nknown task  replayed row 1, 0.000 rad away\n"));
    // Planned in fewer iterations than pass before memory is asked.
    const ProgramRun automatic = require_run({"plan", problem, "--db", files / "own.db"});
    CHECK_FALSE(contains(automatic.out, "known task"));
    CHECK_FALSE(std::filesystem::exists(files / "own.db.index"));
    const ProgramRun small =
        require_run({"plan", problem, "--db", files / "own.db", "--json", "--replay", "0",
                     "--retrieve-after", "0", "--db-memory", "0"});
    CHECK(std::filesystem::exists(files / "own.db.index"));
    CHECK(Json::parse(small.out)["path"] == Json::parse(again.out)["path"]);
  }

  TEST_CASE("a path that teaches nothing is not called queued") {
    const PlanarFiles files;
    // Local samplers are learned for pairs of obstacles.
    write_file(files / "one.yaml",
               "robot: planar8\nstart: [0.1, 0, 0, 0, 0, 0, 0, 0]\n"
               "goal: [1.5, 0.2, 0, 0, 0, 0, 0, 0]\nscene: {circles: {a: [3.5, 3.5, 0.3]}}\n");
    const ProgramRun run = require_run({"plan", files / "one.yaml", "--remember-after", "0",
                                        "--kind", "pairs", "--db", files / "new.db", "--json"});
    CHECK(Json::parse(run.out)["remembered"] == 0);
    CHECK_FALSE(std::filesystem::exists(files / "new.db"));
  }

  TEST_CASE("a picture replaces the old one whole and leaves no temporary file") {
    const PlanarFiles files;
    write_file(files / "p.svg", std::string(1 << 20, 'x'));
    require_run({"plan", files.problem(), "--svg", files / "p.svg"});
    CHECK_FALSE(contains(read_file(files / "p.svg"), "xxx"));
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(files / "")) {
      count += entry.path().filename().string().starts_with("p.svg");
    }
    CHECK(count == 1);
  }

  TEST_CASE("a start given on the command line replaces the problem's") {
    const PlanarFiles files;
    const ProgramRun run = require_run(
        {"plan", files.problem(), "--start", list_of(kGoal), "--goal", list_of(kGoal), "--json"});
    CHECK(Json::parse(run.out)["path_length"] == doctest::Approx(0).epsilon(1e-6));
  }
}

}  // namespace
}  // namespace mneme::test

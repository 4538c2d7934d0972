// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <sys/stat.h>
#include <array>
#include <chrono>
#include <thread>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("the version goes to standard output") {
    const ProgramRun run = require_run({"--version"});
    CHECK(run.out == "mneme " + std::string(version()) + "\n");
    CHECK(run.err.empty());
  }

  TEST_CASE("help ends with examples and exit codes") {
    const ProgramRun run = require_run({"--help"});
    CHECK(contains(run.out, "mneme plan scenes/planar/scenario1.yaml"));
    CHECK(run.out.find("Examples:") > run.out.find("Subcommands:"));
    CHECK(contains(run.out, "130 interrupted"));
  }

  TEST_CASE("the help of every subcommand shows an example of it") {
    const std::vector<std::vector<std::string>> commands = {{"demo"},           {"plan"},
                                                            {"learn"},          {"db", "info"},
                                                            {"db", "list"},     {"db", "query"},
                                                            {"db", "verify"},   {"robot", "info"},
                                                            {"robot", "check"}, {"robot", "planar"},
                                                            {"scene", "info"},  {"doctor"},
                                                            {"completion"},     {"manual"}};
    for (std::vector<std::string> command : commands) {
      std::string example = "  mneme";
      for (const std::string& word : command) example += " " + word;
      command.emplace_back("--help");
      const ProgramRun run = run_program(command);
      INFO(example);
      CHECK(run.exit_code == 0);
      CHECK(contains(run.out, "Example:\n" + example));
    }
  }

  TEST_CASE("help shows each setting's sentence, default and range") {
    const ProgramRun run = run_program({"plan", "--help-all"});
    CHECK(contains(run.out, "--lambda"));
    CHECK(contains(run.out, "Probability of a sample from memory"));
    CHECK(contains(run.out, "(default 0.05; 0 to 1)"));
    CHECK(contains(run.out, "--no-simplify"));
    CHECK(contains(run.out, "--starts-per-link"));
    CHECK(contains(run.out, "--max-gap"));
  }

  TEST_CASE("the help of plan fits one screen and says where the rest is") {
    const std::string usual = run_program({"plan", "--help"}).out;
    for (const char* text : {"Usual:", "Problem:", "Output:", "--timeout", "--db ", "--memory",
                             "--improve", "More flags: --help-all"}) {
      CHECK_MESSAGE(contains(usual, text), text);
    }
    CHECK_MESSAGE(std::ranges::count(usual, '\n') <= 40, usual);
    CHECK_FALSE(contains(usual, "--planner"));
    const std::string all = run_program({"plan", "--help-all"}).out;
    for (const char* text :
         {"Planner, more:", "Memory, more:", "--goal-bias", "Defaults by kind of memory:"}) {
      CHECK_MESSAGE(contains(all, text), text);
    }
    CHECK_FALSE(contains(all, "More flags"));
  }

  TEST_CASE("a wrong command line is a usage error with a suggestion") {
    check_bad_inputs({
        {{}, 2, {"subcommand is required", "see 'mneme --help'"}},
        {{"plam"}, 2, {"unexpected argument 'plam'", "did you mean 'plan'?"}},
        {{"nosuch", "--help"}, 2, {"unexpected argument 'nosuch'"}},
        {{"xyzzy"}, 2, {"unexpected argument 'xyzzy'", "see 'mneme --help'"}},
        {{"db", "inof", "x.db"},
         2,
         {"unexpected argument 'inof'", "did you mean 'info'?", "see 'mneme db --help'"}},
        {{"db"}, 2, {"subcommand is required", "see 'mneme db --help'"}},
        {{"--bogus"}, 2, {"--bogus"}},
        {{"plan", "p.yaml", "--timout", "1"}, 2, {"--timout", "did you mean '--timeout'?"}},
        {{"plan", "p.yaml", "--planner", "RRTConnect"}, 2, {"did you mean 'rrt_connect'?"}},
        {{"plan", "p.yaml", "--sampler", "haltn"}, 2, {"did you mean 'halton'?"}},
        {{"plan", source_file("robots/ur5.urdf")}, 1, {"this is XML", "expected a problem"}},
        {{"plan"}, 2, {"PROBLEM is required", "see 'mneme plan --help'"}},
        {{"plan", "a.yaml", "b.yaml"}, 2, {"b.yaml"}},
        {{"plan", "p.yaml", "--db"}, 2, {"--db: 1 required TEXT missing"}},
        {{"plan", "p.yaml", "--timeout"}, 2, {"--timeout: 1 required X missing"}},
    });
  }

  TEST_CASE("a flag with an equals sign and no value does not take the next word") {
    const TemporaryDirectory files;
    const std::string flag = "--trace=: expected a value after '='";
    check_bad_inputs({
        {{"plan", "p.yaml", "--trace=", "--continuous"}, 2, {flag, "see 'mneme --help'"}},
        {{"plan", "p.yaml", "--trace="}, 2, {flag}},
        {{"bench", "run", "p.yaml", "--csv=", "a"}, 2, {"--csv=: expected a value"}},
        {{"--version="}, 2, {"--version=: expected a value"}},
        // Words that end in an equals sign are values like any others.
        {{"db", "info", files / "a="}, 1, {"a="}},
        {{"plan", files / "p=", "--db", files / "a="}, 1, {"p="}},
        {{"plan", "--", "--p="}, 1, {"--p="}},
    });
  }

  TEST_CASE("a full standard output is a failure") {
    if (!std::filesystem::exists("/dev/full")) return;
    const std::string command =
        std::string(MNEME_PROGRAM) + " robot info planar8 >/dev/full 2>/dev/null";
    const int status = std::system(command.c_str());
    CHECK(WEXITSTATUS(status) == 1);
  }

  TEST_CASE("an interrupt ends a command that waits for a file") {
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    RunningProgram program({"scene", "info", fmt::format("/dev/fd/{}", ends[0])});
    REQUIRE(write(ends[1], "#", 1) == 1);
    int unread = 1;
    for (int i = 0; i < 60'000 && unread > 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      REQUIRE(ioctl(ends[1], FIONREAD, &unread) == 0);
    }
    program.send(SIGINT);
    CHECK(program.wait().exit_code == 130);
    for (const int end : ends) close(end);
  }

  TEST_CASE("a pipe that is named as a file is refused") {
    const TemporaryDirectory files;
    const std::string pipe = files / "scene.yaml";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(RunningProgram({"scene", "info", pipe}).wait().exit_code == 1);
  }

#ifndef __SANITIZE_ADDRESS__
  TEST_CASE("memory that runs out in a thread that searches is an error") {
    const TemporaryDirectory files;
    std::string circles;  // the first link cannot cross this wall along the x axis
    for (double x = 0.5; x < 12; x += 0.4) {
      circles += fmt::format("[{}, 0, 0.3], [{}, 0, 0.3], ", x, -x);
    }
    write_file(
        files / "p.yaml",
        fmt::format("robot: planar8\nscene: {{circles: [{}]}}\n"
                    "start: [1.57, 0, 0, 0, 0, 0, 0, 0]\ngoal: [-1.57, 0, 0, 0, 0, 0, 0, 0]\n",
                    circles));
    constexpr std::size_t kMostBytes = 60'000 << 10;
    const ProgramRun run = run_program(
        {"plan", files / "p.yaml", "--threads", "2", "--timeout", "60", "--max-nodes", "100000000"},
        {{}, false, kMostBytes});
    CHECK_MESSAGE(run.exit_code == 1, run.err);
    CHECK_MESSAGE(contains(run.err, "memory ran out"), run.err);
  }
#endif

  TEST_CASE("messages carry no colour codes unless a terminal reads them") {
    const ProgramRun run = run_program({"plam"}, {{"TERM=xterm"}, false});
    CHECK_FALSE(contains(run.err, "\033"));
  }
}

}  // namespace
}  // namespace mneme::test

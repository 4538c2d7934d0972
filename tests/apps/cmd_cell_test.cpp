// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/run_program.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kRegion = R"(robot: panda
scene:
  obstacles:
    - {name: table, type: box, position: [0.5, 0, 0.1], size: [0.6, 1.2, 0.04]}
start: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
goal: {link: panda_hand, position: [0.5, 0, 0.35], quat_xyzw: [1, 0, 0, 0]}
region: {x: 0.04, y: 0.04, starts: {side: [0.4, -0.785, 0, -2.356, 0, 1.571, 0.785]}}
)";

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a cell whose start is in contact is not built, and exits as other invalid starts") {
    const TemporaryDirectory directory;
    std::string text = kRegion;
    const std::string low = "0.5, 0, 0.1]";
    text.replace(text.find(low), low.size(), "0.3, 0, 0.55]");
    write_file(directory / "region.yaml", text);
    const ProgramRun built = run_program(
        {"cell", "build", directory / "region.yaml", "-o", directory / "a.cell", "--boxes", "20"});
    CHECK_MESSAGE(built.exit_code == 4, built.err);
    CHECK(contains(built.err, "touches obstacle 'table'"));
  }

  TEST_CASE("a cell is built, queried, verified and shown") {
    const TemporaryDirectory directory;
    const std::string region = directory / "region.yaml", cell = directory / "a.cell";
    write_file(region, kRegion);
    const ProgramRun built =
        require_run({"cell", "build", region, "-o", cell, "--boxes", "20", "--json"});
    const Json summary = Json::parse(built.out);
    CHECK(summary["boxes"] > 0);
    CHECK(summary["starts"].size() == 2);
    CHECK(summary["starts"][1]["start"] == "side");
    CHECK(summary["starts"][0]["proven"] > 0.95);

    const ProgramRun asked =
        require_run({"cell", "query", cell, "--at", "0.01,-0.02", "--start", "side", "--json"});
    const Json answer = Json::parse(asked.out);
    CHECK(answer["tier"] == "certified");
    CHECK(answer["path"][0][0] == 0.4);
    CHECK_FALSE(answer.contains("motion"));
    const std::string csv = directory / "a.csv";
    const ProgramRun timed =
        require_run({"cell", "query", cell, "--at", "0.01,-0.02,0,0", "--trajectory", csv});
    CHECK(contains(timed.out, "s, as of all tasks of the box"));
    CHECK(read_file(csv).starts_with("time,"));
    CHECK(run_program({"cell", "query", cell, "--at", "0,0,0,0", "--trajectory", region + ".txt"})
              .exit_code == 2);

    const ProgramRun blended =
        run_program({"cell", "query", cell, "--at", "0,0,0,0", "--trajectory",
                     directory / "blended.csv", "--blend-tolerance", "0"});
    CHECK(blended.exit_code == 2);

    const ProgramRun verified = require_run({"cell", "verify", cell, "--samples", "50"});
    CHECK(contains(verified.out, "0 in contact"));

    const ProgramRun shown = require_run({"cell", "show", cell});
    CHECK(contains(shown.out, "proven for the modelled scene"));
    CHECK(contains(shown.out, "paths change by 0.5 rad or more across 0 of "));

    const std::string page = directory / "a.html";
    require_run({"cell", "show", cell, "--view", page});
    CHECK(contains(read_file(page), "<html"));
    CHECK(run_program({"cell", "show", cell, "--view", cell}).exit_code != 0);

    const ProgramRun more =
        require_run({"cell", "build", region, "-o", cell, "--boxes", "20", "--resume", "--json"});
    CHECK(Json::parse(more.out)["boxes"] >= summary["boxes"]);
  }

  TEST_CASE("wrong words of a cell are explained") {
    const TemporaryDirectory directory;
    const std::string region = directory / "region.yaml", cell = directory / "a.cell";
    write_file(region, kRegion);
    require_run({"cell", "build", region, "-o", cell, "--boxes", "1"});
    const ProgramRun start = run_program({"cell", "query", cell, "--at", "0", "--start", "sude"});
    CHECK(start.exit_code == 1);
    CHECK(contains(start.err, "did you mean 'side'?"));
    CHECK(run_program({"cell", "query", cell, "--at", "0,0,0,0,0"}).exit_code == 2);
    const ProgramRun beyond = run_program({"cell", "query", cell, "--at", "1"});
    CHECK(beyond.exit_code == 3);
    CHECK(contains(beyond.err, "beyond the region: x is 1, expected at most"));
    CHECK(contains(beyond.err, "--at 1: taken as 0: y, z, yaw"));
    const ProgramRun nan = run_program({"cell", "query", cell, "--at", "0,0,nan,0"});
    CHECK(nan.exit_code == 2);
    CHECK(contains(nan.err, "--at: z is nan: expected a finite number"));
    write_file(cell, "no cell");
    const ProgramRun damaged = run_program({"cell", "show", cell});
    CHECK(damaged.exit_code == 5);
    CHECK(contains(damaged.err, "mneme cell, version 2"));
    const ProgramRun replaced = run_program({"cell", "build", region, "-o", cell, "--boxes", "1"});
    CHECK(replaced.exit_code == 1);
    CHECK(contains(replaced.err, "the output exists and is no cell"));
    CHECK(read_file(cell) == "no cell");
    const ProgramRun itself = run_program({"cell", "build", region, "-o", region});
    CHECK(itself.exit_code != 0);
    CHECK(contains(itself.err, "region"));
  }

  TEST_CASE("a region out of reach is said to be, and a task without an answer") {
    const TemporaryDirectory directory;
    std::string text = kRegion;
    const std::string near = "position: [0.5, 0, 0.35], quat";
    text.replace(text.find(near), near.size(), "position: [2.5, 0, 0.35], quat");
    write_file(directory / "region.yaml", text);
    const std::string cell = directory / "a.cell";
    const ProgramRun built =
        run_program({"cell", "build", directory / "region.yaml", "-o", cell, "--boxes", "20"});
    CHECK(built.exit_code == 3);
    CHECK(
        contains(built.err, "configuration of link panda_hand in the region; it is out of reach"));
    const ProgramRun asked =
        run_program({"cell", "query", cell, "--at", "0,0,0,0", "--timeout", "0"});
    CHECK(asked.exit_code == 3);
    CHECK(contains(asked.err, "no proven box and no path of a near box leads to the task"));
  }

  TEST_CASE("regions are made around goals, and can be built") {
    const TemporaryDirectory directory;
    std::string problem = kRegion;
    problem.resize(problem.find("region:"));
    write_file(directory / "task.yaml", problem);
    const ProgramRun made =
        require_run({"cell", "regions", directory / "task.yaml", "--link", "panda_hand",
                     "--extents", "0.02,0.02,0,0.1", "--tries", "3", "-o", directory / "made"});
    const std::string region = made.out.substr(0, made.out.find('\n'));
    require_run({"cell", "build", region, "-o", directory / "a.cell", "--boxes", "5"});
    write_file(directory / "task_yaml", problem);
    const ProgramRun twice = run_program(
        {"cell", "regions", directory / "task.yaml", directory / "task.yaml", "--link",
         "panda_hand", "--extents", "0.02,0.02,0,0.1", "--tries", "3", "-o", directory / "made"});
    CHECK(twice.exit_code == 1);
    CHECK(contains(twice.err, "has the region of another problem of this name"));
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/run_program.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// The text without its part from `from` to the next `to`.
std::string without(std::string text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  REQUIRE(begin != std::string::npos);
  return text.erase(begin, text.find(to, begin) - begin);
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("the examples of tasks are planned, timed and shown") {
    for (const char* example : {"pick_and_place", "machine_tending"}) {
      INFO(example);
      const std::string task = source_file(std::string("examples/") + example + "/task.yaml");
      const TemporaryDirectory directory;
      const std::string page = directory / "page.html", motion = directory / "motion.json";
      const ProgramRun run = require_run(
          {"plan", task, "--json", "--view", page, "--trajectory", motion, "--seed", "7"});
      const Json plan = Json::parse(run.out);
      CHECK(plan["status"] == "solved");
      CHECK(plan["stages"].size() == 9);
      CHECK(plan["stages"][1]["alternatives"] >= 40);
      CHECK(plan["stages"][1]["alternative"] >= 0);
      const Json timed = Json::parse(read_file(motion));
      CHECK(plan["duration_s"] == doctest::Approx(timed["duration_s"].get<double>()));
      REQUIRE(timed["stages"].size() == 9);
      for (std::size_t i = 0; i < 9; ++i) {
        CHECK(timed["stages"][i]["name"] == plan["stages"][i]["name"]);
        CHECK(timed["stages"][i]["begin_s"] == plan["stages"][i]["begin_s"]);
      }
      CHECK(timed["duration_s"] > plan["path_time_s"]);
      // The object is a link of the page's trace, and no obstacle.
      const std::string html = read_file(page);
      CHECK(contains(html, "\"planner\":\"task, rrt_connect\""));
      CHECK(contains(html, "\"sampler\":\"uniform\",\"seed\":7,"));
      CHECK(contains(html, "\"isa\":\"" + std::string(to_string(default_isa())) + "\""));
      CHECK(!contains(html, "\"motions_checked\":0,"));
      CHECK(!contains(html, "\"nodes\":0"));
      const std::string object = example == std::string("pick_and_place") ? "mug" : "blank";
      CHECK(contains(html, "\"carrier\":\"panda_hand\""));
      CHECK(!contains(html, "{\"name\":\"" + object + "\",\"shapes\""));
    }
  }

  TEST_CASE("a task without a plan has the exit code of wrong ends, and says why") {
    const TemporaryDirectory directory;
    std::string text = read_file(source_file("examples/pick_and_place/task.yaml"));
    text.replace(text.find("[0.5, -0.1, 0.2505]"), 19, "[2.5, -0.1, 0.2505]");
    write_file(directory / "task.yaml", text);
    const ProgramRun run =
        run_program({"plan", directory / "task.yaml", "--view", directory / "a.html"});
    CHECK(run.exit_code == 4);
    CHECK(contains(run.err, "stage 'approach' of 100 alternatives: 100 times out of reach"));
    CHECK(contains(run.err, "was not written: there is no plan"));
    CHECK(contains(run.out, "dropped 100: out of reach, link 'panda_hand'"));
  }

  TEST_CASE("choices of a task are remembered in a database that planning makes") {
    const TemporaryDirectory directory;
    const std::string task = source_file("examples/pick_and_place/task.yaml");
    const std::vector<std::string> words = {
        "plan", task, "--db", directory / "tasks.db", "--replay", "0.5", "--remember-after", "0"};
    const ProgramRun first = require_run(words), second = run_program(words);
    REQUIRE_MESSAGE(second.exit_code == 0, second.err);
    CHECK(!contains(first.out, "ranked the alternatives"));
    CHECK(contains(second.out, "memory      1 plan ranked the alternatives"));
    CHECK(!contains(first.out, "  choice 0 of"));
  }

  TEST_CASE("flags that mean nothing for a task are noted, and mistakes have their line") {
    const std::string task = source_file("examples/pick_and_place/task.yaml");
    const ProgramRun run = require_run({"plan", task, "--goal", "0,0,0,0,0,0,0"});
    CHECK(contains(run.err, "--goal and --goal-pose have no effect"));
    const ProgramRun moving = run_program({"plan", task, "--end-velocity", "0,0,0,0,0,0,0.1"});
    CHECK(moving.exit_code != 0);
    CHECK(contains(moving.err, "--end-velocity: a task ends at rest"));
    const ProgramRun learnt = run_program({"bench", "run", task, "--seeds", "1"});
    CHECK(learnt.exit_code != 0);
    CHECK(contains(learnt.err,
                   "key stages: this is a task; expected a problem with a goal. `mneme "
                   "plan`"));
    const TemporaryDirectory directory;
    write_file(directory / "task.yaml",
               without(read_file(task), "  - {name: grasp", "  - {name: lift"));
    const ProgramRun wrong = run_program({"plan", directory / "task.yaml"});
    CHECK(wrong.exit_code == 1);
    CHECK(contains(wrong.err, "stage 'lower': expected a held object, got 'mug'"));
  }
}

}  // namespace mneme::test

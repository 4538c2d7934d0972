// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

const std::string kPandaStart = "0,-0.785,0,-2.356,0,1.571,0.785";

/// mneme line panda from a usual configuration.
std::vector<std::string> line_of(std::vector<std::string> more) {
  std::vector<std::string> words = {"line",      "panda",  "--start",
                                    kPandaStart, "--link", "panda_hand"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST_SUITE("flow") {
  TEST_CASE("a link moves along a line, and the motion is timed") {
    const TemporaryDirectory directory;
    const ProgramRun run = require_run(line_of({"--by", "0,0.1,-0.1", "--json"}));
    const Json json = Json::parse(run.out);
    CHECK(json["is_whole"] == true);
    CHECK(json["fractions"].back() == 1);
    CHECK(json["path"].size() == json["fractions"].size());
    CHECK(json["position_deviation"] <= 1e-4);
    const std::string file = directory / "line.csv";
    const ProgramRun timed = require_run(line_of({"--by", "0,0.1,-0.1", "--trajectory", file}));
    CHECK(contains(timed.out, "motion      "));
    CHECK(contains(read_file(file), "panda_joint1"));
  }

  TEST_CASE("a line starts at a pose, and ends at a position") {
    const ProgramRun run = require_run({"line", "panda", "--from", "panda_hand:0.4,0.1,0.5,1,0,0,0",
                                        "--to", "panda_hand:0.4,0.1,0.3", "--json"});
    CHECK(Json::parse(run.out)["branches"] > 0);
  }

  TEST_CASE("the help states the defaults of a line's motion") {
    const std::string help = require_run({"line", "--help-all"}).out;
    const auto of_flag = [&](const std::string& flag) {
      const std::string text = help.substr(help.find(flag));
      return text.substr(text.find("(default"), 13);
    };
    CHECK(of_flag("--path-tolerance X") == "(default 0.00");
    CHECK(of_flag("--time-rounds N") == "(default 0; 0");
  }

  TEST_CASE("a line that is not possible has an exit code and a reason") {
    const ProgramRun run = run_program(line_of({"--by", "2,0,0"}));
    CHECK(run.exit_code == 3);
    CHECK(contains(run.err, "branch ends after "));
    CHECK(contains(run.out, "deviation   at most "));
    const TemporaryDirectory directory;
    const std::string file = directory / "line.csv";
    const ProgramRun timed = run_program(line_of({"--by", "2,0,0", "--trajectory", file}));
    CHECK(timed.exit_code == 3);
    CHECK(contains(timed.err, "'" + file + "' was not written: the line is not whole"));
    CHECK_FALSE(std::filesystem::exists(file));
  }

  TEST_CASE("a trajectory replaces nothing that the line is read from") {
    const TemporaryDirectory directory;
    const std::string text = "name: empty\nobstacles: []\n";
    const std::string scene = directory / "scene.yaml";
    write_file(scene, text);
    const ProgramRun run =
        run_program(line_of({"--by", "0,0,-0.1", "--scene", scene, "--trajectory", scene}));
    CHECK(run.exit_code == 1);
    CHECK(contains(run.err, "is also an input"));
    CHECK(read_file(scene) == text);
  }

  TEST_CASE("a line that cannot start is told from one that found no path") {
    std::vector<std::string> words = line_of({"--by", "0,0,0.1"});
    words[3] = "0,-0.785,0,-2.356,0,1.571,9";
    const ProgramRun beyond = run_program(words);
    CHECK(beyond.exit_code == 4);
    CHECK(contains(beyond.err, "start: joint 'panda_joint7' "));
    CHECK_FALSE(contains(beyond.out, "deviation"));
    const ProgramRun late = run_program(line_of({"--by", "0,0,0.1", "--timeout", "0"}));
    CHECK(late.exit_code == 3);
    CHECK_FALSE(contains(late.out, "deviation"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong lines end with a message and an exit code") {
    check_bad_inputs({
        {{"line", "panda", "--by", "0,0,0.1"}, 1, {"the line starts nowhere"}},
        {line_of({}), 2, {"--by, --to: expected one of both"}},
        {line_of({"--by", "0,0"}), 2, {"'0,0' is not X,Y,Z in metres"}},
        {line_of({"--by", "0,0,0"}), 1, {"has no length"}},
        {line_of({"--by", "0,nan,0"}), 2, {"--by", "'0,nan,0' is not X,Y,Z in metres"}},
        {line_of({"--by", "1e308,1e308,0"}), 1, {"m long: expected metres, at most 100"}},
        {line_of({"--by", "0,0,0.1", "--frame", "table"}), 1, {"\"table\" is no link of robot"}},
        {line_of({"--by", "0,0,0.1", "--free-axis", "w"}), 2, {"'w' is not x, y or z"}},
        {line_of({"--to", "panda_link7:0,0,1"}), 2, {"'panda_link7' is not the link"}},
        {line_of({"--by", "0,0,0.1", "--from", "panda_hand:0,0,1"}),
         2,
         {"expected one pose with a quaternion"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

namespace mneme::test {
namespace {

/// A directory of scenes with one problem and a small grid.
std::string small_scenes(const PlanarFiles& files) {
  const std::string directory = files / "scenes";
  std::filesystem::create_directories(directory + "/planar");
  std::filesystem::copy_file(files.problem(), directory + "/planar/scenario1.yaml");
  write_file(directory + "/planar/grid.yaml",
             "radius: [1.7, 1.9]\ngap: [0.3, 0.5]\ndistance: [4, 5]\n"
             "max_similarity_error: 3\ncount: 2\n");
  return directory;
}

TEST_SUITE("flow") {
  TEST_CASE(
      "the demo learns, plans, and leaves database, table and report, and again it only plans") {
    const PlanarFiles files;
    const std::string out = files / "out/demo";
    const std::vector<std::string> command = {
        "demo", "--scenes", small_scenes(files), "--out", out, "--seeds", "2", "--timeout", "0.3"};
    const ProgramRun run = require_run(command);
    CHECK(contains(run.err, "skipped: there is no"));
    CHECK(contains(run.out, "rrt_connect"));
    CHECK(contains(run.out, out + "/report.html"));
    const std::string report = read_file(out + "/report.html");
    CHECK(contains(report, "<svg"));
    CHECK(contains(report, "gl against difficulty"));
    // Pictures open what they show.
    const std::size_t link = report.find("<a href=\"", report.find("class=\"pictures\""));
    REQUIRE(link != std::string::npos);
    const std::size_t begin = link + 9;
    const std::string page = report.substr(begin, report.find('"', begin) - begin);
    CHECK(contains(read_file(out + "/" + page), "mneme-trace"));
    CHECK(contains(read_file(out + "/results.csv"), "rrt_connect,gl"));
    require_run({"db", "verify", out + "/planar.db"});

    std::vector<std::string> again = command;
    again.emplace_back("--json");
    const ProgramRun second = require_run(again);
    const auto json = nlohmann::json::parse(second.out);
    CHECK(json["learned"] == 0);
    CHECK(json["rows"].size() == 12);
    for (const auto& row : json["rows"]) CHECK(row["is_solved"] == row["is_path_valid"]);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a demo that cannot start ends with a message and an exit code") {
    const PlanarFiles files;
    const std::string scenes = small_scenes(files);
    write_file(files / "file", "");
    check_bad_inputs({
        {{"demo", "--seeds", "0"}, 2, {"--seeds", "'0'"}},
        {{"demo", "--timeout", "nan"}, 2, {"--timeout"}},
        {{"demo", "extra"}, 2, {"extra"}},
        {{"demo", "--scenes", files / "none", "--out", files / "o"}, 1, {"grid.yaml"}},
        {{"demo", "--scenes", scenes, "--out", files / "file/o"}, 1, {"file/o"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test

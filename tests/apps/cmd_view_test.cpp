// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

#include <nlohmann/json.hpp>

namespace mneme {
namespace {

using test::check_bad_inputs;
using test::contains;
using test::PlanarFiles;
using test::ProgramRun;
using test::require_run;
using test::run_program;

TEST_SUITE("flow") {
  TEST_CASE("plan writes page and trace, and view makes the same page of the trace") {
    const PlanarFiles files;
    require_run({"plan", files.problem(), "--db", files.database(), "--retrieve-after", "0",
                 "--walk", "0", "--seed", "3", "--view", files / "plan.html", "--trace",
                 files / "plan.json"});
    const auto trace = nlohmann::json::parse(test::read_file(files / "plan.json"));
    CHECK(trace.at("format") == "mneme-trace");
    CHECK(trace.at("waypoints").size() > 100);
    CHECK(trace.at("primitives").size() == 1);
    CHECK(trace.at("components").at("shown").size() > 0);
    CHECK(trace.at("samples").at("shown").size() > 0);
    CHECK(trace.at("edges").at("shown").size() > 0);

    const ProgramRun view = require_run({"view", files / "plan.json", "-o", files / "view.html"});
    CHECK(view.out == files / "view.html" + std::string("\n"));
    const std::string page = test::read_file(files / "view.html");
    CHECK(contains(page, "<!DOCTYPE html>"));
    CHECK(page == test::read_file(files / "plan.html"));
  }

  TEST_CASE("Being watched does not change the path") {
    const PlanarFiles files;
    std::vector<nlohmann::json> paths;
    for (const bool is_watched : {false, true}) {
      std::vector<std::string> arguments = {"plan", files.problem(), "--json", "--seed", "5"};
      if (is_watched) arguments.insert(arguments.end(), {"--trace", files / "t.json"});
      const ProgramRun run = require_run(arguments);
      paths.push_back(nlohmann::json::parse(run.out).at("path"));
    }
    CHECK(paths[0] == paths[1]);
  }

  TEST_CASE("A plan that fails has a page too, with what was tried") {
    const PlanarFiles files;
    const ProgramRun run =
        run_program({"plan", files.problem(), "--max-iterations", "40", "--walk", "0", "--view",
                     files / "p.html", "--trace", files / "t.json"});
    CHECK(run.exit_code == 3);
    const auto trace = nlohmann::json::parse(test::read_file(files / "t.json"));
    CHECK(trace.at("waypoints").empty());
    CHECK(trace.at("samples").at("shown").size() > 0);
    CHECK(contains(test::read_file(files / "p.html"), "<!DOCTYPE html>"));
  }

  TEST_CASE("Without a usable start there is no page, and a note says why") {
    const PlanarFiles files;
    const ProgramRun run = run_program(
        {"plan", files.problem(), "--start", "0,9,0,0,0,0,0,0", "--view", files / "p.html"});
    CHECK(run.exit_code == 4);
    CHECK(contains(run.err, "was not written: start or goal is no configuration"));
    CHECK_FALSE(std::filesystem::exists(files / "p.html"));
  }

  TEST_CASE("Wrong traces and places are named") {
    const PlanarFiles files;
    test::write_file(files / "no.json", "{}");
    test::write_file(files / "empty.json", "");
    check_bad_inputs(
        {{{"view"}, 2, {"TRACE"}},
         {{"view", files / "no.json"}, 2, {"--output"}},
         {{"view", "--live", files / "p.html"}, 2, {"--live", "--problem, --robot"}},
         {{"view", files / "no.json", "--live", files / "p.html"}, 2, {"--live", "no trace"}},
         {{"view", "--robot", "panda"}, 2, {"--live"}},
         {{"view", files / "no.json", "-o", files / "p.html"},
          1,
          {files / "no.json", "mneme-trace"}},
         {{"view", files.problem(), "-o", files / "p.html"}, 1, {"not JSON", "plan --trace"}},
         {{"view", files / "empty.json", "-o", files / "p.html"}, 1, {"empty.json"}},
         {{"view", files / "missing.json", "-o", files / "p.html"},
          1,
          {files / "missing.json", "cannot be read"}},
         {{"view", "/dev/zero", "-o", files / "p.html"}, 1, {"/dev/zero: expected a regular file"}},
         {{"plan", files.problem(), "--view", files / "no/such/p.html"},
          1,
          {files / "no/such/p.html"}}});
    CHECK_FALSE(std::filesystem::exists(files / "p.html"));
  }
}

}  // namespace
}  // namespace mneme

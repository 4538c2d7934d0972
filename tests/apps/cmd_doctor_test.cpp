// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <sys/stat.h>

namespace mneme::test {
namespace {

using Json = nlohmann::json;

TEST_SUITE("flow") {
  TEST_CASE("the doctor tries every instruction set and the database") {
    const ProgramRun run = require_run({"doctor", "--json"});
    const Json json = Json::parse(run.out);
    CHECK(json["ok"] == true);
    CHECK(json["version"] == std::string(version()));
    CHECK(json["isas"].size() >= 1);
    CHECK(json["checks"].size() == json["isas"].size() + 3);
    CHECK(json["parts"].contains("OMPL adapter"));
    for (const Json& check : json["checks"]) CHECK(check["ok"] == true);
  }

  TEST_CASE("the doctor says which instruction set is used, and why") {
    const ProgramRun run = require_run({"doctor"}, {{"MNEME_ISA=scalar"}, false});
    CHECK(contains(run.out, "used: scalar, as MNEME_ISA says"));
    CHECK(contains(run.out, "planning, scalar"));
    CHECK(contains(run.out, "database             ok: learned 1 primitive"));
  }

  TEST_CASE("the doctor leaves no file behind") {
    const TemporaryDirectory directory;
    require_run({"doctor"}, {{"TMPDIR=" + (directory / "")}, false});
    CHECK(std::filesystem::is_empty(directory / ""));
  }

  TEST_CASE("what does not work is named") {
    const TemporaryDirectory directory;
    REQUIRE(chmod((directory / "").c_str(), 0555) == 0);
    const ProgramRun run = run_program({"doctor"}, {{"TMPDIR=" + (directory / "")}, true});
    CHECK(run.exit_code == 1);
    CHECK(contains(run.out, "database             FAILED"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("an instruction set that this machine lacks is a usage error") {
    const ProgramRun run = run_program({"doctor"}, {{"MNEME_ISA=mmx"}, false});
    CHECK(run.exit_code == 2);
    CHECK(contains(run.err, "MNEME_ISA"));
    check_bad_inputs({{{"doctor", "--isa", "mmx"}, 2, {"--isa", "mmx"}},
                      {{"doctor", "now"}, 2, {"unexpected argument 'now'"}}});
  }
}

}  // namespace
}  // namespace mneme::test

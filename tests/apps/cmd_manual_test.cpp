// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

namespace mneme::test {
namespace {

TEST_SUITE("flow") {
  TEST_CASE("the manual page has every command, flag and environment variable") {
    const ProgramRun run = require_run({"manual"});
    CHECK(run.out.starts_with(".TH MNEME 1"));
    for (const char* part : {".SS mneme plan\n", ".SS mneme db verify\n", "\\-\\-learn\\-budget",
                             ".B MNEME_ROBOT_PATH", "130 interrupted", ".SH SEE ALSO"}) {
      CHECK_MESSAGE(contains(run.out, part), "expected: " << part);
    }
  }

  TEST_CASE("troff has nothing to complain about") {
    if (std::system("command -v groff >/dev/null") != 0) {
      MESSAGE("skipped: there is no groff");
      return;
    }
    const TemporaryDirectory files;
    write_file(files / "mneme.1", run_program({"manual"}).out);
    const std::string command = "groff -man -Tutf8 -ww -z " + (files / "mneme.1") + " 2>" +
                                (files / "warnings") + " </dev/null";
    CHECK(std::system(command.c_str()) == 0);
    CHECK(read_file(files / "warnings") == "");
  }
}

}  // namespace
}  // namespace mneme::test

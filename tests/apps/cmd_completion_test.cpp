// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

namespace mneme::test {
namespace {

/// Returns bash's completions of the last of `words` with the script of the program.
std::string complete_in_bash(const std::string& words) {
  const TemporaryDirectory files;
  write_file(files / "mneme.bash", run_program({"completion", "bash"}).out);
  const std::string command = "bash -c 'source " + (files / "mneme.bash") + "; COMP_WORDS=(" +
                              words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mneme; echo " +
                              "${COMPREPLY[*]}' >" + (files / "out");
  REQUIRE(std::system(command.c_str()) == 0);
  return read_file(files / "out");
}

TEST_SUITE("flow") {
  TEST_CASE("bash completes subcommands and flags") {
    CHECK(complete_in_bash("mneme pl") == "plan\n");
    CHECK(complete_in_bash("mneme db ver") == "verify\n");
    CHECK(complete_in_bash("mneme plan scene.yaml --timeo") == "--timeout\n");
    CHECK(complete_in_bash("mneme robot info --package") == "--package-path\n");
    CHECK(contains(complete_in_bash("mneme \"\""), "demo plan line learn db"));
    CHECK(complete_in_bash("mneme plan sce") == "\n");
    CHECK(complete_in_bash("mneme nonsense --timeo") == "\n");
  }

  TEST_CASE("zsh reads its script") {
    if (std::system("command -v zsh >/dev/null") != 0) {
      MESSAGE("skipped: there is no zsh");
      return;
    }
    const TemporaryDirectory files;
    write_file(files / "_mneme", run_program({"completion", "zsh"}).out);
    CHECK(read_file(files / "_mneme").starts_with("#compdef mneme\n"));
    CHECK(std::system(("zsh -n " + (files / "_mneme")).c_str()) == 0);
  }

  TEST_CASE("fish is told subcommands and flags, in words that it reads") {
    const TemporaryDirectory files;
    write_file(files / "mneme.fish", run_program({"completion", "fish"}).out);
    const std::string script = read_file(files / "mneme.fish");
    CHECK(contains(script, R"(complete -c mneme -n '__mneme_at \'db\'' -f -a info -d ')"));
    CHECK(contains(script, R"(complete -c mneme -n '__mneme_at \'plan\'' -l timeout -r -d ')"));
    if (std::system("command -v fish >/dev/null") != 0) {
      MESSAGE("skipped in part: there is no fish");
      return;
    }
    CHECK(std::system(("fish -n " + (files / "mneme.fish")).c_str()) == 0);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("shells that are not known are refused") {
    check_bad_inputs({{{"completion"}, 2, {"SHELL is required"}},
                      {{"completion", "csh"}, 2, {"unknown shell 'csh'", "bash, zsh, fish"}}});
  }
}

}  // namespace
}  // namespace mneme::test

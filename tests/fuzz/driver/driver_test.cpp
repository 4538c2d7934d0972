// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/driver/material.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <set>

using namespace mneme;

namespace {

struct Outcome {
  int status = 0;
  std::string output;
};

/// Runs the driver on a target that has `word` among its seeds.
Outcome drive(const test::TemporaryDirectory& directory, const std::string& word,
              const std::string& flags = "") {
  std::filesystem::create_directory(directory / "seeds");
  test::write_file(directory / "seeds/a", "harmless");
  test::write_file(directory / "seeds/b", word);
  const std::string command =
      std::string(MNEME_FAULTY) + " -runs=50 -seed=7 -artifact_prefix=" + (directory / "") + " " +
      flags + " " + (directory / "seeds") + " > " + (directory / "output") + " 2>&1";
  const int status = std::system(command.c_str());
  return {status, test::read_file(directory / "output")};
}

bool says(const Outcome& outcome, const std::string& text) {
  return outcome.output.find(text) != std::string::npos;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a target that takes everything passes with the number of runs it was asked for") {
    const test::TemporaryDirectory directory;
    const auto outcome = drive(directory, "harmless, too");
    CHECK(outcome.status == 0);
    CHECK(says(outcome, "50 runs with seed 7"));
  }

  TEST_CASE("a crash and an exit fail, and leave the input behind") {
    for (const std::string word : {"crash", "exit"}) {
      const test::TemporaryDirectory directory;
      const auto outcome = drive(directory, word);
      CHECK(outcome.status != 0);
      CHECK(says(outcome, word == "crash" ? "FAILED: Aborted" : "FAILED: exit code 3"));
      CHECK(test::read_file(directory / "failed-7-3") == word);
    }
  }

  TEST_CASE("an input that takes too long or too much memory fails") {
    const test::TemporaryDirectory directory;
    CHECK(says(drive(directory, "hang", "-timeout=1"), "FAILED: more than 1 s"));
    const auto grown = drive(directory, "grow", "-rss_limit_mb=32");
    CHECK(grown.status != 0);
    CHECK(says(grown, "more than 32 MiB were needed"));
  }

  TEST_CASE("a seed that cannot be read is an error, not a pass") {
    const test::TemporaryDirectory directory;
    const auto outcome = drive(directory, "harmless", directory / "missing");
    CHECK(outcome.status != 0);
    CHECK(says(outcome, "missing: cannot be read"));
  }

  TEST_CASE("dictionaries are read as libFuzzer reads them") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "a.dict", "# words\n\n\"PK\\x03\\x04\"\nquoted=\"\\\"a\\\\\"\n");
    const auto words = fuzz::read_dictionary(directory / "a.dict");
    REQUIRE(words);
    CHECK(*words == std::vector<std::string>{"PK\x03\x04", "\"a\\"});
    test::write_file(directory / "b.dict", "word\n");
    CHECK(!fuzz::read_dictionary(directory / "b.dict"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a seed repeats its inputs, which are many and no longer than allowed") {
    const fuzz::Material material{{"", "first seed", std::string(100, 'x')}, {"word"}, 80};
    Rng rng(3);
    Rng again(3);
    std::set<std::string> inputs;
    for (int i = 0; i < 1000; ++i) {
      const std::string input = fuzz::mutated(material, rng);
      CHECK(input.size() <= 80);
      CHECK(input == fuzz::mutated(material, again));
      inputs.insert(input);
    }
    CHECK(inputs.size() > 500);
  }
}

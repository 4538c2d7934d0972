// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/suite_settings.h"

#include <doctest/doctest.h>

#include "mneme/benchmark.h"

#include <algorithm>

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Settings are told by what differs from the defaults, in order of declaration") {
    SolveSettings settings;
    CHECK(describe_settings(settings).empty());
    settings.plan.range = 3.55;
    settings.similarity = 3;
    settings.drop_invalid_means = false;
    settings.learn.merge_cliques = true;
    CHECK(describe_settings(settings) ==
          "similarity=3 drop-invalid-means=false range=3.55 merge-cliques=true");
  }

  TEST_CASE("Time limit and seed are no part of the description: they have columns") {
    SolveSettings settings;
    settings.plan.timeout_s = 3;
    settings.plan.seed = 9;
    CHECK(describe_settings(settings).empty());
  }

  TEST_CASE("A suite may name every setting but the seed, each once") {
    auto names = internal::solve_setting_names();
    for (const char* name : {"sigma", "range", "max-gap", "merge-cliques", "timeout"}) {
      CAPTURE(name);
      CHECK(std::ranges::count(names, name) == 1);
    }
    CHECK(std::ranges::count(names, "seed") == 0);
    std::ranges::sort(names);
    CHECK(std::ranges::adjacent_find(names) == names.end());
  }
}

}  // namespace
}  // namespace mneme

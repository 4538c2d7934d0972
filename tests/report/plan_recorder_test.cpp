// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "support/support.h"

namespace mneme {
namespace {

void draw(PlanRecorder& recorder, int count, Origin origin) {
  for (int i = 0; i < count; ++i)
    recorder.on_sample(std::array{static_cast<float>(i), 0.0F}, origin);
}

TEST_SUITE("unit") {
  TEST_CASE("What fits is kept whole, in order, with its source") {
    PlanRecorder recorder({.samples = 4, .edges = 4});
    draw(recorder, 3, kUniformOrigin);
    draw(recorder, 2, 7);
    recorder.on_edge(std::array{1.0F, 2.0F}, std::array{3.0F, 4.0F}, 1);
    REQUIRE(recorder.uniform_samples().entries().size() == 3);
    CHECK(recorder.uniform_samples().entries()[2].q == std::vector<float>{2, 0});
    REQUIRE(recorder.memory_samples().entries().size() == 2);
    CHECK(recorder.memory_samples().entries()[1].origin == 7);
    CHECK(recorder.draws() == std::map<Origin, std::uint64_t>{{kUniformOrigin, 3}, {7, 2}});
    REQUIRE(recorder.edges().entries().size() == 1);
    CHECK(recorder.edges().entries()[0].graph == 1);
    CHECK(recorder.edges().entries()[0].from == std::vector<float>{1, 2});
    CHECK(recorder.edges().entries()[0].to == std::vector<float>{3, 4});
  }

  TEST_CASE("Uniform samples leave those from memory their room") {
    PlanRecorder recorder({.samples = 10});
    draw(recorder, 10000, kUniformOrigin);
    draw(recorder, 5, 0);
    CHECK(recorder.memory_samples().entries().size() == 5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("A long run is thinned evenly: at least half the limit stays, at equal distances") {
    for (const int limit : {2, 3, 10, 300}) {
      for (const int count : {1, 2, 11, 299, 301, 5000, 65537}) {
        INFO("limit ", limit, ", count ", count);
        PlanRecorder recorder({.samples = limit});
        draw(recorder, count, kUniformOrigin);
        const auto& kept = recorder.uniform_samples().entries();
        CHECK(recorder.uniform_samples().seen() == static_cast<std::uint64_t>(count));
        CHECK(static_cast<int>(kept.size()) <= limit);
        CHECK(static_cast<int>(kept.size()) >= std::min(count, limit / 2));
        CHECK(kept[0].q[0] == 0);
        for (std::size_t i = 2; i < kept.size(); ++i)
          REQUIRE(kept[i].q[0] - kept[i - 1].q[0] == kept[1].q[0]);
      }
    }
  }
}

}  // namespace
}  // namespace mneme

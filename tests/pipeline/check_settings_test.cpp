// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/check_settings.h"

#include <array>
#include <limits>

#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the defaults are within their ranges") {
    CHECK(internal::check_ranges({}).has_value());
  }

  TEST_CASE("a number out of range is named, in whatever part of the settings it is") {
    SolveSettings settings;
    settings.lambda = 1.5;
    CHECK(internal::check_ranges(settings).error().message ==
          "setting 'lambda' is 1.5: expected -1 to 1");
    settings = {};
    settings.plan.timeout_s = std::numeric_limits<double>::quiet_NaN();
    CHECK(internal::check_ranges(settings).error().message.find("'timeout'") != std::string::npos);
    settings = {};
    settings.learn.starts_per_link = 0;
    CHECK(internal::check_ranges(settings).error().code == ErrorCode::invalid);
  }

  TEST_CASE("continuous verification goes with verification only") {
    PlanSettings settings;
    settings.continuous = true;
    CHECK(internal::check_verification(settings).has_value());
    settings.verify = false;
    CHECK(internal::check_verification(settings).error().code == ErrorCode::invalid);
    settings.continuous = false;
    CHECK(internal::check_verification(settings).has_value());
  }

  TEST_CASE("an unknown sampler is an error that lists the known ones") {
    constexpr std::array<std::string_view, 2> names = {"gl", "halton"};
    SolveSettings settings;
    settings.sampler = "halton";
    CHECK(internal::check_sampler(settings, names).has_value());
    settings.sampler = "halto";
    const auto checked = internal::check_sampler(settings, names);
    REQUIRE(!checked.has_value());
    CHECK(checked.error().message == "unknown sampler 'halto': expected one of gl, halton");
  }
}

}  // namespace mneme::test

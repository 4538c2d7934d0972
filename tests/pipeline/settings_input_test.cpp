// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/settings_input.h"
#include "input/input.h"
#include "support/support.h"

namespace mneme::test {
namespace {

Result<SolveSettings> read_settings(const std::string& yaml) {
  return internal::without_throwing([&] {
    const std::string source = "f";
    const internal::InputValue value = internal::parse_yaml(yaml, source);
    const internal::Input input(value, source);
    SolveSettings settings;
    internal::visit_all_settings(settings, internal::SettingsReader(input));
    return settings;
  });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("seeds are read exactly, and other numbers within their ranges") {
    for (const std::uint64_t seed : {0UL, 9007199254740993UL, 18446744073709551615UL}) {
      CHECK(require(read_settings("seed: " + std::to_string(seed))).plan.seed == seed);
    }
    const auto settings = require(read_settings("{threads: 2, lambda: 0.25, max-nodes: 1e6}"));
    CHECK(settings.threads == 2);
    CHECK(settings.lambda == 0.25);
    CHECK(settings.plan.max_nodes == 1000000);
  }

  TEST_CASE("numbers that are not whole or out of range are refused with what there may be") {
    const auto refusal = [](const std::string& yaml) {
      const auto settings = read_settings(yaml);
      return settings ? std::string() : settings.error().message;
    };
    CHECK(refusal("seed: 18446744073709551616") ==
          "f:1: key seed: expected a whole number from 0 to 18446744073709551615, got "
          "18446744073709551616");
    const std::vector<std::pair<std::string, std::string>> refused = {
        {"seed: -1", "expected a whole number from 0 to "},
        {"threads: 1.5", "expected a whole number from 1 to 64, got 1.5"},
        {"threads: 0", "expected a whole number from 1 to 64, got 0"},
        {"threads: 4294967297", "expected a whole number from 1 to 64"},
        {"threads: many", "expected a number, got"},
        {"lambda: 2", "expected a number from 0 to 1, got 2"},
        {"lambda: .nan", "expected a number from 0 to 1, got .nan"}};
    for (const auto& [yaml, message] : refused) {
      const std::string told = refusal(yaml);
      CHECK_MESSAGE(contains(told, message), told);
    }
  }
}

}  // namespace mneme::test

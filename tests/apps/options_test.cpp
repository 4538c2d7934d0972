// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include <sstream>

#include "apps/run_program.h"

namespace mneme::test {
namespace {

/// The row of `docs/planners.md` that begins with `name`.
std::string row_of(const std::string& name) {
  std::istringstream lines(read_file(source_file("docs/planners.md")));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("| `" + name + "` | ")) return line;
  }
  return "";
}

TEST_SUITE("unit") {
  TEST_CASE("the tables of settings say what the help says") {
    const auto check = [](std::string_view name, const auto& value, auto, auto,
                          std::string_view sentence) {
      const std::string flag(name);
      CAPTURE(flag);
      const std::string row = row_of(flag);
      CHECK_MESSAGE(row.ends_with("| " + std::string(sentence) + " |"), row);
      std::string text = row.substr(std::min(row.size(), flag.size() + 7));
      text = text.substr(0, text.find(" |"));
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, bool>) {
        CHECK(text == (value ? "on" : "off"));
      } else {
        CHECK(std::strtod(text.c_str(), nullptr) == static_cast<double>(value));
      }
    };
    const SolveSettings settings;
    visit_settings(settings, check);
    visit_settings(settings.plan, check);
    visit_settings(settings.decompose, check);
    visit_settings(settings.learn, check);
    for (const std::string& decomposer : decomposer_names()) {
      CHECK(has_text(row_of("decomposer"), decomposer));
      CHECK_FALSE(row_of(decomposer).empty());
    }
  }

  TEST_CASE("samplers that can be chosen are in the documents") {
    const std::string text = read_file(source_file("docs/planners.md"));
    for (const std::string_view sampler : sampler_names()) {
      CHECK_MESSAGE(has_text(text, "`" + std::string(sampler) + "`"), sampler);
    }
  }
}

}  // namespace
}  // namespace mneme::test

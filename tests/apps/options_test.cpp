// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/run_program.h"

#include <sstream>

namespace mneme::test {
namespace {

/// The row of `docs/design/settings.md` that begins with `name`.
std::string row_of(const std::string& name) {
  std::istringstream lines(read_file(source_file("docs/design/settings.md")));
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
      using Setting = std::remove_cvref_t<decltype(value)>;
      if constexpr (SettingTraits<Setting>::kIsOptional) {
        CHECK(!value.has_value());
        CHECK(text == "-");
      } else if constexpr (std::is_same_v<Setting, bool>) {
        CHECK(text == (value ? "on" : "off"));
      } else {
        CHECK(std::strtod(text.c_str(), nullptr) == static_cast<double>(value));
      }
    };
    const SolveSettings settings;
    visit_settings(settings, check);
    visit_settings(settings.plan, check);
    visit_settings(settings.memory, check);
    visit_settings(settings.learn, check);
    for (const MemoryKind* kind : memory_kinds()) {
      CHECK_FALSE(row_of(std::string(kind->name)).empty());
    }
  }

  TEST_CASE("samplers that can be chosen are in the documents") {
    const std::string text = read_file(source_file("docs/design/planners.md"));
    for (const std::string_view sampler : sampler_names()) {
      CHECK_MESSAGE(contains(text, "`" + std::string(sampler) + "`"), sampler);
    }
  }
}

}  // namespace
}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/threads.h"
#include "input/input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mneme::internal {
namespace {

bool is_plain(std::string_view text) {
  constexpr std::array<std::string_view, 3> kNulls = {"null", "Null", "NULL"};
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto is_plain_character = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '/';
  };
  return !text.empty() && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(), is_plain_character) &&
         std::find(kNulls.begin(), kNulls.end(), text) == kNulls.end();
}

}  // namespace

std::string yaml_number(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return fmt::format("{}", value);
}

std::string yaml_string(std::string_view text) {
  if (is_plain(text)) return std::string(text);
  // A string of JSON is one of YAML too.
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string yaml_flow(const nlohmann::ordered_json& value) {
  if (value.is_number_float()) return yaml_number(value.get<double>());
  if (value.is_string()) return yaml_string(value.get_ref<const std::string&>());
  if (!value.is_structured()) return value.dump();
  constexpr std::size_t kPollInterval = 4096;
  std::vector<std::string> items;
  for (const auto& [key, item] : value.items()) {
    if (items.size() % kPollInterval == kPollInterval - 1) poll_interrupt();
    items.push_back(value.is_object() ? fmt::format("{}: {}", yaml_string(key), yaml_flow(item))
                                      : yaml_flow(item));
  }
  const std::string inner = fmt::format("{}", fmt::join(items, ", "));
  return value.is_object() ? "{" + inner + "}" : "[" + inner + "]";
}

std::string yaml_list(std::string_view key, const nlohmann::ordered_json& items) {
  std::string text = items.empty() ? "" : fmt::format("{}:\n", key);
  for (const auto& item : items) text += fmt::format("  - {}\n", yaml_flow(item));
  return text;
}

}  // namespace mneme::internal

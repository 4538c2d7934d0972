// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

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
  if (std::isnan(value)) {
    return ".nan";
  }
  if (std::isinf(value)) {
    return value > 0.0 ? ".inf" : "-.inf";
  }
  return fmt::format("{}", value);
}

std::string yaml_numbers(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) {
    text += (text.size() == 1 ? "" : ", ") + yaml_number(value);
  }
  return text + "]";
}

std::string yaml_string(std::string_view text) {
  if (is_plain(text)) {
    return std::string(text);
  }
  // A string of JSON is one of YAML too.
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace mneme::internal

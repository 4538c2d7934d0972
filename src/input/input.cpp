// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "input/input.h"

#include "base/fail.h"
#include "base/text.h"
#include "input/elided.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace mneme::internal {

std::optional<double> parse_yaml_number(std::string_view text) {
  const bool is_signed = !text.empty() && (text.front() == '+' || text.front() == '-');
  const double sign = is_signed && text.front() == '-' ? -1.0 : 1.0;
  text.remove_prefix(is_signed ? 1 : 0);
  if (text == ".inf" || text == ".Inf" || text == ".INF") {
    return sign * std::numeric_limits<double>::infinity();
  }
  if (!is_signed && (text == ".nan" || text == ".NaN" || text == ".NAN")) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (text.empty() || (text.front() != '.' && (text.front() < '0' || text.front() > '9'))) {
    return std::nullopt;
  }
  const auto magnitude = parse_number<double>(text);
  return magnitude ? std::optional(sign * *magnitude) : std::nullopt;
}

namespace {

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  text.remove_prefix(text.starts_with('+') ? 1 : 0);
  return parse_number<std::uint64_t>(text);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return text.size() <= kShown ? fmt::format("\"{}\"", text)
                               : fmt::format("\"{}...\"", text.substr(0, kShown));
}

struct Describe {
  std::string operator()(std::monostate) const { return "nothing"; }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::uint64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(InputValue::Angle angle) const {
    return fmt::format("an angle of {:.6g} rad, which this is not", angle.radians);
  }
  std::string operator()(const InputValue::Text& text) const {
    const auto value = text.is_quoted ? std::nullopt : parse_yaml_number(text.text);
    return value ? elided(text.text, kLongestName) : in_quotes(text.text);
  }
  std::string operator()(const InputValue::List& list) const {
    return fmt::format("a list of {}", list.size());
  }
  std::string operator()(const InputValue::Map&) const { return "a map"; }
};

}  // namespace

void InputFindings::add(const std::string& what, const std::string& place) {
  constexpr std::size_t kMostKinds = 100;
  const auto known = std::ranges::find(findings_, what, &Finding::what);
  if (known != findings_.end()) {
    ++known->others;
  } else if (findings_.size() < kMostKinds) {
    findings_.push_back({what, place});
  } else {
    ++dropped_;
  }
}

void InputFindings::append_to(std::vector<std::string>& warnings) const {
  for (const Finding& finding : findings_) {
    const std::string others =
        finding.others == 0 ? "" : fmt::format(" (and {} more)", finding.others);
    warnings.push_back(finding.first + others);
  }
  if (dropped_ > 0) warnings.push_back(fmt::format("and {} more warnings", dropped_));
}

std::string Input::place(const std::string& what) const {
  const std::string source =
      value_->line > 0 ? fmt::format("{}:{}", *source_, value_->line) : *source_;
  return key_.empty() ? fmt::format("{}: {}", source, elided(what))
                      : fmt::format("{}: key {}: {}", source, key_, elided(what));
}

void Input::fail(ErrorCode code, const std::string& what) const {
  throw InputFailure{{code, place(what)}};
}

void Input::fail_expecting(const std::string& expected) const {
  const auto* text = std::get_if<InputValue::Text>(&value_->content);
  // `ros2 topic echo` ends lists after 128 values like this.
  const bool is_cut = text != nullptr && text->text == "...";
  fail(ErrorCode::parse, "expected {}, got {}{}", expected, std::visit(Describe{}, value_->content),
       is_cut ? ": the list is cut; print it with ros2 topic echo --full-length" : "");
}

Input Input::collecting(InputFindings& findings) const {
  Input result = *this;
  result.findings_ = &findings;
  return result;
}

Input Input::taking_angles(bool is_angle) const {
  Input result = *this;
  result.takes_angles_ = takes_angles_ || is_angle;
  return result;
}

void Input::warn(const std::string& what) const {
  if (findings_ != nullptr) findings_->add(what, place(what));
}

Input Input::inner(const InputValue& value, std::string path) const {
  Input result(value, *source_, std::move(path));
  result.findings_ = findings_;
  result.takes_angles_ = takes_angles_;
  return result;
}

Input Input::child(const InputValue& value, std::string_view key) const {
  const std::string name = elided(key, kLongestName);
  return inner(value, key_.empty() ? name : fmt::format("{}.{}", key_, name));
}

const InputValue::Map& Input::map() const {
  const auto* map = std::get_if<InputValue::Map>(&value_->content);
  if (map == nullptr) fail_expecting("a map");
  return *map;
}

const InputValue::List& Input::list() const {
  const auto* list = std::get_if<InputValue::List>(&value_->content);
  if (list == nullptr) fail_expecting("a list");
  return *list;
}

void Input::allow_keys(const std::vector<std::string_view>& keys) const {
  for (const InputEntry& entry : map()) {
    if (std::ranges::find(keys, entry.key) != keys.end()) continue;
    const std::vector<std::string> names(keys.begin(), keys.end());
    child(entry.value, entry.key)
        .fail(ErrorCode::parse, "unknown key, expected one of {}{}", fmt::join(keys, ", "),
              did_you_mean(entry.key, names));
  }
}

std::optional<Input> Input::find(std::string_view key) const {
  for (const InputEntry& entry : map()) {
    if (entry.key == key) return child(entry.value, key);
  }
  return std::nullopt;
}

std::optional<Input> Input::find_value(std::string_view key) const {
  auto found = find(key);
  return found && !found->is_nothing() ? std::move(found) : std::nullopt;
}

Input Input::at(std::string_view key) const {
  auto found = find(key);
  if (!found) fail(ErrorCode::parse, "expected the key {}, which is missing", key);
  return *std::move(found);
}

std::vector<std::pair<std::string, Input>> Input::entries() const {
  std::vector<std::pair<std::string, Input>> result;
  for (const InputEntry& entry : map()) {
    result.emplace_back(entry.key, child(entry.value, entry.key));
  }
  return result;
}

std::vector<Input> Input::items() const {
  std::vector<Input> result;
  for (const InputValue& item : list()) {
    result.push_back(inner(item, fmt::format("{}[{}]", key_, result.size())));
  }
  return result;
}

bool Input::has_rows() const {
  return is_list() && std::ranges::any_of(list(), [](const InputValue& item) {
           return std::holds_alternative<InputValue::List>(item.content);
         });
}

std::vector<Input> Input::items(std::string_view key) const {
  const auto list = find_value(key);
  return list ? list->items() : std::vector<Input>();
}

std::optional<double> Input::as_number(const InputValue& value) const {
  const auto* angle = std::get_if<InputValue::Angle>(&value.content);
  if (angle != nullptr && takes_angles_) return angle->radians;
  if (const auto* number = std::get_if<double>(&value.content)) return *number;
  if (const auto* whole = std::get_if<std::uint64_t>(&value.content)) {
    return static_cast<double>(*whole);
  }
  const auto* text = std::get_if<InputValue::Text>(&value.content);
  return text == nullptr || text->is_quoted ? std::nullopt : parse_yaml_number(text->text);
}

bool Input::is_number() const { return as_number(*value_).has_value(); }

double Input::number() const {
  const auto number = as_number(*value_);
  if (!number) fail_expecting("a number");
  return *number;
}

double Input::finite_number() const {
  const double value = number();
  if (!std::isfinite(value)) fail_expecting("a finite number");
  return value;
}

std::optional<std::uint64_t> Input::whole_number() const {
  const double value = number();
  if (const auto* whole = std::get_if<std::uint64_t>(&value_->content)) return *whole;
  const auto* text = std::get_if<InputValue::Text>(&value_->content);
  if (const auto whole = text == nullptr ? std::nullopt : parse_whole(text->text)) return whole;
  // As 1e3 is, and 5.0.
  const bool is_whole = value >= 0 && value < 0x1p64 && value == std::floor(value);
  return is_whole ? std::optional(static_cast<std::uint64_t>(value)) : std::nullopt;
}

double Input::positive_number() const {
  const double value = finite_number();
  if (value <= 0.0) fail_expecting("a number above 0");
  return value;
}

bool Input::boolean() const {
  if (const auto* value = std::get_if<bool>(&value_->content)) return *value;
  const auto* text = std::get_if<InputValue::Text>(&value_->content);
  if (text == nullptr || text->is_quoted) fail_expecting("true or false");
  // As YAML 1.1, which rosparam and PyYAML read.
  std::string lower = text->text;
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::ranges::find(words, lower) != words.end();
  };
  if (is_one_of({"true", "yes", "on"})) return true;
  if (is_one_of({"false", "no", "off"})) return false;
  fail_expecting("true or false");
}

std::string Input::text() const {
  const auto* text = std::get_if<InputValue::Text>(&value_->content);
  if (text == nullptr) fail_expecting("a text");
  return text->text;
}

std::string Input::text_or(std::string_view key, const std::string& fallback) const {
  const auto found = find(key);
  return found ? found->text() : fallback;
}

std::vector<double> Input::numbers() const {
  std::vector<double> result;
  for (const InputValue& item : list()) {
    const auto number = as_number(item);
    result.push_back(number ? *number : items()[result.size()].number());
  }
  return result;
}

std::vector<double> Input::finite_numbers(std::size_t count, std::string_view what) const {
  if (!is_list() || list().size() != count) {
    fail_expecting("{} numbers ({})", count, what);
  }
  std::vector<double> result = numbers();
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(result[i])) static_cast<void>(items()[i].finite_number());
  }
  return result;
}

}  // namespace mneme::internal

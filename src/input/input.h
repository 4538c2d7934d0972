// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A tree of values from YAML or JSON, typed access with errors that name line and key, and values
/// written as YAML.
#pragma once

#include "mneme/base.h"

#include "base/fail.h"

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace mneme::internal {

struct InputEntry;

struct InputValue {
  using List = std::vector<InputValue>;
  using Map = std::vector<InputEntry>;

  /// Unquoted text of YAML may be a number; whether it is one is decided at access.
  struct Text {
    std::string text;
    bool is_quoted = false;
  };
  /// A number with a tag of angles.
  struct Angle {
    double radians = 0;
  };
  /// Integers are separate since a double is exact up to 2^53 only.
  std::variant<std::monostate, bool, std::uint64_t, double, Angle, Text, List, Map> content;
  int line = 0;  ///< from 1; 0 if unknown
};

struct InputEntry {
  std::string key;
  InputValue value;
};

/// Faults that readers tolerate. Each kind of fault is one warning.
class InputFindings {
 public:
  /// Counts a fault. `place` names where it is, with `what` the fault.
  void add(const std::string& what, const std::string& place);
  /// Appends a warning with the first place of each kind and the number of others.
  void append_to(std::vector<std::string>& warnings) const;

 private:
  struct Finding {
    std::string what, first;
    std::size_t others = 0;
  };
  std::vector<Finding> findings_;
  std::size_t dropped_ = 0;
};

/// Access to a value. The value, the name of its source and findings must outlive it. Throws
/// InputFailure with "SOURCE:LINE: key KEY: expected ..., got ..." for a value of another kind.
class Input {
 public:
  Input(const InputValue& value, const std::string& source, std::string key = {})
      : value_(&value), source_(&source), key_(std::move(key)) {}
  Input(const InputValue&, std::string&&, std::string = {}) = delete;
  Input(InputValue&&, const std::string&, std::string = {}) = delete;
  /// Returns access that adds warnings of this value and those in it to `findings`.
  [[nodiscard]] Input collecting(InputFindings& findings) const;
  /// Returns access that takes InputValue::Angle as a number, here and in the value; other access
  /// does not: a length in degrees is a fault. `is_angle`: false returns access as it is.
  [[nodiscard]] Input taking_angles(bool is_angle = true) const;
  /// Counts a fault that is tolerated; without findings it is dropped.
  void warn(const std::string& what) const;

  /// "SOURCE:LINE: key KEY: WHAT"
  [[nodiscard]] std::string place(const std::string& what) const;
  /// The path of keys to this value, such as "joints.a.max_velocity".
  [[nodiscard]] const std::string& key() const { return key_; }
  /// The name of the file or text.
  [[nodiscard]] const std::string& source() const { return *source_; }
  [[noreturn]] void fail(ErrorCode code, const std::string& what) const;
  template <class First, class... Rest>
  [[noreturn]] void fail(ErrorCode code, fmt::format_string<First, Rest...> what, First&& first,
                         Rest&&... rest) const {
    fail(code, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// Fails with "expected EXPECTED, got VALUE".
  [[noreturn]] void fail_expecting(const std::string& expected) const;
  template <class First, class... Rest>
  [[noreturn]] void fail_expecting(fmt::format_string<First, Rest...> expected, First&& first,
                                   Rest&&... rest) const {
    fail_expecting(fmt::format(expected, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// Returns the value of a result, or fails with its error at this place.
  template <class T>
  [[nodiscard]] T take(Result<T> result) const {
    if (!result) fail(result.error().code, result.error().message);
    return *std::move(result);
  }

  [[nodiscard]] bool is_map() const {
    return std::holds_alternative<InputValue::Map>(value_->content);
  }
  [[nodiscard]] bool is_list() const {
    return std::holds_alternative<InputValue::List>(value_->content);
  }
  /// True for a key without a value and for null.
  [[nodiscard]] bool is_nothing() const {
    return std::holds_alternative<std::monostate>(value_->content);
  }
  [[nodiscard]] bool is_text() const {
    return std::holds_alternative<InputValue::Text>(value_->content);
  }

  /// True also for unquoted YAML text that is a number.
  [[nodiscard]] bool is_number() const;

  /// Fails if this is not a map or has another key than `keys`.
  void allow_keys(const std::vector<std::string_view>& keys) const;
  [[nodiscard]] std::optional<Input> find(std::string_view key) const;
  /// As find(), but nothing for a key without a value.
  [[nodiscard]] std::optional<Input> find_value(std::string_view key) const;
  [[nodiscard]] Input at(std::string_view key) const;
  [[nodiscard]] std::vector<std::pair<std::string, Input>> entries() const;
  [[nodiscard]] std::vector<Input> items() const;
  /// The number of items of a list. Fails if this is no list.
  [[nodiscard]] std::size_t size() const { return list().size(); }
  /// True if this is a list with an item that is a list.
  [[nodiscard]] bool has_rows() const;
  /// The items of the list `key`; none if the key is missing or has no value.
  [[nodiscard]] std::vector<Input> items(std::string_view key) const;

  /// May be infinite or NaN.
  [[nodiscard]] double number() const;
  [[nodiscard]] double finite_number() const;
  /// Returns the exact integer; nothing for a number that is not an integer from 0 to 2^64 - 1.
  [[nodiscard]] std::optional<std::uint64_t> whole_number() const;
  /// Finite and above 0.
  [[nodiscard]] double positive_number() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  /// Returns the text of the key, or `fallback` if it is missing.
  [[nodiscard]] std::string text_or(std::string_view key, const std::string& fallback) const;
  [[nodiscard]] std::vector<double> numbers() const;
  /// Returns exactly `count` finite numbers; `what` describes them in the message.
  [[nodiscard]] std::vector<double> finite_numbers(std::size_t count, std::string_view what) const;

 private:
  [[nodiscard]] std::optional<double> as_number(const InputValue& value) const;
  [[nodiscard]] const InputValue::Map& map() const;
  [[nodiscard]] const InputValue::List& list() const;
  [[nodiscard]] Input inner(const InputValue& value, std::string path) const;
  [[nodiscard]] Input child(const InputValue& value, std::string_view key) const;

  const InputValue* value_;
  const std::string* source_;
  std::string key_;
  InputFindings* findings_ = nullptr;
  bool takes_angles_ = false;
};

/// Returns a number of YAML, whatever the locale: decimal, or .inf and .nan. Nothing for other
/// text.
[[nodiscard]] std::optional<double> parse_yaml_number(std::string_view text);

/// Parses the one document of `yaml`; empty ones may follow. `source` names it in messages. The
/// tags !degrees and !radians of an angle such as 30 or pi/6, and deg(ANGLE) and rad(ANGLE), give
/// InputValue::Angle; merge keys << are expanded. Throws InputFailure, also for other tags, a
/// repeated key and more than 4 million values, with copies for anchors and aliases.
[[nodiscard]] InputValue parse_yaml(std::string_view yaml, const std::string& source);

/// Parses JSON with lines; `source` names it in messages. Throws InputFailure.
[[nodiscard]] InputValue parse_json(std::string_view json, const std::string& source);

/// Returns the shortest digits that read back to `value`; .inf and .nan if it is not finite.
[[nodiscard]] std::string yaml_number(double value);
/// Returns `text`, quoted if necessary. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string yaml_string(std::string_view text);
/// Returns the value on one line: "{name: table, size: [1, 2.5, 0.1]}".
[[nodiscard]] std::string yaml_flow(const nlohmann::ordered_json& value);
/// Returns the key with one line per item; nothing without items.
[[nodiscard]] std::string yaml_list(std::string_view key, const nlohmann::ordered_json& items);

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A tree of values read from YAML or JSON, and a way to read it that says where it went wrong.
#pragma once

#include "mneme/base.h"

#include "base/fail.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <initializer_list>
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

  /// Text of YAML that is not quoted may turn out to be a number when a number is asked for.
  struct Text {
    std::string text;
    bool is_quoted = false;
  };
  /// Whole numbers are apart because a double holds those up to 2^53 only.
  std::variant<std::monostate, bool, std::uint64_t, double, Text, List, Map> content;
  int line = 0;  ///< from 1; 0 if unknown
};

struct InputEntry {
  std::string key;
  InputValue value;
};

/// A value and the way to it. The value and the name of its source must outlive it. Whatever does
/// not find what it expects throws InputFailure with "SOURCE:LINE: key KEY: expected ..., got ...".
class Input {
 public:
  Input(const InputValue& value, const std::string& source, std::string key = {})
      : value_(&value), source_(&source), key_(std::move(key)) {}
  Input(const InputValue&, std::string&&, std::string = {}) = delete;
  Input(InputValue&&, const std::string&, std::string = {}) = delete;

  /// "SOURCE:LINE: key KEY: WHAT"
  [[nodiscard]] std::string place(const std::string& what) const;
  /// The name of the file, or whatever names the text.
  [[nodiscard]] const std::string& source() const { return *source_; }
  [[noreturn]] void fail(ErrorCode code, const std::string& what) const;
  template <class First, class... Rest>
  [[noreturn]] void fail(ErrorCode code, fmt::format_string<First, Rest...> what, First&& first,
                         Rest&&... rest) const {
    fail(code, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// Fails with "expected EXPECTED, got" and a description of the value.
  [[noreturn]] void fail_expecting(const std::string& expected) const;
  template <class First, class... Rest>
  [[noreturn]] void fail_expecting(fmt::format_string<First, Rest...> expected, First&& first,
                                   Rest&&... rest) const {
    fail_expecting(fmt::format(expected, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// The value, or fails with the error of what this value led to.
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
  /// True of a key without a value, and of null.
  [[nodiscard]] bool is_nothing() const {
    return std::holds_alternative<std::monostate>(value_->content);
  }
  [[nodiscard]] bool is_text() const {
    return std::holds_alternative<InputValue::Text>(value_->content);
  }

  /// True also of text of YAML that says one.
  [[nodiscard]] bool is_number() const;

  /// Fails if this is no map or has a key that is not one of `keys`.
  void allow_keys(const std::vector<std::string_view>& keys) const;
  [[nodiscard]] std::optional<Input> find(std::string_view key) const;
  /// The same; nothing also for a key without a value.
  [[nodiscard]] std::optional<Input> find_value(std::string_view key) const;
  [[nodiscard]] Input at(std::string_view key) const;
  [[nodiscard]] std::vector<std::pair<std::string, Input>> entries() const;
  [[nodiscard]] std::vector<Input> items() const;
  /// The items of the list `key`; none if the key is missing or has no value.
  [[nodiscard]] std::vector<Input> items(std::string_view key) const;

  /// Also infinite or not a number, as YAML can say.
  [[nodiscard]] double number() const;
  [[nodiscard]] double finite_number() const;
  /// Exactly; nothing if it is a number, but no whole one from 0 to 2^64 - 1.
  [[nodiscard]] std::optional<std::uint64_t> whole_number() const;
  /// Finite and above zero.
  [[nodiscard]] double positive_number() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  /// The text of the key, or `fallback` without it.
  [[nodiscard]] std::string text_or(std::string_view key, const std::string& fallback) const;
  [[nodiscard]] std::vector<double> numbers() const;
  /// Exactly `count` finite numbers; `what` describes them in the message.
  [[nodiscard]] std::vector<double> finite_numbers(std::size_t count, std::string_view what) const;

 private:
  [[nodiscard]] std::optional<double> as_number() const;
  [[nodiscard]] Input child(const InputValue& value, std::string_view key) const;

  const InputValue* value_;
  const std::string* source_;
  std::string key_;
};

/// The one document of `yaml`; `source` names it in messages. Throws InputFailure, also for a
/// doubled key and for aliases that expand to more than a few million values.
[[nodiscard]] InputValue parse_yaml(std::string_view yaml, const std::string& source);

/// The value of `json`, with lines; `source` names it in messages. Throws InputFailure.
[[nodiscard]] InputValue parse_json(std::string_view json, const std::string& source);

}  // namespace mneme::internal

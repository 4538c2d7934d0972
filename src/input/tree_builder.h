// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds a tree of input values from the events of a parser. Refuses trees that are too deep or
/// too large.
#pragma once

#include "input/input.h"

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

class TreeBuilder {
 public:
  using Content = decltype(InputValue::content);

  TreeBuilder(std::string source, int max_values)
      : source_(std::move(source)), max_values_(max_values) {}

  /// Throws InputFailure with "SOURCE:LINE: WHAT".
  [[noreturn]] void refuse(int line, const std::string& what) const;

  /// Returns true if the next event must be a key.
  [[nodiscard]] bool is_key_next() const;
  /// Returns the line of the key whose value comes next, if any.
  [[nodiscard]] std::optional<int> key_line() const;
  void set_key(int line, const std::string& key);

  /// Begins a value; all events until its close() are inside.
  void open(int line, Content content);
  /// Replaces the key << of the innermost value, a map, by the entries of the map or the list of
  /// maps that it has (yaml.org/type/merge.html). Own entries and those of earlier maps win.
  void merge();
  /// Ends the innermost value. The reference is valid until the next call.
  const InputValue& close();
  /// Adds `values` to the count that is limited. `what` follows "values" in the message.
  void count(int line, int values, std::string_view what = "");

  [[nodiscard]] InputValue take() { return std::move(root_); }

 private:
  struct Level {
    InputValue value;
    std::set<std::string> keys;
    std::optional<std::string> key;
    int key_line = 0;
  };

  std::string source_;
  int max_values_;
  int values_ = 0;
  std::vector<Level> levels_;
  InputValue root_{{}, 1};
};

/// Parses a subset of YAML fast: blocks and flow collections of plain words and quoted text.
/// Returns nothing for other text. Errors as parse_yaml().
[[nodiscard]] std::optional<InputValue> parse_simple_yaml(std::string_view yaml,
                                                          const std::string& source,
                                                          int max_values);

}  // namespace mneme::internal

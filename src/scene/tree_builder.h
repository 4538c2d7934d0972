// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds a tree of input values from the events of a parser, and refuses trees that are too deep
/// or too large.
#pragma once

#include "scene/input.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mneme::internal {

class TreeBuilder {
 public:
  using Content = decltype(InputValue::content);

  TreeBuilder(std::string source, int max_values)
      : source_(std::move(source)), max_values_(max_values) {}

  /// Throws InputFailure with "SOURCE:LINE: WHAT".
  [[noreturn]] void refuse(int line, const std::string& what) const;

  /// True if a key must come next.
  [[nodiscard]] bool is_key_next() const;
  /// The line of the key whose value must come next, if there is one.
  [[nodiscard]] std::optional<int> key_line() const;
  void set_key(int line, const std::string& key);

  /// Begins a value. Whatever comes before its close() is inside it.
  void open(int line, Content content);
  /// Ends the value that was begun last, which stays where it is until the next call.
  const InputValue& close();
  /// Counts `values` more against the limit.
  void count(int line, int values);

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

}  // namespace mneme::internal

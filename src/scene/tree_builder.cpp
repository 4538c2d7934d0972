// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/tree_builder.h"

#include <fmt/format.h>

namespace mneme::internal {

void TreeBuilder::refuse(int line, const std::string& what) const {
  throw InputFailure{{ErrorCode::parse, fmt::format("{}:{}: {}", source_, line, what)}};
}

bool TreeBuilder::is_key_next() const {
  return !levels_.empty() && !levels_.back().key &&
         std::holds_alternative<InputValue::Map>(levels_.back().value.content);
}

std::optional<int> TreeBuilder::key_line() const {
  return levels_.empty() || !levels_.back().key ? std::nullopt
                                                : std::optional(levels_.back().key_line);
}

void TreeBuilder::set_key(int line, const std::string& key) {
  Level& level = levels_.back();
  if (!level.keys.insert(key).second) {
    refuse(line, fmt::format("key {}: expected once, got a second time", key));
  }
  level.key = key;
  level.key_line = line;
}

void TreeBuilder::open(int line, Content content) {
  constexpr std::size_t kMaxDepth = 64;
  if (is_key_next()) refuse(line, "expected a key that is a text");
  if (levels_.size() >= kMaxDepth) {
    refuse(line, fmt::format("expected values nested at most {} deep", kMaxDepth));
  }
  count(line, 1);
  levels_.push_back({{std::move(content), line}, {}, {}, 0});
}

const InputValue& TreeBuilder::close() {
  InputValue value = std::move(levels_.back().value);
  levels_.pop_back();
  if (levels_.empty()) return root_ = std::move(value);
  Level& parent = levels_.back();
  if (auto* map = std::get_if<InputValue::Map>(&parent.value.content)) {
    map->push_back({std::move(*parent.key), std::move(value)});
    parent.key.reset();
    return map->back().value;
  }
  auto& list = std::get<InputValue::List>(parent.value.content);
  list.push_back(std::move(value));
  return list.back();
}

void TreeBuilder::count(int line, int values) {
  if (values > max_values_ - values_) {
    refuse(line, fmt::format("expected at most {} values", max_values_));
  }
  values_ += values;
}

}  // namespace mneme::internal

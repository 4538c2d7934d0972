// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The share that one of several processes has in a list.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mneme/base.h"

namespace mneme::app {

/// "I/N", both whole numbers.
struct Fraction {
  std::size_t index = 0;
  std::size_t count = 1;
};
[[nodiscard]] std::optional<Fraction> parse_fraction(std::string_view text);

/// "I/N" with 0 <= I <= N. The shares 1 to N are all of a list, and so are 0 to N - 1: 0 and N are
/// the same, because arrays of jobs are numbered either way.
[[nodiscard]] Result<Fraction> parse_shard(const std::string& text);

/// Every N-th item, beginning with the I-th counted from 1; all of them if `shard` is 0/1.
template <class T>
[[nodiscard]] std::vector<T> take_shard(std::vector<T> items, const Fraction& shard) {
  std::vector<T> taken;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if ((i + 1) % shard.count == shard.index % shard.count) taken.push_back(std::move(items[i]));
  }
  return taken;
}

}  // namespace mneme::app

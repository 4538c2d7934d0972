// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning on many machines: the flags --shard, --worker and --lease.
#pragma once

#include "mneme/benchmark.h"
#include "mneme/learning.h"

#include "options.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mneme::app {

/// Every N-th item, beginning with the I-th counted from 1; all of them if `shard` is 0/1. I counts
/// from 1 or from 0, because arrays of jobs are numbered either way.
template <class T>
[[nodiscard]] std::vector<T> take_shard(std::vector<T> items, const Part& shard) {
  std::vector<T> taken;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (shard.holds(i)) taken.push_back(std::move(items[i]));
  }
  return taken;
}

struct Sharing {
  Part shard;
  bool is_worker = false;
  double lease_s = SharedWork().lease_s;

  /// What a worker's job says of it; nothing for others.
  [[nodiscard]] std::optional<SharedWork> work(const std::string& url) const;
};

void add_sharing(CLI::App& command, Sharing& sharing);
/// Throws what the command line cannot mean.
void check_sharing(const CLI::App& command, const Sharing& sharing, const std::string& url,
                   bool has_problems);

}  // namespace mneme::app

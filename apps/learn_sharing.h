// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning on many machines: the flags --shard, --worker and --lease.
#pragma once

#include <string>

#include "mneme/learning.h"

#include "options.h"
#include "shard.h"

namespace mneme::app {

struct Sharing {
  Fraction shard;
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

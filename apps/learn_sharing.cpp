// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learn_sharing.h"

#include <fmt/format.h>

namespace mneme::app {

std::optional<SharedWork> Sharing::work(const std::string& url) const {
  return is_worker ? std::optional(SharedWork{url, lease_s}) : std::nullopt;
}

void add_sharing(CLI::App& command, Sharing& sharing) {
  const auto read_shard = [&sharing](const std::string& text) {
    const std::optional<Part> shard = parse_part(text);
    if (shard) {
      sharing.shard = *shard;
      return;
    }
    throw CLI::ValidationError(
        "--shard",
        fmt::format("'{}' is no shard; expected I/N with 0 <= I <= N, such as 1/16", text));
  };
  add_text(command, "--shard", read_shard,
           "every N-th primitive beginning with the I-th, each shard into a database of its own; "
           "merged by `mneme db merge` they are what one process learns. I counts from 1 or from "
           "0: shards 0 and N are the same")
      ->type_name("I/N");
  command.add_flag("--worker", sharing.is_worker,
                   "share the primitives with all processes that were given the same command "
                   "line and a database on a PostgreSQL server; ends when all are learned");
  add_number(command, "--lease", sharing.lease_s, 0.1, 86400.0,
             "with --worker: seconds without a sign of life after which a process's primitives go "
             "to others");
}

void check_sharing(const CLI::App& command, const Sharing& sharing, const std::string& url,
                   bool has_problems) {
  const bool has_shard = command.count("--shard") > 0;
  if (has_problems) {
    if (has_shard) throw CLI::ExcludesError("--shard", "--problems, whose shards are --part");
    if (sharing.is_worker) throw CLI::ExcludesError("--worker", "--problems");
  }
  if (sharing.is_worker && has_shard) throw CLI::ExcludesError("--worker", "--shard");
  if (sharing.is_worker && !url.starts_with("postgres")) {
    throw CLI::ValidationError("--worker", "needs a database on a server: --db postgresql://...");
  }
}

}  // namespace mneme::app

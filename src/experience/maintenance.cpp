// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "experience/merge_rows.h"
#include "experience/open_store.h"
#include "experience/store_reads.h"
#include "experience/store_writes.h"

namespace mneme {

Result<MergeSummary> merge_databases(const std::string& into, const std::string& from) {
  const auto source = internal::inspect_store(from);
  if (!source) return tl::unexpected(internal::with_advice(source.error(), from));
  MergeSummary summary;
  if (source->schema_version == 0) return summary;
  const auto list = internal::list_by_content(*source->store);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), from));
  const auto target = internal::open_store_of(into, source->space, OpenMode::create);
  if (!target) return tl::unexpected(internal::with_advice(target.error(), into));
  const auto merged = internal::visit_rows(*source->store, source->space, *list, [&](auto rows) {
    return internal::merge_rows(*target->store, rows, summary);
  });
  if (!merged) return tl::unexpected(internal::with_advice(merged.error(), from));
  return summary;
}

Result<CompactSummary> compact_database(const std::string& url) {
  const auto opened = internal::inspect_store(url);
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  CompactSummary summary;
  if (opened->schema_version == 0) return summary;
  const auto store = internal::open_store(url, OpenMode::read_write);
  if (!store) return tl::unexpected(internal::with_advice(store.error(), url));
  const auto bytes = [&] { return (*store)->bytes().value_or(0); };
  summary.bytes_before = bytes();
  // Nothing is removed while something is wrong.
  const auto list = internal::list_by_content(**store);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), url));
  const auto removed = internal::compact_store(**store);
  if (!removed) return tl::unexpected(internal::with_advice(removed.error(), url));
  summary.removed = *removed;
  summary.bytes_after = bytes();
  return summary;
}

}  // namespace mneme

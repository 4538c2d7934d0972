// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "experience/merge_rows.h"
#include "experience/migrate.h"
#include "experience/open_store.h"
#include "experience/schema.h"
#include "experience/store_reads.h"
#include "experience/store_url.h"
#include "experience/store_writes.h"

namespace mneme {

Result<MergeSummary> merge_databases(const std::string& into, const std::string& from) {
  const auto source = internal::inspect_store(from);
  if (!source) return tl::unexpected(internal::with_advice(source.error(), from));
  MergeSummary summary;
  if (source->schema_version == 0) return summary;
  const auto list = internal::list_by_content(*source->store, source->space);
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
  if (opened->schema_version != internal::kSchemaVersion) {
    return internal::refuse_older(opened->store->name(), opened->schema_version);
  }
  const auto store = internal::open_store(url, OpenMode::read_write);
  if (!store) return tl::unexpected(internal::with_advice(store.error(), url));
  const auto bytes = [&] { return (*store)->bytes().value_or(0); };
  summary.bytes_before = bytes();
  // Nothing is removed while something is wrong.
  const auto list = internal::list_by_content(**store, opened->space);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), url));
  const auto removed = internal::compact_store(**store);
  if (!removed) return tl::unexpected(internal::with_advice(removed.error(), url));
  summary.removed = *removed;
  summary.bytes_after = bytes();
  return summary;
}

Result<MigrateSummary> migrate_database(const std::string& url) {
  const auto engine = internal::engine_of(url);
  if (!engine) return tl::unexpected(engine.error());
  if (*engine == internal::Engine::sqlite) {
    auto migrated = internal::migrate_file(url);
    if (!migrated) return tl::unexpected(internal::with_advice(migrated.error(), url));
    return migrated;
  }
  // No older schema was ever in use on servers.
  return internal::inspect_store(url).map([](const internal::OpenedStore& opened) {
    MigrateSummary summary;
    summary.from = opened.schema_version;
    summary.to = opened.schema_version;
    return summary;
  });
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "experience/experience_index.h"
#include "experience/open_store.h"
#include "experience/space.h"
#include "experience/store_reads.h"
#include "experience/store_writes.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <shared_mutex>
#include <unordered_set>

namespace mneme {

using internal::ExperienceIndex;
using internal::StoreState;

/// `store` and `reached` belong to whoever holds `writing`; everything after `mutex` to whoever
/// holds that, and may also be read by whoever holds `writing`, because only they change it.
struct Database::State {
  explicit State(internal::OpenedStore opened)
      : url(opened.store->name()),
        space(std::move(opened.space)),
        schema_version(opened.schema_version),
        store(std::move(opened.store)),
        index(std::make_unique<ExperienceIndex>(std::max(space.key_size, 1))) {}

  /// Reads what came since `reached`; returns the number of rows.
  Result<std::int64_t> catch_up();
  void append(std::vector<Experience> fresh);
  /// Appends `fresh` and forgets the rows that `is_gone` names.
  void replace(std::vector<Experience> fresh,
               const std::function<bool(const Experience&)>& is_gone);

  /// The platform's shared locks let readers in as long as there are any. Whoever waits to write
  /// keeps the door, so that threads that search without a pause cannot hold up an insertion for
  /// ever.
  [[nodiscard]] std::shared_lock<std::shared_mutex> lock_to_read() const {
    const std::lock_guard entering(door);
    return std::shared_lock(mutex);
  }
  [[nodiscard]] std::unique_lock<std::shared_mutex> lock_to_write() const {
    const std::lock_guard entering(door);
    return std::unique_lock(mutex);
  }

  const std::string url;
  const ExperienceSpace space;
  std::mutex writing;
  int schema_version;
  std::unique_ptr<internal::Store> store;
  StoreState reached;

  mutable std::mutex door;
  mutable std::shared_mutex mutex;
  std::deque<Experience> rows;  // never moves or loses an element, so that Matches stay valid
  std::vector<const Experience*> live;
  std::unique_ptr<ExperienceIndex> index;  // its positions are those of `live`
  std::int64_t components = 0;
};

void Database::State::append(std::vector<Experience> fresh) {
  const auto lock = lock_to_write();
  for (Experience& row : fresh) {
    index->append(row.key);
    components += row.sampler.component_count();
    live.push_back(&rows.emplace_back(std::move(row)));
  }
  index->refresh();
}

void Database::State::replace(std::vector<Experience> fresh,
                              const std::function<bool(const Experience&)>& is_gone) {
  // Whoever searches goes on with the old index until the new one is complete.
  auto new_index = std::make_unique<ExperienceIndex>(std::max(space.key_size, 1));
  std::vector<const Experience*> kept;
  std::int64_t kept_components = 0;
  for (const Experience* row : live) {
    if (is_gone(*row)) continue;
    new_index->append(row->key);
    kept_components += row->sampler.component_count();
    kept.push_back(row);
  }
  new_index->refresh();
  {
    const auto lock = lock_to_write();
    std::swap(index, new_index);
    std::swap(live, kept);
    components = kept_components;
  }
  append(std::move(fresh));
}

Result<std::int64_t> Database::State::catch_up() {
  if (schema_version == 0) {
    const auto version = store->schema_version();
    if (!version) return tl::unexpected(version.error());
    if (*version == 0) return 0;
    const auto found = store->space();
    if (!found) return tl::unexpected(found.error());
    if (!internal::is_same_space(*found, space)) return internal::refuse_space(url, *found, space);
    schema_version = *version;
  }
  std::unordered_set<std::int64_t> known;
  std::unordered_set<std::int64_t> seen;
  std::vector<Experience> fresh;
  const auto visit = [&](const internal::StoredRow& row) -> Result<void> {
    if (row.id <= reached.last_row) {
      if (known.empty()) {
        for (const Experience* old : live) known.insert(old->id);
      }
      seen.insert(row.id);
      if (known.contains(row.id)) return {};
    }
    if (const auto flaw = internal::decode(row, space, fresh.emplace_back())) {
      return fail(ErrorCode::corrupt, fmt::format("{}: row {} is damaged: {}", url, row.id, *flaw));
    }
    return {};
  };
  const auto changes = internal::read_changes(*store, reached, internal::RowParts::all, visit);
  if (!changes) return tl::unexpected(changes.error());
  const auto is_gone = [&](const Experience& row) {
    return changes->buried.contains(row.id) || (changes->is_complete && !seen.contains(row.id));
  };
  const auto count = static_cast<std::int64_t>(fresh.size());
  if (std::ranges::any_of(live, [&](const Experience* row) { return is_gone(*row); })) {
    replace(std::move(fresh), is_gone);
  } else if (count > 0) {
    append(std::move(fresh));
  }
  reached = changes->state;
  return count;
}

Database::Database(std::unique_ptr<State> state) : state_(std::move(state)) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Result<Database> Database::load(Result<internal::OpenedStore> opened, const std::string& url) {
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  auto state = std::make_unique<State>(std::move(*opened));
  if (state->schema_version > 0) {
    const auto read = state->catch_up();
    if (!read) return tl::unexpected(internal::with_advice(read.error(), url));
  }
  return Database(std::move(state));
}

Result<Database> Database::open(const std::string& url, const ExperienceSpace& space,
                                OpenMode mode) {
  return load(internal::open_store_of(url, space, mode), url);
}

Result<Database> Database::inspect(const std::string& url) {
  return load(internal::inspect_store(url), url);
}

const ExperienceSpace& Database::space() const { return state_->space; }

DatabaseInfo Database::info() const {
  const std::lock_guard writing(state_->writing);
  DatabaseInfo info;
  info.url = state_->url;
  info.space = state_->space;
  info.samplers = static_cast<std::int64_t>(state_->live.size());
  info.components = state_->components;
  info.bytes = state_->store->bytes().value_or(0);
  info.schema_version = state_->schema_version;
  info.generation = state_->reached.generation;
  info.tombstones = state_->reached.tombstone_count;
  return info;
}

std::int64_t Database::size() const {
  const auto lock = state_->lock_to_read();
  return static_cast<std::int64_t>(state_->live.size());
}

const Experience& Database::get(std::int64_t position) const {
  const auto lock = state_->lock_to_read();
  return *state_->live[static_cast<std::size_t>(position)];
}

std::vector<Match> Database::find(const LocalPrimitive& primitive, double threshold,
                                  int max_matches) const {
  if (primitive.key.size() != static_cast<std::size_t>(state_->space.key_size)) return {};
  const std::vector<KeyImage> queries = images(primitive.key);
  const auto lock = state_->lock_to_read();
  std::vector<Match> matches;
  for (const auto& found : state_->index->find(queries, threshold, max_matches)) {
    const Symmetry to_canonical{0, queries[found.image].is_mirrored};
    matches.push_back(
        {state_->live[found.position], found.error, compose(primitive.to_scene, to_canonical)});
  }
  return matches;
}

Result<std::vector<std::int64_t>> Database::insert(std::vector<Experience> rows) {
  const auto prepared = internal::prepare_rows(rows, state_->space);
  if (!prepared) return tl::unexpected(prepared.error());
  const std::lock_guard writing(state_->writing);
  auto appended = internal::append_rows(*state_->store, rows, internal::Duplicates::keep_first);
  if (!appended) return tl::unexpected(appended.error());
  if (appended->before != state_->reached) {
    // The rows are safe, whatever becomes of those of others: refresh() will tell.
    (void)state_->catch_up();
    return appended->ids;
  }
  std::vector<Experience> fresh;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!appended->is_new[i]) continue;
    rows[i].id = appended->ids[i];
    fresh.push_back(std::move(rows[i]));
  }
  state_->append(std::move(fresh));
  state_->reached = appended->state;
  return appended->ids;
}

Result<std::int64_t> Database::refresh() {
  const std::lock_guard writing(state_->writing);
  return state_->catch_up();
}

}  // namespace mneme

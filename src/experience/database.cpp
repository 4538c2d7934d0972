// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "base/text.h"
#include "experience/index_file.h"
#include "store/open_store.h"
#include "store/row_check.h"
#include "experience/row_loader.h"
#include "store/store_reads.h"
#include "store/store_writes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <unordered_set>
#include <utility>

namespace mneme {

using internal::ExperienceIndex;
using internal::KindIndexes;
using internal::RowParts;
using internal::SharedExperience;
using internal::StoreState;

namespace {

/// Rows on their way into a database's memory.
struct FreshRows {
  std::map<std::string, internal::IndexRows> kinds;
  std::int64_t count = 0;
  std::vector<SharedExperience> rows;  // those that were read whole

  void add(const Experience& row, std::int64_t components) {
    internal::IndexRows& keys = kinds[row.kind];
    keys.ids.push_back(row.id);
    keys.components.push_back(static_cast<std::int32_t>(components));
    keys.keys.insert(keys.keys.end(), row.key.begin(), row.key.end());
    ++count;
  }
};

std::int64_t size_of(const KindIndexes& kinds) {
  std::int64_t size = 0;
  for (const auto& [kind, index] : kinds) size += index.size();
  return size;
}

/// Hands the ids of each tree to `visit`, kind by kind.
template <class Visit>
void visit_trees(const KindIndexes& kinds, const Visit& visit) {
  for (const auto& [kind, index] : kinds) {
    for (const auto& tree : index.trees()) visit(std::span<const std::int64_t>(tree->data().ids));
  }
}

internal::KeySizes sizes_of(const KindIndexes& kinds) {
  internal::KeySizes sizes;
  for (const auto& [kind, index] : kinds) {
    (void)sizes.check(kind, static_cast<std::size_t>(index.key_size()));
  }
  return sizes;
}

}  // namespace

/// What is not const belongs to whoever holds `writing`, but for the index: whoever searches takes
/// the one that is there, and goes on with it while the next one is made.
struct Database::State {
  State(internal::OpenedStore opened, const std::string& lasting_url,
        const DatabaseSettings& settings);
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { save_if_useful(); }

  /// Reads the index that was saved, if there is a good one, and all that came since.
  Result<void> read();
  Result<void> take_saved_index();
  /// Reads what came since `reached`; returns the number of rows.
  Result<std::int64_t> catch_up();
  /// Reads what the store is of, if that was not known yet. False if nothing is in it.
  Result<bool> is_filled();
  Result<internal::StoreChanges> read_fresh(FreshRows& fresh,
                                            std::unordered_set<std::int64_t>& seen);
  /// Forgets rows, and adds others.
  void change(const std::vector<std::int64_t>& gone, FreshRows fresh);
  void save_if_useful();

  [[nodiscard]] std::shared_ptr<const KindIndexes> kinds() const {
    const std::lock_guard lock(publishing);
    return published;
  }
  /// Not all rows are in memory.
  [[nodiscard]] bool is_partial() const { return is_too_large || rows.cache().is_full(); }
  [[nodiscard]] std::unordered_set<std::int64_t> known_ids() const;

  const std::string url;  ///< for messages
  const ExperienceSpace space;
  const bool is_too_large;
  std::atomic<std::uint64_t> iterations = 0;  ///< since a row was earned
  const std::string index_file;               // empty if there is no place for one
  internal::RowLoader rows;

  std::mutex writing;
  int schema_version;
  std::unique_ptr<internal::Store> store;
  StoreState reached;
  std::int64_t saved_size = 0;  // of the index in the file

  mutable std::mutex publishing;
  std::shared_ptr<const KindIndexes> published;  // never null
};

Database::State::State(internal::OpenedStore opened, const std::string& lasting_url,
                       const DatabaseSettings& settings)
    : url(opened.store->name()),
      space(std::move(opened.space)),
      is_too_large(opened.store->bytes().value_or(0) > settings.memory_bytes),
      index_file(internal::index_file_of(lasting_url)),
      rows(lasting_url, space, settings.memory_bytes),
      schema_version(opened.schema_version),
      store(std::move(opened.store)),
      published(std::make_shared<const KindIndexes>()) {}

Result<void> Database::State::take_saved_index() {
  if (!is_too_large || index_file.empty()) return {};
  auto saved = internal::load_index(index_file, space);
  if (!saved) return {};
  const auto transaction = store->begin(internal::Store::Kind::read);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto head = (*transaction)->head();
  if (!head) return tl::unexpected(head.error());
  // Of the same epoch only new rows need be read, and the digest tells whether the old ones are
  // those of the index. Otherwise it may be that of another file which had this one's name.
  if (head->epoch != saved->state.epoch || head->row_count < saved->state.row_count) return {};
  reached = saved->state;
  saved_size = size_of(saved->kinds);
  published = std::make_shared<const KindIndexes>(std::move(saved->kinds));
  return {};
}

Result<void> Database::State::read() {
  if (const auto taken = take_saved_index(); !taken) return taken;
  auto done = catch_up();
  if (!done && saved_size > 0) {
    reached = {};
    saved_size = 0;
    published = std::make_shared<const KindIndexes>();
    done = catch_up();
  }
  if (!done) return tl::unexpected(done.error());
  save_if_useful();
  return {};
}

void Database::State::save_if_useful() {
  const std::int64_t size = size_of(*published);
  const bool is_stale = size - saved_size > size / 8 || saved_size > size;
  if (index_file.empty() || !is_stale || !is_partial()) return;
  if (internal::save_index(index_file, space, reached, *published)) saved_size = size;
}

std::unordered_set<std::int64_t> Database::State::known_ids() const {
  std::unordered_set<std::int64_t> known;
  visit_trees(*published, [&](auto ids) { known.insert(ids.begin(), ids.end()); });
  return known;
}

void Database::State::change(const std::vector<std::int64_t>& gone, FreshRows fresh) {
  auto next = std::make_shared<KindIndexes>(*published);
  if (!gone.empty()) {
    const std::unordered_set<std::int64_t> ids(gone.begin(), gone.end());
    for (auto& [kind, index] : *next) {
      index.remove([&](std::int64_t id) { return ids.contains(id); });
    }
    std::erase_if(*next, [](const auto& kind) { return kind.second.size() == 0; });
    rows.cache().forget(gone);
  }
  for (auto& [kind, keys] : fresh.kinds) {
    const auto key_size = static_cast<int>(keys.keys.size() / keys.ids.size());
    next->try_emplace(kind, key_size).first->second.append(std::move(keys));
  }
  rows.cache().keep(fresh.rows);
  std::shared_ptr<const KindIndexes> last = std::move(next);
  const std::lock_guard lock(publishing);
  std::swap(published, last);
}

Result<bool> Database::State::is_filled() {
  if (schema_version > 0) return true;
  const auto version = store->schema_version();
  if (!version) return tl::unexpected(version.error());
  if (*version == 0) return false;
  const auto found = store->space();
  if (!found) return tl::unexpected(found.error());
  if (!internal::is_same_space(*found, space)) return internal::refuse_space(url, *found, space);
  schema_version = *version;
  return true;
}

Result<internal::StoreChanges> Database::State::read_fresh(FreshRows& fresh,
                                                           std::unordered_set<std::int64_t>& seen) {
  const auto parts = is_partial() ? RowParts::keys : RowParts::all;
  std::unordered_set<std::int64_t> known;
  internal::KeySizes sizes = sizes_of(*published);
  const auto visit = [&](const internal::StoredRow& row) -> Result<void> {
    if (row.id <= reached.last_row) {
      if (known.empty()) known = known_ids();
      seen.insert(row.id);
      if (known.contains(row.id)) return {};
    }
    auto experience = std::make_shared<Experience>();
    auto flaw = parts == RowParts::all ? internal::decode(row, space, *experience)
                                       : internal::decode_key(row, *experience);
    if (!flaw) flaw = sizes.check(experience->kind, experience->key.size());
    if (flaw) {
      return fail(ErrorCode::corrupt, fmt::format("{}: row {} is damaged: {}", url, row.id, *flaw));
    }
    fresh.add(*experience, row.components);
    if (parts == RowParts::all) fresh.rows.push_back(std::move(experience));
    return {};
  };
  return internal::read_changes(*store, reached, parts, visit);
}

Result<std::int64_t> Database::State::catch_up() {
  const auto filled = is_filled();
  if (!filled) return tl::unexpected(filled.error());
  if (!*filled) return 0;
  FreshRows fresh;
  std::unordered_set<std::int64_t> seen;
  const auto changes = read_fresh(fresh, seen);
  if (!changes) return tl::unexpected(changes.error());
  std::vector<std::int64_t> gone;
  if (changes->is_complete || !changes->buried.empty()) {
    visit_trees(*published, [&](auto ids) {
      std::ranges::copy_if(ids, std::back_inserter(gone), [&](std::int64_t id) {
        return changes->buried.contains(id) || (changes->is_complete && !seen.contains(id));
      });
    });
  }
  const std::int64_t count = fresh.count;
  rows.set_epoch(changes->state.epoch);
  if (count > 0 || !gone.empty()) change(gone, std::move(fresh));
  reached = changes->state;
  return count;
}

Database::Database(std::unique_ptr<State> state) : state_(std::move(state)) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Result<Database> Database::load(Result<internal::OpenedStore> opened, const std::string& url,
                                const DatabaseSettings& settings) {
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  const bool is_empty = opened->schema_version == 0;
  auto state = std::make_unique<State>(std::move(*opened), internal::lasting_url(url), settings);
  if (!is_empty) {
    const auto read = state->read();
    if (!read) return tl::unexpected(internal::with_advice(read.error(), url));
  }
  return Database(std::move(state));
}

Result<Database> Database::open(const std::string& url, const ExperienceSpace& space, OpenMode mode,
                                const DatabaseSettings& settings) {
  return load(internal::open_store_of(url, space, mode), url, settings);
}

Result<Database> Database::inspect(const std::string& url, const DatabaseSettings& settings) {
  return load(internal::inspect_store(url), url, settings);
}

const ExperienceSpace& Database::space() const { return state_->space; }

DatabaseInfo Database::info() const {
  const std::lock_guard writing(state_->writing);
  DatabaseInfo info;
  info.url = state_->url;
  info.space = state_->space;
  info.kinds = kinds();
  for (const KindInfo& kind : info.kinds) {
    info.samplers += kind.samplers;
    info.components += kind.components;
  }
  info.bytes = state_->store->bytes().value_or(0);
  info.schema_version = state_->schema_version;
  info.generation = state_->reached.generation;
  info.tombstones = state_->reached.tombstone_count;
  return info;
}

std::vector<KindInfo> Database::kinds() const {
  std::vector<KindInfo> infos;
  for (const auto& [kind, index] : *state_->kinds()) {
    infos.push_back({kind, index.key_size(), index.size(), index.components()});
  }
  return infos;
}

std::int64_t Database::size() const { return size_of(*state_->kinds()); }

Result<Experience> Database::get(std::int64_t position) const {
  const auto kinds = state_->kinds();
  const std::int64_t size = size_of(*kinds);
  if (position < 0 || position >= size) {
    return fail(ErrorCode::invalid, fmt::format("{}: there is no row {}; expected 0 to {}",
                                                state_->url, position, size - 1));
  }
  auto kind = kinds->begin();
  for (; position >= kind->second.size(); ++kind) position -= kind->second.size();
  const std::int64_t id = kind->second.id(position);
  const auto rows = state_->rows.load({&id, 1}, true);
  if (!rows) return tl::unexpected(rows.error());
  if (rows->front() != nullptr) return *rows->front();
  return fail(ErrorCode::corrupt, fmt::format("{}: row {} was set aside", state_->url, id));
}

Result<void> Database::for_each(
    const std::function<void(const std::shared_ptr<const Experience>&)>& visit) const {
  constexpr std::size_t kRowsAtOnce = 500;
  const auto kinds = state_->kinds();
  Result<void> done;
  visit_trees(*kinds, [&](std::span<const std::int64_t> ids) {
    while (!ids.empty() && done) {
      const auto part = ids.first(std::min(kRowsAtOnce, ids.size()));
      ids = ids.subspan(part.size());
      done = state_->rows.load(part, false).map([&](const std::vector<SharedExperience>& rows) {
        for (const SharedExperience& row : rows) {
          if (row != nullptr) visit(row);
        }
      });
    }
  });
  return done;
}

Result<std::vector<KeyMatch>> Database::find(std::string_view kind,
                                             std::span<const std::vector<double>> images,
                                             double threshold, int max_matches,
                                             std::int64_t* keys_left) const {
  std::vector<KeyMatch> matches;
  const auto kinds = state_->kinds();
  const auto index = kinds->find(kind);
  if (index == kinds->end()) return matches;
  const auto key_size = static_cast<std::size_t>(index->second.key_size());
  if (std::ranges::any_of(images, [&](const auto& key) { return key.size() != key_size; })) {
    return matches;
  }
  const auto found = index->second.find(images, threshold, max_matches, keys_left);
  std::vector<std::int64_t> ids;
  for (const internal::IndexMatch& match : found) ids.push_back(match.id);
  auto rows = state_->rows.load(ids, true);
  if (!rows) return tl::unexpected(rows.error());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (rows->at(i) == nullptr) continue;
    matches.push_back({std::move(rows->at(i)), found[i].error, found[i].image});
  }
  return matches;
}

Result<std::vector<std::int64_t>> Database::insert(std::vector<Experience> rows,
                                                   std::vector<bool>* is_new) {
  const auto prepared = internal::prepare_rows(rows, state_->space);
  if (!prepared) return tl::unexpected(prepared.error());
  const std::lock_guard writing(state_->writing);
  auto appended = internal::append_rows(*state_->store, rows, internal::Duplicates::keep_first);
  if (!appended) return tl::unexpected(appended.error());
  if (is_new != nullptr) *is_new = appended->is_new;
  if (appended->before != state_->reached) {
    // The rows are safe, whatever becomes of those of others: refresh() will tell.
    (void)state_->catch_up();
    return appended->ids;
  }
  FreshRows fresh;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!appended->is_new[i]) continue;
    rows[i].id = appended->ids[i];
    fresh.add(rows[i], rows[i].sampler.component_count());
    fresh.rows.push_back(std::make_shared<const Experience>(std::move(rows[i])));
  }
  if (fresh.count > 0) state_->change({}, std::move(fresh));
  state_->reached = appended->state;
  return appended->ids;
}

bool Database::earns_row(std::uint64_t iterations, std::uint64_t price) {
  std::uint64_t before = state_->iterations;
  for (;;) {
    const bool is_earned = before + iterations >= price;
    if (state_->iterations.compare_exchange_weak(before, is_earned ? 0 : before + iterations)) {
      return is_earned;
    }
  }
}

Result<std::int64_t> Database::refresh() {
  const std::lock_guard writing(state_->writing);
  return state_->catch_up();
}

ExperienceSpace make_space(const Robot& robot) {
  return {internal::storable_text(robot.name()),
          internal::join_hashes(robot.kinematics_hash(), robot.hash()), robot.joint_count()};
}

RobotHashes hashes_of(const ExperienceSpace& space) {
  return {std::string(internal::kinematics_of(space)), std::string(internal::model_of(space))};
}

RobotDifference compare_robots(const ExperienceSpace& learned_with, const ExperienceSpace& robot) {
  if (internal::is_same_space(learned_with, robot)) {
    const bool is_same_model = internal::model_of(learned_with) == internal::model_of(robot);
    return is_same_model ? RobotDifference::none : RobotDifference::shapes;
  }
  return internal::has_same_frames(learned_with, robot) ? RobotDifference::limits
                                                        : RobotDifference::frames;
}

}  // namespace mneme

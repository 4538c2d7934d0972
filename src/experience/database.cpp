// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "base/fail.h"
#include "base/text.h"
#include "experience/index_file.h"
#include "experience/kind_accounts.h"
#include "engines/open_store.h"
#include "store/row_check.h"
#include "experience/row_loader.h"
#include "experience/write_queue.h"
#include "store/store.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <unordered_set>
#include <utility>

namespace mneme {

using internal::ExperienceIndex;
using internal::GroupIndexes;
using internal::RowParts;
using internal::SharedExperience;
using internal::StoreState;

namespace {

/// Rows to add to the index and the cache.
struct FreshRows {
  std::map<internal::RowGroup, internal::IndexRows> groups;
  std::int64_t count = 0;
  std::vector<SharedExperience> rows;  // complete rows only

  void add(const Experience& row, std::uint64_t constraints, std::int64_t components) {
    internal::IndexRows& keys = groups[{row.kind, constraints}];
    keys.ids.push_back(row.id);
    keys.components.push_back(static_cast<std::int32_t>(components));
    keys.keys.insert(keys.keys.end(), row.key.begin(), row.key.end());
    ++count;
  }
};

std::int64_t size_of(const GroupIndexes& groups) {
  std::int64_t size = 0;
  for (const auto& [group, index] : groups) size += index.size();
  return size;
}

/// Passes the ids of each tree to `visit`, group by group.
template <class Visit>
void visit_trees(const GroupIndexes& groups, const Visit& visit) {
  for (const auto& [group, index] : groups) {
    for (const auto& tree : index.trees()) visit(std::span<const std::int64_t>(tree->data().ids));
  }
}

internal::KeySizes sizes_of(const GroupIndexes& groups) {
  internal::KeySizes sizes;
  for (const auto& [group, index] : groups) {
    (void)sizes.check(group.kind, static_cast<std::size_t>(index.key_size()));
  }
  return sizes;
}

}  // namespace

/// `writing` guards all members that are not const, except the published index: a search takes a
/// snapshot of it and continues with that while the next one is built.
struct Database::State {
  /// `stop` ends calls of the store that wait.
  State(internal::OpenedStore opened, const std::string& lasting_url, OpenMode mode,
        const DatabaseSettings& settings, std::unique_ptr<std::atomic<bool>> stop);
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();

  /// Reads the saved index, if it is valid, and all rows added since.
  Result<void> read();
  Result<void> take_saved_index();
  /// Reads rows added since `last_state`; returns their number.
  Result<std::int64_t> catch_up();
  /// Reads the signature if not yet known. False if the store is empty.
  Result<bool> is_filled();
  Result<internal::StoreChanges> read_fresh(FreshRows& fresh,
                                            std::unordered_set<std::int64_t>& seen);
  Result<std::vector<std::int64_t>> insert(std::vector<Experience> rows, std::vector<bool>* is_new);
  Result<void> queue_rows(std::int64_t count, internal::WriteQueue::Make make);
  /// Removes and adds rows in memory.
  void change(const std::vector<std::int64_t>& removed, FreshRows fresh);
  void save_if_useful();

  [[nodiscard]] std::shared_ptr<const GroupIndexes> groups() const {
    const std::lock_guard lock(publishing);
    return published;
  }
  /// Not all rows are in memory.
  [[nodiscard]] bool is_partial() const { return is_too_large || rows.cache().is_full(); }
  [[nodiscard]] std::unordered_set<std::int64_t> known_ids() const;

  const std::string url;  ///< for messages
  const RobotSignature signature;
  const bool is_too_large;
  const bool is_writable;
  const std::unique_ptr<std::atomic<bool>> stop;  // stores point to it
  std::atomic<std::uint64_t> iterations = 0;      ///< since a row was earned
  internal::KindAccounts accounts;
  const std::string index_file;  // empty: none
  internal::RowLoader rows;

  std::mutex writing;
  int schema_version;
  std::unique_ptr<internal::Store> store;
  StoreState last_state;
  std::int64_t saved_size = 0;  // rows in the index file

  mutable std::mutex publishing;
  std::shared_ptr<const GroupIndexes> published;  // never null

  internal::WriteQueue queue;  // last: its thread uses the other members
};

Database::State::~State() {
  constexpr double kLongest_s = 30;
  if (!*stop) (void)queue.flush(kLongest_s);
  const std::lock_guard lock(writing);
  save_if_useful();
  *stop = true;
}

Database::State::State(internal::OpenedStore opened, const std::string& lasting_url, OpenMode mode,
                       const DatabaseSettings& settings,
                       std::unique_ptr<std::atomic<bool>> stop_calls)
    : url(opened.store->name()),
      signature(std::move(opened.signature)),
      is_too_large(opened.store->bytes().value_or(0) > settings.memory_bytes),
      is_writable(mode != OpenMode::read_only),
      stop(std::move(stop_calls)),
      index_file(internal::index_file_of(lasting_url)),
      rows(lasting_url, signature, settings.memory_bytes, {settings.answer_timeout_s, stop.get()}),
      schema_version(opened.schema_version),
      store(std::move(opened.store)),
      published(std::make_shared<const GroupIndexes>()),
      queue([this](const std::vector<Experience>& queued) -> Result<std::int64_t> {
        std::vector<bool> is_new;
        MNEME_TRY(insert(queued, &is_new));
        return std::ranges::count(is_new, true);
      }) {}

Result<void> Database::State::take_saved_index() {
  if (!is_too_large || index_file.empty()) return {};
  auto saved = internal::load_index(index_file, signature);
  if (!saved) return {};
  const auto transaction = MNEME_TRY(store->begin(internal::Store::Kind::read));
  const auto head = MNEME_TRY(transaction->head());
  // Within an epoch only new rows must be read; the digest then shows if the old ones match the
  // index. In another epoch the index may belong to another file of the same name.
  if (head.epoch != saved->state.epoch || head.row_count < saved->state.row_count) return {};
  last_state = saved->state;
  saved_size = size_of(saved->groups);
  published = std::make_shared<const GroupIndexes>(std::move(saved->groups));
  return {};
}

Result<void> Database::State::read() {
  MNEME_TRY(take_saved_index());
  auto done = catch_up();
  if (!done && saved_size > 0) {
    last_state = {};
    saved_size = 0;
    published = std::make_shared<const GroupIndexes>();
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
  if (internal::save_index(index_file, signature, last_state, *published)) saved_size = size;
}

std::unordered_set<std::int64_t> Database::State::known_ids() const {
  std::unordered_set<std::int64_t> known;
  visit_trees(*published, [&](auto ids) { known.insert(ids.begin(), ids.end()); });
  return known;
}

void Database::State::change(const std::vector<std::int64_t>& removed, FreshRows fresh) {
  auto next = std::make_shared<GroupIndexes>(*published);
  if (!removed.empty()) {
    const std::unordered_set<std::int64_t> ids(removed.begin(), removed.end());
    for (auto& [group, index] : *next) {
      index.remove([&](std::int64_t id) { return ids.contains(id); });
    }
    std::erase_if(*next, [](const auto& group) { return group.second.size() == 0; });
    rows.cache().forget(removed);
  }
  for (auto& [group, keys] : fresh.groups) {
    const auto key_size = static_cast<int>(keys.keys.size() / keys.ids.size());
    next->try_emplace(group, key_size).first->second.append(std::move(keys));
  }
  rows.cache().keep(fresh.rows);
  std::shared_ptr<const GroupIndexes> last = std::move(next);
  const std::lock_guard lock(publishing);
  std::swap(published, last);
}

Result<bool> Database::State::is_filled() {
  if (schema_version > 0) return true;
  const auto version = MNEME_TRY(store->schema_version());
  if (version == 0) return false;
  const auto found = MNEME_TRY(store->signature());
  if (!internal::is_same_robot(found, signature))
    return internal::refuse_robot(url, found, signature);
  schema_version = version;
  return true;
}

Result<internal::StoreChanges> Database::State::read_fresh(FreshRows& fresh,
                                                           std::unordered_set<std::int64_t>& seen) {
  const auto parts = is_partial() ? RowParts::keys : RowParts::all;
  std::unordered_set<std::int64_t> known;
  internal::KeySizes sizes = sizes_of(*published);
  const auto visit = [&](const internal::StoredRow& row) -> Result<void> {
    if (row.id <= last_state.last_row) {
      if (known.empty()) known = known_ids();
      seen.insert(row.id);
      if (known.contains(row.id)) return {};
    }
    auto experience = std::make_shared<Experience>();
    auto flaw = parts == RowParts::all ? internal::decode(row, signature, *experience)
                                       : internal::decode_key(row, *experience);
    if (!flaw) flaw = sizes.check(experience->kind, experience->key.size());
    if (flaw) {
      return fail(ErrorCode::corrupt, "{}: row {} is damaged: {}", url, row.id, *flaw);
    }
    fresh.add(*experience, std::bit_cast<std::uint64_t>(row.columns.constraints), row.components);
    if (parts == RowParts::all) fresh.rows.push_back(std::move(experience));
    return {};
  };
  return internal::read_changes(*store, last_state, parts, visit);
}

Result<std::int64_t> Database::State::catch_up() {
  const auto filled = MNEME_TRY(is_filled());
  if (!filled) return 0;
  FreshRows fresh;
  std::unordered_set<std::int64_t> seen;
  const auto changes = MNEME_TRY(read_fresh(fresh, seen));
  std::vector<std::int64_t> removed;
  if (changes.is_complete || !changes.dead.empty()) {
    visit_trees(*published, [&](auto ids) {
      std::ranges::copy_if(ids, std::back_inserter(removed), [&](std::int64_t id) {
        return changes.dead.contains(id) || (changes.is_complete && !seen.contains(id));
      });
    });
  }
  const std::int64_t count = fresh.count;
  rows.set_epoch(changes.state.epoch);
  if (count > 0 || !removed.empty()) change(removed, std::move(fresh));
  last_state = changes.state;
  return count;
}

Database::Database(std::unique_ptr<State> state) : state_(std::move(state)) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Result<Database> Database::load(const Opener& open_with, const std::string& url, OpenMode mode,
                                const DatabaseSettings& settings) {
  auto stop = std::make_unique<std::atomic<bool>>(false);
  internal::OpenOptions options;
  options.patience = {settings.answer_timeout_s, stop.get()};
  auto opened = open_with(options);
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  const bool is_empty = opened->schema_version == 0;
  auto state = std::make_unique<State>(std::move(*opened), internal::lasting_url(url), mode,
                                       settings, std::move(stop));
  if (!is_empty) {
    const auto read = state->read();
    if (!read) return tl::unexpected(internal::with_advice(read.error(), url));
  }
  return Database(std::move(state));
}

Result<Database> Database::open(const std::string& url, const RobotSignature& signature,
                                OpenMode mode, const DatabaseSettings& settings) {
  const auto opener = [&](const internal::OpenOptions& options) {
    return internal::open_store_of(url, signature, mode, options);
  };
  return load(opener, url, mode, settings);
}

Result<Database> Database::inspect(const std::string& url, const DatabaseSettings& settings) {
  const auto opener = [&](const internal::OpenOptions& options) {
    return internal::inspect_store(url, options);
  };
  return load(opener, url, OpenMode::read_only, settings);
}

const RobotSignature& Database::signature() const { return state_->signature; }

DatabaseInfo Database::info() const {
  const std::lock_guard writing(state_->writing);
  (void)state_->is_filled();  // a new file may have got its first row
  DatabaseInfo info;
  info.url = state_->url;
  info.signature = state_->signature;
  info.kinds = kinds();
  for (const KindInfo& kind : info.kinds) {
    info.samplers += kind.samplers;
    info.components += kind.components;
  }
  info.bytes = state_->store->bytes().value_or(0);
  info.schema_version = state_->schema_version;
  info.generation = state_->last_state.generation;
  info.tombstones = state_->last_state.tombstone_count;
  info.record_flaw = state_->store->record_flaw();
  return info;
}

std::vector<KindInfo> Database::kinds() const {
  std::vector<KindInfo> infos;
  const auto groups = state_->groups();
  for (const auto& [group, index] : *groups) {
    const bool is_first = infos.empty() || infos.back().kind != group.kind;
    if (is_first) infos.push_back({group.kind, index.key_size()});
    infos.back().samplers += index.size();
    infos.back().components += index.components();
  }
  return infos;
}

std::int64_t Database::size() const { return size_of(*state_->groups()); }

Result<Experience> Database::get(std::int64_t position) const {
  const auto groups = state_->groups();
  const std::int64_t size = size_of(*groups);
  if (position < 0 || position >= size) {
    return fail(ErrorCode::invalid, "{}: there is no row {}; expected 0 to {}", state_->url,
                position, size - 1);
  }
  auto group = groups->begin();
  for (; position >= group->second.size(); ++group) position -= group->second.size();
  const std::int64_t id = group->second.id(position);
  const auto rows = MNEME_TRY(state_->rows.load({&id, 1}, internal::Caching::keep));
  if (rows.front() != nullptr) return *rows.front();
  return fail(ErrorCode::corrupt, "{}: row {} was set aside as damaged or superseded", state_->url,
              id);
}

Result<void> Database::for_each(
    const std::function<void(const std::shared_ptr<const Experience>&)>& visit) const {
  constexpr std::size_t kRowsAtOnce = 500;
  const auto groups = state_->groups();
  Result<void> done;
  visit_trees(*groups, [&](std::span<const std::int64_t> ids) {
    while (!ids.empty() && done) {
      const auto part = ids.first(std::min(kRowsAtOnce, ids.size()));
      ids = ids.subspan(part.size());
      done = state_->rows.load(part, internal::Caching::pass)
                 .map([&](const std::vector<SharedExperience>& rows) {
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
                                             std::int64_t* keys_left,
                                             std::uint64_t constraints) const {
  std::vector<KeyMatch> matches;
  const auto groups = state_->groups();
  std::vector<internal::IndexMatch> found;
  for (auto group = groups->lower_bound({std::string(kind), 0});
       group != groups->end() && group->first.kind == kind; ++group) {
    const auto& [rows_of, index] = *group;
    const auto key_size = static_cast<std::size_t>(index.key_size());
    const bool fits =
        std::ranges::all_of(images, [&](const auto& key) { return key.size() == key_size; });
    if (!fits || !internal::is_same_constraints(rows_of.constraints, constraints)) continue;
    const auto more = index.find(images, threshold, max_matches, keys_left);
    found.insert(found.end(), more.begin(), more.end());
  }
  std::ranges::sort(found, internal::is_nearer);
  if (max_matches > 0 && std::ssize(found) > max_matches) {
    found.resize(static_cast<std::size_t>(max_matches));
  }
  std::vector<std::int64_t> ids;
  for (const internal::IndexMatch& match : found) ids.push_back(match.id);
  auto rows = MNEME_TRY(state_->rows.load(ids, internal::Caching::keep));
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (rows.at(i) == nullptr) continue;
    matches.push_back({std::move(rows.at(i)), found[i].error, found[i].image});
  }
  return matches;
}

Result<std::vector<std::int64_t>> Database::State::insert(std::vector<Experience> added,
                                                          std::vector<bool>* is_new) {
  MNEME_TRY(internal::prepare_rows(added, signature));
  const std::lock_guard lock(writing);
  auto appended = MNEME_TRY(internal::append_rows(*store, added, internal::Duplicates::keep_first));
  if (is_new != nullptr) *is_new = appended.is_new;
  if (appended.before != last_state) {
    // This call's rows are stored. Errors with other processes' rows surface at the next refresh().
    (void)catch_up();
    return appended.ids;
  }
  FreshRows fresh;
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (!appended.is_new[i]) continue;
    added[i].id = appended.ids[i];
    fresh.add(added[i], added[i].constraints(), added[i].component_count());
    fresh.rows.push_back(std::make_shared<const Experience>(std::move(added[i])));
  }
  if (fresh.count > 0) change({}, std::move(fresh));
  last_state = appended.state;
  return appended.ids;
}

Result<std::vector<std::int64_t>> Database::insert(std::vector<Experience> rows,
                                                   std::vector<bool>* is_new) {
  return state_->insert(std::move(rows), is_new);
}

Result<void> Database::State::queue_rows(std::int64_t count, internal::WriteQueue::Make make) {
  if (!is_writable) return fail(ErrorCode::io, "{}: is open for reading only", url);
  if (*stop) return fail(ErrorCode::io, "{}: takes no more rows, because it is being closed", url);
  if (count > 0) queue.push(count, std::move(make));
  return {};
}

Result<void> Database::insert_later(std::vector<Experience> rows) {
  MNEME_TRY(internal::prepare_rows(rows, state_->signature));
  const std::int64_t count = std::ssize(rows);
  return state_->queue_rows(count, [made = std::move(rows)]() mutable { return std::move(made); });
}

Result<void> Database::insert_later(MakeRows make) {
  return state_->queue_rows(
      1, [&state = *state_, made_by = std::move(make)]() -> Result<std::vector<Experience>> {
        auto rows = MNEME_TRY(made_by(*state.stop));
        MNEME_TRY(internal::prepare_rows(rows, state.signature));
        return rows;
      });
}

Result<void> Database::flush(double timeout_s) {
  if (state_->queue.flush(timeout_s)) return {};
  const QueuedRows rows = state_->queue.counts();
  return fail(ErrorCode::io, "{}: {} rows are not stored yet: {}", state_->url, rows.waiting,
              rows.failure.empty() ? "the first attempt has not ended" : rows.failure);
}

QueuedRows Database::queued_rows() const { return state_->queue.counts(); }

void Database::stop_waiting() { *state_->stop = true; }

Result<std::unordered_set<std::uint64_t>> Database::finished_lessons() const {
  const std::lock_guard writing(state_->writing);
  std::unordered_set<std::uint64_t> finished, unfinished;
  const bool is_filled = MNEME_TRY(state_->is_filled());
  if (!is_filled) return finished;
  const auto transaction = MNEME_TRY(state_->store->begin(internal::Store::Kind::read));
  const auto marks = MNEME_TRY(transaction->read_lessons());
  for (const auto& mark : marks) (mark.is_live ? finished : unfinished).insert(mark.lesson);
  for (const std::uint64_t lesson : unfinished) finished.erase(lesson);
  return finished;
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

void Database::book(std::string_view kind, std::uint64_t spent, std::uint64_t saved) {
  state_->accounts.book(kind, spent, saved);
}

double Database::trust(std::string_view kind) const { return state_->accounts.trust(kind); }

bool Database::pays(std::string_view kind) const { return state_->accounts.pays(kind); }

Result<std::int64_t> Database::refresh() {
  const std::lock_guard writing(state_->writing);
  return state_->catch_up();
}

RobotSignature make_signature(const Robot& robot) {
  return {internal::escape_bytes(robot.name()), robot.kinematics_hash(), robot.hash(),
          robot.joint_count()};
}

Result<void> check_robot(const Robot& robot, const Database& database) {
  // Comparing models is faster than hashing joints, which would dominate an easy query.
  if (database.signature().model_hash == robot.hash()) return {};
  const RobotSignature wanted = make_signature(robot);
  // A database without rows fits every robot.
  const bool is_empty = database.signature().model_hash.empty();
  if (is_empty || internal::is_same_robot(database.signature(), wanted)) return {};
  return internal::refuse_robot(database.info().url, database.signature(), wanted);
}

RobotDifference compare_robots(const RobotSignature& learned_with, const RobotSignature& robot) {
  if (internal::is_same_robot(learned_with, robot)) {
    return learned_with.model_hash == robot.model_hash ? RobotDifference::none
                                                       : RobotDifference::shapes;
  }
  return internal::has_same_frames(learned_with, robot) ? RobotDifference::limits
                                                        : RobotDifference::frames;
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "experience/database_file.h"
#include "experience/experience_index.h"
#include "experience/experience_table.h"
#include "experience/row_check.h"
#include "experience/schema.h"
#include "experience/space.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <mutex>
#include <shared_mutex>

namespace mneme {

using internal::Connection;
using internal::FileKind;

/// `connection` belongs to whoever holds `writing`; everything after `mutex` to whoever holds that.
/// insert() holds `writing` throughout, so that positions and ids have the same order.
struct Database::State {
  State(std::string url_, ExperienceSpace space_, int schema_version_)
      : url(std::move(url_)),
        space(std::move(space_)),
        schema_version(schema_version_),
        index(std::max(space.key_size, 1)) {}

  /// With `wanted`, which a writer must give, any other space is an error.
  static Result<std::unique_ptr<State>> open(const std::string& path, const ExperienceSpace* wanted,
                                             OpenMode mode);
  static Result<std::unique_ptr<State>> load(Connection& connection, const ExperienceSpace* wanted);

  void append(Experience row) {
    index.append(row.key);
    components += row.sampler.component_count();
    rows.push_back(std::move(row));
  }

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
  const int schema_version;
  std::mutex writing;
  std::optional<Connection> connection;  // none if opened for reading

  mutable std::mutex door;
  mutable std::shared_mutex mutex;
  std::deque<Experience> rows;  // never moves an element, so that Matches stay valid
  internal::ExperienceIndex index;
  std::int64_t components = 0;
};

namespace {

Error with_advice(Error error, const std::string& path) {
  if (error.code == ErrorCode::corrupt) {
    error.message += fmt::format("; `mneme db verify {}` lists all damage", path);
  }
  return error;
}

std::string now() {
  const auto time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

/// Makes the file a database of `space` if there is nothing in it yet, and ready to be written.
Result<void> prepare_for_writing(Connection& connection, const ExperienceSpace& space) {
  const auto kind = internal::identify(connection);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == FileKind::empty) {
    const auto created = internal::create_schema(connection, space);
    if (!created) return created;
  }
  return internal::check_pages(connection).and_then([&] { return connection.enter_wal_mode(); });
}

Result<void> load_rows(Connection& connection, const ExperienceSpace& space,
                       const std::function<void(Experience)>& append) {
  return internal::read_rows(connection, [&](const internal::StoredRow& row) -> Result<void> {
    Experience experience;
    experience.id = row.id;
    if (const auto flaw = internal::decode(row.content, row.checksum, space, experience)) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: row {} is damaged: {}", connection.path(), row.id, *flaw));
    }
    append(std::move(experience));
    return {};
  });
}

/// Completes rows for storage. Errors: invalid, naming the row.
Result<void> prepare(std::vector<Experience>& rows, const ExperienceSpace& space) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto flaw = internal::describe_flaw(rows[i], space)) {
      return fail(ErrorCode::invalid,
                  fmt::format("row {} of {} cannot be inserted: {}", i, rows.size(), *flaw));
    }
    rows[i].sampler.joint_count = space.joint_count;
    if (rows[i].provenance.time.empty()) rows[i].provenance.time = now();
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<Database::State>> Database::State::load(Connection& connection,
                                                               const ExperienceSpace* wanted) {
  auto transaction = internal::Transaction::begin(connection, internal::Transaction::Kind::read);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto kind = internal::identify(connection);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == FileKind::empty) {
    return std::make_unique<State>(connection.path(), wanted ? *wanted : ExperienceSpace{}, 0);
  }
  auto space = internal::read_space(connection);
  if (!space) return tl::unexpected(space.error());
  if (wanted != nullptr && !internal::is_same_space(*space, *wanted)) {
    return internal::refuse_space(connection.path(), *space, *wanted);
  }
  auto state = std::make_unique<State>(connection.path(), *space, internal::kSchemaVersion);
  const auto loaded =
      load_rows(connection, state->space, [&](Experience row) { state->append(std::move(row)); });
  if (!loaded) return tl::unexpected(loaded.error());
  state->index.refresh();
  return state;
}

Result<std::unique_ptr<Database::State>> Database::State::open(const std::string& path,
                                                               const ExperienceSpace* wanted,
                                                               OpenMode mode) {
  const bool is_writer = mode != OpenMode::read_only;
  auto connection = is_writer ? internal::open_for_writing(path, mode == OpenMode::create)
                              : internal::open_for_reading(path);
  if (!connection) return tl::unexpected(connection.error());
  if (is_writer) {
    const auto created = prepare_for_writing(*connection, *wanted);
    if (!created) return tl::unexpected(created.error());
  }
  auto state = load(*connection, wanted);
  if (state && is_writer) (*state)->connection = std::move(*connection);
  return state;
}

Database::Database(std::unique_ptr<State> state) : state_(std::move(state)) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Result<Database> Database::open(const std::string& path, const ExperienceSpace& space,
                                OpenMode mode) {
  if (space.joint_count < 1 || space.key_size < 1) {
    return fail(ErrorCode::invalid,
                fmt::format("{}: cannot hold experience of {}", path, internal::describe(space)));
  }
  auto state = State::open(path, &space, mode);
  if (!state) return tl::unexpected(with_advice(state.error(), path));
  return Database(std::move(*state));
}

Result<Database> Database::inspect(const std::string& path) {
  auto state = State::open(path, nullptr, OpenMode::read_only);
  if (!state) return tl::unexpected(with_advice(state.error(), path));
  return Database(std::move(*state));
}

const ExperienceSpace& Database::space() const { return state_->space; }

DatabaseInfo Database::info() const {
  const auto lock = state_->lock_to_read();
  return {state_->url,
          state_->space,
          static_cast<std::int64_t>(state_->rows.size()),
          state_->components,
          internal::bytes_on_disk(state_->url),
          state_->schema_version};
}

std::int64_t Database::size() const {
  const auto lock = state_->lock_to_read();
  return static_cast<std::int64_t>(state_->rows.size());
}

const Experience& Database::get(std::int64_t position) const {
  const auto lock = state_->lock_to_read();
  return state_->rows[static_cast<std::size_t>(position)];
}

std::vector<Match> Database::find(const LocalPrimitive& primitive, double threshold,
                                  int max_matches) const {
  if (primitive.key.size() != static_cast<std::size_t>(state_->space.key_size)) return {};
  const std::vector<KeyImage> queries = images(primitive.key);
  const auto lock = state_->lock_to_read();
  std::vector<Match> matches;
  for (const auto& found : state_->index.find(queries, threshold, max_matches)) {
    const Symmetry to_canonical{0, queries[found.image].is_mirrored};
    matches.push_back(
        {&state_->rows[found.position], found.error, compose(primitive.to_scene, to_canonical)});
  }
  return matches;
}

Result<std::vector<std::int64_t>> Database::insert(std::vector<Experience> rows) {
  const auto prepared = prepare(rows, state_->space);
  if (!prepared) return tl::unexpected(prepared.error());
  const std::lock_guard writing(state_->writing);
  if (!state_->connection) {
    return fail(ErrorCode::io, fmt::format("{}: is open for reading only", state_->url));
  }
  auto ids = internal::append_rows(*state_->connection, rows);
  if (!ids) return ids;
  const auto lock = state_->lock_to_write();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].id = (*ids)[i];
    state_->append(std::move(rows[i]));
  }
  state_->index.refresh();
  return ids;
}

}  // namespace mneme

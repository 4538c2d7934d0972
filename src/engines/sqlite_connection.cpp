// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/sqlite_connection.h"

#include "base/fail.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Errors that a sound database of mneme cannot cause count as damage. A statement that does not
/// compile means that the tables were changed.
ErrorCode code_of(int status) {
  switch (status & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_ERROR:
    case SQLITE_SCHEMA:
    case SQLITE_FORMAT:
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
    case SQLITE_RANGE:
      return ErrorCode::corrupt;
    case SQLITE_TOOBIG:
      return ErrorCode::invalid;
    default:
      return ErrorCode::io;
  }
}

tl::unexpected<Error> sqlite_error(const std::string& path, sqlite3* handle, int status) {
  const char* reason = handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(status);
  const ErrorCode code = code_of(status);
  if (code == ErrorCode::corrupt) {
    return fail(code, "{}: not a mneme database, or damaged ({})", path, reason);
  }
  const bool is_busy = (status & 0xff) == SQLITE_BUSY || (status & 0xff) == SQLITE_LOCKED;
  return fail(code, "{}: {}{}", path, reason, is_busy ? " by another process" : "");
}

/// A name that SQLite always takes for a file, unlike an empty name or ":memory:".
std::string plain_name(const std::string& path) {
  return path.starts_with('/') ? path : "./" + path;
}

std::string immutable_uri(const std::string& path) {
  // The two slashes mean an empty host; otherwise a path that begins with two slashes would name
  // one.
  std::string uri = path.starts_with('/') ? "file://" : "file:";
  for (const char c : plain_name(path)) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement& Statement::add(std::int64_t value) {
  bind_status_ |= sqlite3_bind_int64(statement_.get(), ++last_added_, value);
  return *this;
}

Statement& Statement::add(std::string_view text) {
  bind_status_ |=
      sqlite3_bind_text64(statement_.get(), ++last_added_, text.data() ? text.data() : "",
                          text.size(), SQLITE_STATIC, SQLITE_UTF8);
  return *this;
}

Statement& Statement::add(std::span<const std::byte> blob) {
  // A null pointer would bind NULL instead of an empty blob.
  const void* data = blob.empty() ? static_cast<const void*>("") : blob.data();
  bind_status_ |=
      sqlite3_bind_blob64(statement_.get(), ++last_added_, data, blob.size(), SQLITE_STATIC);
  return *this;
}

Statement& Statement::add(std::optional<std::int64_t> value) {
  if (value) return add(*value);
  bind_status_ |= sqlite3_bind_null(statement_.get(), ++last_added_);
  return *this;
}

Result<bool> Statement::step() {
  sqlite3* handle = sqlite3_db_handle(statement_.get());
  if (bind_status_ != SQLITE_OK) return sqlite_error(*path_, handle, SQLITE_TOOBIG);
  const int status = sqlite3_step(statement_.get());
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  return sqlite_error(*path_, handle, status);
}

Result<void> Statement::for_each(const std::function<Result<void>()>& visit) {
  for (;;) {
    const bool has_row = MNEME_TRY(step());
    if (!has_row) return {};
    MNEME_TRY(visit());
  }
}

Result<void> Statement::run() {
  const auto done = step();
  reset();
  return done.map([](bool) {});
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
  bind_status_ = SQLITE_OK;
  last_added_ = 0;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string_view Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return data == nullptr ? std::string_view() : std::string_view(data, std::size_t(size));
}

std::span<const std::byte> Statement::blob(int column) const {
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  const int size = sqlite3_column_bytes(statement_.get(), column);
  if (data == nullptr) return {};
  return {data, static_cast<std::size_t>(size)};
}

void Connection::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

Result<Connection> Connection::open(const std::string& path, Access access) {
  if (access == Access::immutable) {
    auto connection =
        MNEME_TRY(open(path, immutable_uri(path), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI));
    connection.is_immutable_ = true;
    return connection;
  }
  const int create = access == Access::create ? SQLITE_OPEN_CREATE : 0;
  return open(path, plain_name(path), SQLITE_OPEN_READWRITE | create);
}

Result<Connection> Connection::open(const std::string& path, const std::string& name, int flags) {
  sqlite3* handle = nullptr;
  const int status = sqlite3_open_v2(
      name.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE, nullptr);
  Connection connection;
  connection.path_ = std::make_unique<const std::string>(path);
  connection.handle_.reset(handle);
  if (status != SQLITE_OK) return sqlite_error(path, handle, status);
  if (const char* file = sqlite3_db_filename(handle, "main")) connection.lasting_path_ = file;
  sqlite3_extended_result_codes(handle, 1);
  connection.waiting_ = std::make_unique<Waiting>();
  sqlite3_busy_handler(handle, &wait_for_others, connection.waiting_.get());
  // An untrusted file must not run code through views, triggers or a manipulated schema.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  return connection;
}

int Connection::wait_for_others(void* waiting, int attempts) {
  constexpr int kShortest_ms = 1, kLongest_ms = 20;
  auto& own = *static_cast<Waiting*>(waiting);
  if (attempts == 0) own.waited_ms = 0;
  const bool is_over = own.waited_ms >= own.timeout_ms || (own.stop != nullptr && *own.stop);
  if (is_over) return 0;
  const int pause_ms = std::clamp(attempts, kShortest_ms, kLongest_ms);
  sqlite3_sleep(pause_ms);
  own.waited_ms += pause_ms;
  return 1;
}

void Connection::set_busy_timeout(int milliseconds) { waiting_->timeout_ms = milliseconds; }

void Connection::set_stop(const std::atomic<bool>* stop) { waiting_->stop = stop; }

Result<Connection> Connection::copy_in_memory() {
  auto copy = MNEME_TRY(open(*path_, ":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY));
  sqlite3_backup* backup = sqlite3_backup_init(copy.handle_.get(), "main", handle_.get(), "main");
  const int copied = backup == nullptr ? SQLITE_ERROR : sqlite3_backup_step(backup, -1);
  sqlite3_backup_finish(backup);
  if (copied != SQLITE_DONE) return sqlite_error(*path_, nullptr, copied);
  copy.lasting_path_ = lasting_path_;
  return copy;
}

Result<void> Connection::execute(const char* sql) {
  const int status = sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr);
  if (status != SQLITE_OK) return sqlite_error(*path_, handle_.get(), status);
  return {};
}

Result<Statement> Connection::prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int status = sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()),
                                        &statement, nullptr);
  if (status != SQLITE_OK) return sqlite_error(*path_, handle_.get(), status);
  return Statement(path_.get(), statement);
}

Result<KeptStatement> Connection::kept(std::string_view sql) {
  auto place = kept_.find(sql);
  if (place == kept_.end()) {
    auto statement = MNEME_TRY(prepare(sql));
    place = kept_.emplace(sql, std::move(statement)).first;
  }
  return KeptStatement(&place->second);
}

Result<std::int64_t> Connection::integer(std::string_view sql) {
  const auto statement = MNEME_TRY(kept(sql));
  const auto has_row = MNEME_TRY(statement->step());
  if (!has_row) return fail(ErrorCode::corrupt, "{}: no answer to {}", *path_, sql);
  return statement->integer(0);
}

Result<void> Connection::enter_wal_mode() {
  // SQLite does not wait here when two processes create one file at the same time.
  constexpr int kPauseMs = 10;
  for (int waited_ms = 0;; waited_ms += kPauseMs) {
    auto changed = execute("PRAGMA journal_mode = WAL");
    if (changed) return changed;
    const bool is_busy = (sqlite3_errcode(handle_.get()) & 0xff) == SQLITE_BUSY;
    if (!is_busy || waited_ms >= kBusyTimeoutMs) return changed;
    sqlite3_sleep(kPauseMs);
  }
}

Result<void> Connection::check_in_place() {
  int has_moved = 0;  // stays so for a database in memory
  sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &has_moved);
  if (has_moved == 0) return {};
  return fail(ErrorCode::io,
              "{}: was removed, renamed or replaced since it was opened, so no rows can be stored; "
              "put the file back, or restart to open the file that is there now",
              *path_);
}

bool Connection::is_read_only() const { return sqlite3_db_readonly(handle_.get(), "main") == 1; }

namespace {

/// Runs a statement without rows.
Result<void> run_kept(Connection& connection, std::string_view sql) {
  return connection.kept(sql).and_then(
      [](const KeptStatement& statement) { return statement->step().map([](bool) {}); });
}

}  // namespace

Result<Transaction> Transaction::begin(Connection& connection, Kind kind) {
  // A writer waits for the disk anyway, so a kept statement would gain nothing.
  MNEME_TRY(kind == Kind::write ? connection.execute("BEGIN IMMEDIATE")
                                : run_kept(connection, "BEGIN"));
  return Transaction(connection);
}

Transaction::Transaction(Transaction&& other) noexcept
    : connection_(std::exchange(other.connection_, nullptr)) {}

Transaction::~Transaction() {
  if (connection_ != nullptr) (void)run_kept(*connection_, "ROLLBACK");
}

Result<void> Transaction::commit() {
  // Before, because the log at the path may be another file's; after, because only then do rows of
  // this commit last.
  MNEME_TRY(connection_->check_in_place());
  MNEME_TRY(connection_->execute("COMMIT"));
  return std::exchange(connection_, nullptr)->check_in_place();
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// SQLite's C interface with owners and Results.

struct sqlite3;
struct sqlite3_stmt;
#pragma once

#include "mneme/base.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// A prepared statement. Errors surface at step(): a failed bind makes step() fail.
class Statement {
 public:
  /// Binds the parameter after the last added one, starting with the first. Values must live until
  /// reset() or destruction.
  Statement& add(std::int64_t value);
  Statement& add(std::string_view text);
  Statement& add(std::span<const std::byte> blob);
  Statement& add(std::optional<std::int64_t> value);

  /// Returns true if there is a row to read, false at the end.
  [[nodiscard]] Result<bool> step();
  /// Visits all rows.
  [[nodiscard]] Result<void> for_each(const std::function<Result<void>()>& visit);
  /// Runs a statement that returns no rows, then resets it.
  [[nodiscard]] Result<void> run();
  /// Makes the statement ready for new parameters.
  void reset();

  /// Columns count from 0. Views are valid until the next step() or reset().
  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] std::string_view text(int column) const;
  [[nodiscard]] std::span<const std::byte> blob(int column) const;

 private:
  friend class Connection;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement(const std::string* path, sqlite3_stmt* statement)
      : path_(path), statement_(statement) {}
  const std::string* path_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int bind_status_ = 0;
  int last_added_ = 0;
};

/// Resets a statement instead of destroying it.
struct ResetStatement {
  void operator()(Statement* statement) const { statement->reset(); }
};
using KeptStatement = std::unique_ptr<Statement, ResetStatement>;

/// One open file. Not thread-safe. Errors name the file. Code `corrupt`: a sound database of mneme
/// could not cause the error. Code `io`: the operating system refused.
class Connection {
 public:
  enum class Access { read_write, create, immutable };
  /// Opens without reading anything yet. `immutable`: for a file without writers, uses neither
  /// locks nor other files. Later statements wait up to kBusyTimeoutMs for other processes.
  [[nodiscard]] static Result<Connection> open(const std::string& path, Access access);

  static constexpr int kBusyTimeoutMs = 10000;
  void set_busy_timeout(int milliseconds);
  /// Statements that wait for other processes fail within 20 ms after `*stop` is true. It must
  /// outlive the connection.
  void set_stop(const std::atomic<bool>* stop);

  /// The path as given, for messages.
  [[nodiscard]] const std::string& path() const { return *path_; }
  /// Absolute path of the file; for a copy in memory, the path of the copied file.
  [[nodiscard]] const std::string& lasting_path() const { return lasting_path_; }
  [[nodiscard]] Result<void> execute(const char* sql);
  [[nodiscard]] Result<Statement> prepare(std::string_view sql);
  /// Prepares each `sql` once and keeps it, since compiling a statement takes as long as reading
  /// several rows. Use one statement at a time per `sql`. The connection must outlive the
  /// statement.
  [[nodiscard]] Result<KeptStatement> kept(std::string_view sql);
  /// First column of the first row.
  [[nodiscard]] Result<std::int64_t> integer(std::string_view sql);
  /// Switches the file to a write-ahead log, if the file system supports one.
  [[nodiscard]] Result<void> enter_wal_mode();
  /// Error: io if the path no longer leads to the open file, which others will not find then.
  [[nodiscard]] Result<void> check_in_place();
  /// True if this process has read access only.
  [[nodiscard]] bool is_read_only() const;
  /// Copies the database into memory; the copy lives as long as its connection.
  [[nodiscard]] Result<Connection> copy_in_memory();
  /// True if opened as `immutable`.
  [[nodiscard]] bool is_immutable() const { return is_immutable_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  [[nodiscard]] static Result<Connection> open(const std::string& path, const std::string& name,
                                               int flags);
  /// How statements wait for other processes.
  struct Waiting {
    int timeout_ms = kBusyTimeoutMs;
    const std::atomic<bool>* stop = nullptr;
    int waited_ms = 0;
  };
  static int wait_for_others(void* waiting, int attempts);
  // Both on the heap, because statements and SQLite point to them and the connection may move.
  std::unique_ptr<const std::string> path_;
  std::unique_ptr<Waiting> waiting_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::map<std::string, Statement, std::less<>> kept_;
  std::string lasting_path_;
  bool is_immutable_ = false;
};

/// A transaction; rolls back unless committed.
class Transaction {
 public:
  enum class Kind { read, write };
  [[nodiscard]] static Result<Transaction> begin(Connection& connection, Kind kind);
  Transaction(Transaction&& other) noexcept;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  /// Errors: also those of Connection::check_in_place().
  [[nodiscard]] Result<void> commit();

 private:
  explicit Transaction(Connection& connection) : connection_(&connection) {}
  Connection* connection_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// SQLite's C interface with owners and Results.

struct sqlite3;
struct sqlite3_stmt;
#pragma once

#include "mneme/base.h"

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
  /// Parameters count from 1. What is bound must stay alive until reset() or destruction.
  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, std::string_view text);
  Statement& bind(int parameter, std::span<const std::byte> blob);
  Statement& bind(int parameter, std::optional<std::int64_t> value);
  /// Binds the parameter after the one that was added last, or the first.
  template <class Value>
  Statement& add(Value value) {
    return bind(++last_added_, value);
  }

  /// True if there is a row to read, false at the end.
  [[nodiscard]] Result<bool> step();
  /// Visits all rows.
  [[nodiscard]] Result<void> for_each(const std::function<Result<void>()>& visit);
  /// Runs a statement without rows, and makes it ready for other parameters.
  [[nodiscard]] Result<void> run();
  /// Makes the statement ready for other parameters.
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

/// Ends as a statement that is ready for other parameters.
struct ResetStatement {
  void operator()(Statement* statement) const { statement->reset(); }
};
using KeptStatement = std::unique_ptr<Statement, ResetStatement>;

/// One open file. Not thread-safe. Errors name the file; `corrupt` stands for whatever a sound
/// database of ours cannot answer, `io` for what the machine refuses.
class Connection {
 public:
  enum class Access { read_write, create, immutable };
  /// Opening reads nothing yet: the first statement does. `immutable` reads a file that nobody
  /// writes, without locks or files beside it. Waits `kBusyTimeoutMs` for other processes.
  [[nodiscard]] static Result<Connection> open(const std::string& path, Access access);

  static constexpr int kBusyTimeoutMs = 10000;

  /// As it was asked for: for messages.
  [[nodiscard]] const std::string& path() const { return *path_; }
  /// The file's name, which stays right when the process changes its directory; of a copy in
  /// memory, that of the file.
  [[nodiscard]] const std::string& lasting_path() const { return lasting_path_; }
  [[nodiscard]] Result<void> execute(const char* sql);
  [[nodiscard]] Result<Statement> prepare(std::string_view sql);
  /// Prepares it once: to compile a statement takes as long as to read some rows. One at a time of
  /// each `sql`, and none that outlives the connection.
  [[nodiscard]] Result<KeptStatement> kept(std::string_view sql);
  /// The first column of the first row.
  [[nodiscard]] Result<std::int64_t> integer(std::string_view sql);
  /// Switches the file to a write-ahead log, where its file system has the means for one.
  [[nodiscard]] Result<void> enter_wal_mode();
  /// True if the operating system lets this process only read the file.
  [[nodiscard]] bool is_read_only() const;
  /// What the file holds, as a database of its own, which ends with the connection.
  [[nodiscard]] Result<Connection> copy_in_memory();
  /// True if it was opened as `immutable`.
  [[nodiscard]] bool is_immutable() const { return is_immutable_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  [[nodiscard]] static Result<Connection> open(const std::string& path, const std::string& name,
                                               int flags);
  // On the heap because statements keep pointing to it when the connection moves.
  std::unique_ptr<const std::string> path_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::map<std::string, Statement, std::less<>> kept_;
  std::string lasting_path_;
  bool is_immutable_ = false;
};

/// A transaction that rolls back unless it was committed.
class Transaction {
 public:
  enum class Kind { read, write };
  [[nodiscard]] static Result<Transaction> begin(Connection& connection, Kind kind);
  Transaction(Transaction&& other) noexcept;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  [[nodiscard]] Result<void> commit();

 private:
  explicit Transaction(Connection& connection) : connection_(&connection) {}
  Connection* connection_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// libpq with owners and Results. Values never become part of a statement: they are parameters, or
/// the data of a COPY.

struct pg_conn;
struct pg_result;
#pragma once

#include "mneme/base.h"

#include "store/store.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Result of a statement, in libpq's binary format.
class PostgresAnswer {
 public:
  explicit PostgresAnswer(pg_result* result) : result_(result) {}

  [[nodiscard]] int row_count() const;
  /// Command that the server executed; "ROLLBACK" for a COMMIT after an error.
  [[nodiscard]] std::string_view command() const;
  // Rows and columns count from 0. Views are valid as long as the answer lives.
  [[nodiscard]] bool is_null(int row, int column) const;
  /// Value of a boolean or integer column of any width.
  [[nodiscard]] std::int64_t integer(int row, int column) const;
  [[nodiscard]] std::string_view text(int row, int column) const;
  [[nodiscard]] std::span<const std::byte> blob(int row, int column) const;

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };
  std::unique_ptr<pg_result, Clear> result_;
};

/// One row of an answer. The answer must outlive the row.
class PostgresRow {
 public:
  explicit PostgresRow(const PostgresAnswer& answer, int row = 0) : answer_(answer), row_(row) {}
  [[nodiscard]] bool is_null(int column) const { return answer_.is_null(row_, column); }
  [[nodiscard]] std::int64_t integer(int column) const { return answer_.integer(row_, column); }
  [[nodiscard]] std::string_view text(int column) const { return answer_.text(row_, column); }
  [[nodiscard]] std::span<const std::byte> blob(int column) const {
    return answer_.blob(row_, column);
  }

 private:
  const PostgresAnswer& answer_;
  int row_;
};

/// Numbers as the text of an array parameter.
[[nodiscard]] std::string array_of(std::span<const std::int64_t> numbers);

/// One connection to a server. No call waits for ever: a server that does not answer in time, even
/// one that sends single bytes, ends the call with an error, and the next revive() connects anew.
/// Not thread-safe. Errors name the URL without its password. Code `corrupt`: damage that the
/// server reports, or tables that differ from mneme's. Code `io`: all other errors.
class PostgresConnection {
 public:
  /// `url` is passed to libpq unchanged, with its TLS options, roles and search path. Default
  /// connect_timeout: 10 s.
  [[nodiscard]] static Result<PostgresConnection> open(const std::string& url,
                                                       const ServerPatience& patience = {});
  /// Replaces ServerPatience::answer_s; returns the old value.
  double set_answer_timeout(double seconds) { return std::exchange(patience_.answer_s, seconds); }

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Connects again if the connection was lost.
  [[nodiscard]] Result<void> revive();
  /// Number of reconnections so far.
  [[nodiscard]] int revivals() const { return revivals_; }

  /// Parameters are text; $1 is the first.
  [[nodiscard]] Result<PostgresAnswer> query(const std::string& sql,
                                             const std::vector<std::string>& parameters = {});
  /// The same for a statement whose answer does not matter.
  [[nodiscard]] Result<void> run(const std::string& sql,
                                 const std::vector<std::string>& parameters = {});
  /// Runs statements without parameters, up to the first that fails.
  [[nodiscard]] Result<void> run_all(const std::vector<std::string>& statements);
  /// Passes each row to `visit` as row 0 of an answer, without holding all rows in memory.
  [[nodiscard]] Result<void> stream(
      const std::string& sql, const std::vector<std::string>& parameters,
      const std::function<Result<void>(const PostgresAnswer&)>& visit);
  /// Runs `COPY ... FROM STDIN` with `data`.
  [[nodiscard]] Result<void> copy_in(const std::string& sql, std::string_view data);
  /// The SQLSTATE of the last error.
  [[nodiscard]] const std::string& last_state() const { return last_state_; }

 private:
  struct Finish {
    void operator()(pg_conn* connection) const;
  };
  enum class Connecting { first, again };
  [[nodiscard]] tl::unexpected<Error> error_of(const pg_result* result);
  [[nodiscard]] tl::unexpected<Error> lost(const std::string& why);
  Result<void> finish_connecting(Connecting how);
  /// Waits until the socket is readable or, if `events` says so, writable. Bytes that trickle in do
  /// not prolong `timeout_s`, which counts from `since`.
  Result<void> wait(int events, double timeout_s, const Stopwatch& since);
  Result<void> send(const std::string& sql, const std::vector<std::string>& parameters);
  /// The next result of what was sent, null after the last one. Its owner is the caller. `since`:
  /// the begin of the wait for it.
  Result<pg_result*> next_result(const Stopwatch& since);
  Result<void> put_copy(std::string_view data);
  Result<void> finish_command(const Stopwatch& since);

  std::string name_;
  ServerPatience patience_;
  std::string last_state_;
  int revivals_ = 0;
  bool is_lost_ = false;  ///< an answer did not come in time
  std::unique_ptr<pg_conn, Finish> connection_;
};

/// Rows in the binary format of COPY.
class BinaryCopy {
 public:
  BinaryCopy();
  /// Begins a row of `column_count` values, which must follow.
  BinaryCopy& row(int column_count);
  BinaryCopy& add(std::int64_t value);
  BinaryCopy& add(std::optional<std::int64_t> value);
  BinaryCopy& add(std::string_view text);
  BinaryCopy& add(std::span<const std::byte> bytes);
  /// All rows with the end mark. Nothing can be added afterwards.
  [[nodiscard]] const std::string& finish();

 private:
  void append_big_endian(std::uint64_t value, int bytes);
  std::string data_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/postgres_connection.h"

#include "base/fail.h"
#include "engines/open_store.h"

#include <fmt/format.h>
#include <libpq-fe.h>

#include <poll.h>
#include <algorithm>
#include <array>
#include <cerrno>

namespace mneme::internal {
namespace {

ErrorCode code_of(std::string_view state) {
  // Damaged pages and indices; tables, columns or types that are not those we created.
  for (const std::string_view damage : {"XX001", "XX002", "42P01", "42703", "42804", "42883"}) {
    if (state == damage) return ErrorCode::corrupt;
  }
  return ErrorCode::io;
}

/// libpq's messages end in line breaks, and some have several lines.
std::string one_line(std::string_view message) {
  while (message.ends_with('\n')) message.remove_suffix(1);
  std::string line(message);
  std::erase(line, '\t');
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

void ignore_notice(void*, const char*) {}

std::vector<const char*> pointers_of(const std::vector<std::string>& parameters) {
  std::vector<const char*> pointers;
  for (const std::string& parameter : parameters) pointers.push_back(parameter.c_str());
  return pointers;
}

constexpr int kBinary = 1;

/// The connect_timeout of the URL, or 10 s.
double connect_timeout_s(PGconn* connection) {
  constexpr double kDefault_s = 10;
  double seconds = 0;
  if (PQconninfoOption* const options = PQconninfo(connection)) {
    for (const PQconninfoOption* option = options; option->keyword != nullptr; ++option) {
      const bool is_timeout = std::string_view(option->keyword) == "connect_timeout";
      if (is_timeout && option->val != nullptr) seconds = std::atof(option->val);
    }
    PQconninfoFree(options);
  }
  return seconds > 0 ? seconds : kDefault_s;
}

}  // namespace

void PostgresAnswer::Clear::operator()(pg_result* result) const { PQclear(result); }

int PostgresAnswer::row_count() const { return PQntuples(result_.get()); }

std::string_view PostgresAnswer::command() const { return PQcmdStatus(result_.get()); }

bool PostgresAnswer::is_null(int row, int column) const {
  return PQgetisnull(result_.get(), row, column) == 1;
}

std::int64_t PostgresAnswer::integer(int row, int column) const {
  const auto bytes = blob(row, column);
  // Big-endian; the first byte carries the sign.
  std::uint64_t value = !bytes.empty() && (bytes[0] & std::byte{0x80}) != std::byte{0} ? ~0ULL : 0;
  for (const std::byte byte : bytes) value = (value << 8) | std::to_integer<std::uint64_t>(byte);
  return static_cast<std::int64_t>(value);
}

std::string_view PostgresAnswer::text(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<std::size_t>(PQgetlength(result_.get(), row, column))};
}

std::span<const std::byte> PostgresAnswer::blob(int row, int column) const {
  return std::as_bytes(std::span(text(row, column)));
}

std::string array_of(std::span<const std::int64_t> numbers) {
  std::string text = "{";
  for (const std::int64_t number : numbers) {
    if (text.size() > 1) text += ',';
    text += std::to_string(number);
  }
  return text + "}";
}

void PostgresConnection::Finish::operator()(pg_conn* connection) const { PQfinish(connection); }

Result<PostgresConnection> PostgresConnection::open(const std::string& url,
                                                    const ServerPatience& patience) {
  PostgresConnection opened;
  opened.name_ = without_password(url);
  opened.patience_ = patience;
  // Options in the URL override these defaults.
  const std::array<const char*, 6> keywords = {"client_encoding",  "fallback_application_name",
                                               "tcp_user_timeout", "keepalives_idle",
                                               "dbname",           nullptr};
  const std::array<const char*, 6> values = {"UTF8", "mneme", "10000", "10", url.c_str(), nullptr};
  opened.connection_.reset(PQconnectStartParams(keywords.data(), values.data(), 1));
  PQsetNoticeProcessor(opened.connection_.get(), ignore_notice, nullptr);
  MNEME_TRY(opened.finish_connecting(Connecting::first));
  return opened;
}

Result<void> PostgresConnection::finish_connecting(Connecting how) {
  const bool is_first = how == Connecting::first;
  // A lost connection is not worth waiting for longer than an answer.
  const double timeout_s = is_first
                               ? connect_timeout_s(connection_.get())
                               : std::min(connect_timeout_s(connection_.get()), patience_.answer_s);
  const auto poll = is_first ? PQconnectPoll : PQresetPoll;
  if (PQstatus(connection_.get()) == CONNECTION_BAD) return error_of(nullptr);
  const Stopwatch since;
  for (auto state = PGRES_POLLING_WRITING; state != PGRES_POLLING_OK;
       state = poll(connection_.get())) {
    if (state == PGRES_POLLING_FAILED) return error_of(nullptr);
    MNEME_TRY(wait(state == PGRES_POLLING_READING ? POLLIN : POLLOUT, timeout_s, since));
  }
  is_lost_ = false;
  return PQsetnonblocking(connection_.get(), 1) == 0 ? Result<void>() : error_of(nullptr);
}

Result<void> PostgresConnection::revive() {
  if (PQstatus(connection_.get()) == CONNECTION_OK && !is_lost_) return {};
  ++revivals_;
  if (PQresetStart(connection_.get()) == 0) return error_of(nullptr);
  return finish_connecting(Connecting::again);
}

tl::unexpected<Error> PostgresConnection::lost(const std::string& why) {
  is_lost_ = true;
  last_state_.clear();
  return fail(ErrorCode::io, "{}: {}", name_, why);
}

Result<void> PostgresConnection::wait(int events, double timeout_s, const Stopwatch& since) {
  constexpr int kSliceMs = 20;
  for (;;) {
    if (patience_.stop != nullptr && patience_.stop->load()) {
      return lost("waiting for the server was ended");
    }
    pollfd socket = {PQsocket(connection_.get()), static_cast<short>(events | POLLIN), 0};
    if (events == POLLOUT) socket.events = POLLOUT;
    const int ready = ::poll(&socket, 1, kSliceMs);
    if (ready < 0 && errno != EINTR) return lost("its socket cannot be read");
    if (since.elapsed_s() >= timeout_s) {
      return lost(fmt::format("the server did not answer within {:.1f} s", timeout_s));
    }
    if (ready > 0) return {};
  }
}

Result<void> PostgresConnection::send(const std::string& sql,
                                      const std::vector<std::string>& parameters) {
  if (is_lost_) return lost("the connection was lost");
  const auto pointers = pointers_of(parameters);
  const int sent =
      PQsendQueryParams(connection_.get(), sql.c_str(), static_cast<int>(pointers.size()), nullptr,
                        pointers.data(), nullptr, nullptr, kBinary);
  return sent == 1 ? Result<void>() : error_of(nullptr);
}

Result<pg_result*> PostgresConnection::next_result(const Stopwatch& since) {
  for (;;) {
    const int unsent = PQflush(connection_.get());
    if (unsent < 0) return error_of(nullptr);
    if (unsent == 0 && PQisBusy(connection_.get()) == 0) return PQgetResult(connection_.get());
    MNEME_TRY(wait(unsent > 0 ? POLLIN | POLLOUT : POLLIN, patience_.answer_s, since));
    if (PQconsumeInput(connection_.get()) == 0) return error_of(nullptr);
  }
}

tl::unexpected<Error> PostgresConnection::error_of(const pg_result* result) {
  const char* state = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
  last_state_ = state == nullptr ? "" : state;
  const char* message =
      result == nullptr ? PQerrorMessage(connection_.get()) : PQresultErrorMessage(result);
  return fail(code_of(last_state_), "{}: {}", name_, one_line(message));
}

Result<PostgresAnswer> PostgresConnection::query(const std::string& sql,
                                                 const std::vector<std::string>& parameters) {
  const Stopwatch since;
  MNEME_TRY(send(sql, parameters));
  pg_result* const result = MNEME_TRY(next_result(since));
  PostgresAnswer answer(result);
  const ExecStatusType status = PQresultStatus(result);
  Result<void> outcome;
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) outcome = error_of(result);
  const auto finished = finish_command(since);
  if (!outcome) return tl::unexpected(outcome.error());
  if (!finished) return tl::unexpected(finished.error());
  return answer;
}

Result<void> PostgresConnection::run(const std::string& sql,
                                     const std::vector<std::string>& parameters) {
  return query(sql, parameters).map([](const PostgresAnswer&) {});
}

Result<void> PostgresConnection::run_all(const std::vector<std::string>& statements) {
  for (const std::string& sql : statements) MNEME_TRY(run(sql));
  return {};
}

Result<void> PostgresConnection::stream(
    const std::string& sql, const std::vector<std::string>& parameters,
    const std::function<Result<void>(const PostgresAnswer&)>& visit) {
  MNEME_TRY(send(sql, parameters));
  if (PQsetSingleRowMode(connection_.get()) == 0) return error_of(nullptr);
  Result<void> outcome;
  // All results must be read, also after an error.
  for (;;) {
    pg_result* const result = MNEME_TRY(next_result(Stopwatch()));
    if (result == nullptr) return outcome;
    const PostgresAnswer answer(result);
    if (!outcome) continue;
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_SINGLE_TUPLE) {
      outcome = visit(answer);
    } else if (status != PGRES_TUPLES_OK) {
      outcome = error_of(result);
    }
  }
}

Result<void> PostgresConnection::put_copy(std::string_view data) {
  const Stopwatch since;
  for (;;) {
    // A COPY ends with an empty piece.
    const int sent =
        data.empty() ? PQputCopyEnd(connection_.get(), nullptr)
                     : PQputCopyData(connection_.get(), data.data(), static_cast<int>(data.size()));
    if (sent == 1) return {};
    if (sent < 0) return error_of(nullptr);
    MNEME_TRY(wait(POLLIN | POLLOUT, patience_.answer_s, since));
    if (PQconsumeInput(connection_.get()) == 0 || PQflush(connection_.get()) < 0) {
      return error_of(nullptr);
    }
  }
}

Result<void> PostgresConnection::copy_in(const std::string& sql, std::string_view data) {
  if (is_lost_) return lost("the connection was lost");
  const Stopwatch since;
  if (PQsendQuery(connection_.get(), sql.c_str()) == 0) return error_of(nullptr);
  pg_result* const begun = MNEME_TRY(next_result(since));
  const PostgresAnswer owner(begun);
  if (PQresultStatus(begun) != PGRES_COPY_IN) {
    const auto refused = error_of(begun);
    (void)finish_command(since);
    return refused;
  }
  constexpr std::size_t kPieceSize = 1 << 16;
  for (; !data.empty(); data.remove_prefix(std::min(kPieceSize, data.size()))) {
    MNEME_TRY(put_copy(data.substr(0, kPieceSize)));
  }
  MNEME_TRY(put_copy({}));
  return finish_command(Stopwatch());
}

Result<void> PostgresConnection::finish_command(const Stopwatch& since) {
  Result<void> outcome;
  for (;;) {
    pg_result* const result = MNEME_TRY(next_result(since));
    if (result == nullptr) return outcome;
    const PostgresAnswer owner(result);
    if (outcome && PQresultStatus(result) != PGRES_COMMAND_OK) outcome = error_of(result);
  }
}

BinaryCopy::BinaryCopy() : data_("PGCOPY\n\377\r\n\0", 11) {
  append_big_endian(0, 4);  // flags
  append_big_endian(0, 4);  // bytes of the header's extension
}

BinaryCopy& BinaryCopy::row(int column_count) {
  append_big_endian(static_cast<std::uint64_t>(column_count), 2);
  return *this;
}

BinaryCopy& BinaryCopy::add(std::int64_t value) {
  append_big_endian(8, 4);
  append_big_endian(static_cast<std::uint64_t>(value), 8);
  return *this;
}

BinaryCopy& BinaryCopy::add(std::optional<std::int64_t> value) {
  if (value) return add(*value);
  append_big_endian(0xffffffff, 4);  // null
  return *this;
}

BinaryCopy& BinaryCopy::add(std::string_view text) {
  append_big_endian(text.size(), 4);
  data_ += text;
  return *this;
}

BinaryCopy& BinaryCopy::add(std::span<const std::byte> bytes) {
  return add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

const std::string& BinaryCopy::finish() {
  append_big_endian(0xffff, 2);
  return data_;
}

void BinaryCopy::append_big_endian(std::uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    data_ += static_cast<char>((value >> shift) & 0xff);
  }
}

}  // namespace mneme::internal

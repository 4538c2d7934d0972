// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/postgres_connection.h"

#include "engines/open_store.h"

#include <fmt/format.h>
#include <libpq-fe.h>

#include <algorithm>
#include <array>

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

Result<PostgresConnection> PostgresConnection::open(const std::string& url) {
  PostgresConnection opened;
  opened.name_ = without_password(url);
  // Options in the URL override these defaults.
  const std::array<const char*, 5> keywords = {"connect_timeout", "client_encoding",
                                               "fallback_application_name", "dbname", nullptr};
  const std::array<const char*, 5> values = {"10", "UTF8", "mneme", url.c_str(), nullptr};
  opened.connection_.reset(PQconnectdbParams(keywords.data(), values.data(), 1));
  PQsetNoticeProcessor(opened.connection_.get(), ignore_notice, nullptr);
  if (PQstatus(opened.connection_.get()) != CONNECTION_OK) return opened.error_of(nullptr);
  return opened;
}

Result<void> PostgresConnection::revive() {
  if (PQstatus(connection_.get()) == CONNECTION_OK) return {};
  PQreset(connection_.get());
  ++revivals_;
  if (PQstatus(connection_.get()) == CONNECTION_OK) return {};
  return error_of(nullptr);
}

tl::unexpected<Error> PostgresConnection::error_of(const pg_result* result) {
  const char* state = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
  last_state_ = state == nullptr ? "" : state;
  const char* message =
      result == nullptr ? PQerrorMessage(connection_.get()) : PQresultErrorMessage(result);
  return fail(code_of(last_state_), fmt::format("{}: {}", name_, one_line(message)));
}

Result<PostgresAnswer> PostgresConnection::query(const std::string& sql,
                                                 const std::vector<std::string>& parameters) {
  const auto pointers = pointers_of(parameters);
  pg_result* result =
      PQexecParams(connection_.get(), sql.c_str(), static_cast<int>(pointers.size()), nullptr,
                   pointers.data(), nullptr, nullptr, kBinary);
  PostgresAnswer answer(result);
  const ExecStatusType status = PQresultStatus(result);
  if (status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK) return answer;
  return error_of(result);
}

Result<void> PostgresConnection::stream(
    const std::string& sql, const std::vector<std::string>& parameters,
    const std::function<Result<void>(const PostgresAnswer&)>& visit) {
  const auto pointers = pointers_of(parameters);
  if (PQsendQueryParams(connection_.get(), sql.c_str(), static_cast<int>(pointers.size()), nullptr,
                        pointers.data(), nullptr, nullptr, kBinary) == 0 ||
      PQsetSingleRowMode(connection_.get()) == 0) {
    return error_of(nullptr);
  }
  Result<void> outcome;
  // All results must be read, also after an error.
  while (pg_result* result = PQgetResult(connection_.get())) {
    const PostgresAnswer answer(result);
    if (!outcome) continue;
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_SINGLE_TUPLE) {
      outcome = visit(answer);
    } else if (status != PGRES_TUPLES_OK) {
      outcome = error_of(result);
    }
  }
  return outcome;
}

Result<void> PostgresConnection::copy_in(const std::string& sql, std::string_view data) {
  {
    pg_result* begun = PQexec(connection_.get(), sql.c_str());
    const PostgresAnswer owner(begun);
    if (PQresultStatus(begun) != PGRES_COPY_IN) return error_of(begun);
  }
  constexpr std::size_t kPieceSize = 1 << 20;
  for (; !data.empty(); data.remove_prefix(std::min(kPieceSize, data.size()))) {
    const auto piece = data.substr(0, kPieceSize);
    const int sent = PQputCopyData(connection_.get(), piece.data(), static_cast<int>(piece.size()));
    if (sent != 1) return error_of(nullptr);
  }
  if (PQputCopyEnd(connection_.get(), nullptr) != 1) return error_of(nullptr);
  return finish_command();
}

Result<void> PostgresConnection::finish_command() {
  Result<void> outcome;
  while (pg_result* result = PQgetResult(connection_.get())) {
    const PostgresAnswer owner(result);
    if (outcome && PQresultStatus(result) != PGRES_COMMAND_OK) outcome = error_of(result);
  }
  return outcome;
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

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "benchmark/csv.h"
#include "store/sqlite_connection.h"

#include <fmt/format.h>

#include <concepts>

namespace mneme {
namespace {

using internal::Connection;
using internal::Statement;
using internal::Transaction;

template <class T>
constexpr std::string_view sql_type() {
  if (std::is_floating_point_v<T>) return "REAL";
  return std::is_integral_v<T> ? "INTEGER" : "TEXT";
}

struct Sql {
  std::string create =
      "CREATE TABLE runs (problem TEXT, \"set\" TEXT, planner TEXT, sampler TEXT, seed INTEGER, "
      "status TEXT, is_valid INTEGER";
  std::string insert = "INSERT INTO runs VALUES (?,?,?,?,?,?,?";

  Sql() {
    const BenchmarkRow row;
    internal::visit_columns(row, [&]<class T>(const char* name, const T&) {
      create += fmt::format(", {} {}", name, sql_type<T>());
      insert += ",?";
    });
    create += ")";
    insert += ")";
  }
};

void bind(Statement& statement, int parameter, const std::string& text) {
  statement.bind(parameter, std::string_view(text));
}
void bind(Statement& statement, int parameter, const std::vector<Improved>& improvements) {
  const std::string text = internal::to_text(improvements);
  bind(statement, parameter, text);
}
void bind(Statement& statement, int parameter, double number) {
  statement.bind_real(parameter, number);
}
void bind(Statement& statement, int parameter, std::integral auto number) {
  statement.bind(parameter, static_cast<std::int64_t>(number));
}

Result<void> insert(Statement& statement, const BenchmarkRow& row) {
  statement.reset();
  int parameter = 0;
  for (const std::string* text : {&row.problem, &row.set, &row.planner, &row.sampler}) {
    bind(statement, ++parameter, *text);
  }
  bind(statement, ++parameter, row.seed);
  statement.bind(++parameter, to_string(row.status));
  bind(statement, ++parameter, row.is_path_valid);
  internal::visit_columns(
      row, [&](const char*, const auto& value) { bind(statement, ++parameter, value); });
  const Result<bool> done = statement.step();
  if (!done) return tl::unexpected(done.error());
  return {};
}

/// Error: invalid, if `connection`'s file has tables of others: dropping ours could take theirs.
Result<void> refuse_strangers(Connection& connection) {
  const auto strange = connection.integer(
      "SELECT (SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name <> 'runs' AND name "
      "NOT LIKE 'sqlite!_%' ESCAPE '!') + (SELECT count(*) > 0 AND sum(name IN ('problem', 'set', "
      "'planner', 'sampler', 'is_valid')) < 5 FROM pragma_table_info('runs'))");
  if (!strange) return tl::unexpected(strange.error());
  const auto application = connection.integer("PRAGMA application_id");
  if (!application) return tl::unexpected(application.error());
  if (*strange == 0 && *application == 0) return {};
  return fail(ErrorCode::invalid,
              fmt::format("{}: an SQLite file with other tables; expected one with nothing but the "
                          "table runs of a benchmark, or none",
                          connection.path()));
}

}  // namespace

struct RunDatabase::State {
  Connection connection;
  Statement insertion;
};

RunDatabase::RunDatabase(std::unique_ptr<State> state) : state_(std::move(state)) {}
RunDatabase::RunDatabase(RunDatabase&&) noexcept = default;
RunDatabase& RunDatabase::operator=(RunDatabase&&) noexcept = default;
RunDatabase::~RunDatabase() = default;

Result<RunDatabase> RunDatabase::open(const std::string& path, std::span<const BenchmarkRow> rows) {
  auto connection = Connection::open(path, Connection::Access::create);
  if (!connection) return tl::unexpected(connection.error());
  // Rows survive a killed process; a loss of power may cost the last ones, which the CSV file has.
  const auto prepared =
      refuse_strangers(*connection)
          .and_then([&] { return connection->enter_wal_mode(); })
          .and_then([&] { return connection->execute("PRAGMA synchronous = NORMAL"); });
  if (!prepared) return tl::unexpected(prepared.error());
  const Sql sql;
  auto transaction = Transaction::begin(*connection, Transaction::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  for (const std::string& text : {std::string("DROP TABLE IF EXISTS runs"), sql.create}) {
    if (auto done = connection->execute(text.c_str()); !done) return tl::unexpected(done.error());
  }
  auto insertion = connection->prepare(sql.insert);
  if (!insertion) return tl::unexpected(insertion.error());
  for (const BenchmarkRow& row : rows) {
    if (auto done = insert(*insertion, row); !done) return tl::unexpected(done.error());
  }
  insertion->reset();
  if (auto done = transaction->commit(); !done) return tl::unexpected(done.error());
  return RunDatabase(std::make_unique<State>(State{std::move(*connection), std::move(*insertion)}));
}

Result<void> RunDatabase::add(const BenchmarkRow& row) {
  auto done = insert(state_->insertion, row);
  state_->insertion.reset();
  return done;
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "benchmark/ompl_experiment.h"
#include "store/sqlite_connection.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace mneme {
namespace {

using internal::Connection;
using internal::kOmplProperties;
using internal::OmplExperiment;
using internal::OmplPlanner;
using internal::Statement;

std::string column_name(std::string_view property) {
  std::string name(property);
  std::ranges::replace(name, ' ', '_');
  return name;
}

std::string schema() {
  std::string run_columns;
  for (const auto& [name, type] : kOmplProperties) {
    run_columns += fmt::format(", {} {}", column_name(name), type);
  }
  return fmt::format(
      "CREATE TABLE experiments (id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512), "
      "totaltime "
      "REAL, timelimit REAL, memorylimit REAL, runcount INTEGER, version VARCHAR(128), hostname "
      "VARCHAR(1024), cpuinfo TEXT, date DATETIME, seed VARCHAR(24), setup TEXT);"
      "CREATE TABLE plannerConfigs (id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512) NOT "
      "NULL, settings TEXT);"
      "CREATE TABLE enums (name VARCHAR(512), value INTEGER, description TEXT, PRIMARY KEY (name, "
      "value));"
      "CREATE TABLE runs (id INTEGER PRIMARY KEY AUTOINCREMENT, experimentid INTEGER, plannerid "
      "INTEGER{}, FOREIGN KEY (experimentid) REFERENCES experiments(id) ON DELETE CASCADE, FOREIGN "
      "KEY (plannerid) REFERENCES plannerConfigs(id) ON DELETE CASCADE);"
      "CREATE TABLE progress (runid INTEGER, time REAL, PRIMARY KEY (runid, time), FOREIGN KEY "
      "(runid) REFERENCES runs(id) ON DELETE CASCADE);",
      run_columns);
}

/// The form in which ompl_benchmark_statistics stores them.
std::string settings_text(const OmplPlanner& planner) {
  std::string text;
  for (const std::string& line : planner.settings) text += line + "\n;";
  return text;
}

/// Statements that fill the tables. Throws nothing: the first error is kept.
class ArenaWriter {
 public:
  explicit ArenaWriter(Connection& connection) : connection_(connection) {}

  Result<void> write(std::span<const BenchmarkRow> rows) {
    auto written = connection_.execute(schema().c_str()).and_then([&] { return prepare(); });
    for (std::size_t i = 0; i < internal::kOmplStatuses.size() && written; ++i) {
      enums_->bind(1, std::string_view("status")).bind(2, static_cast<std::int64_t>(i));
      written = run(enums_->bind(3, internal::kOmplStatuses[i]), *enums_);
    }
    const std::vector<OmplExperiment> experiments = internal::to_experiments(rows);
    for (std::size_t i = 0; i < experiments.size() && written; ++i) {
      written = write_experiment(experiments[i]);
    }
    return written;
  }

 private:
  Result<void> prepare() {
    std::string columns = "experimentid, plannerid";
    std::string marks = "?, ?";
    for (const auto& [name, type] : kOmplProperties) {
      columns += ", " + column_name(name);
      marks += ", nullif(?, '')";
    }
    return prepare(enums_, "INSERT INTO enums VALUES (?, ?, ?)")
        .and_then([&] {
          return prepare(
              experiments_,
              "INSERT INTO experiments (name, totaltime, timelimit, memorylimit, "
              "runcount, version, hostname, cpuinfo, date, seed, setup) VALUES (?, ?, ?, "
              "0.0, ?, ?, ?, ?, ?, ?, ?)");
        })
        .and_then([&] {
          return prepare(planners_, "INSERT INTO plannerConfigs (name, settings) VALUES (?, ?)");
        })
        .and_then([&] {
          return prepare(runs_, fmt::format("INSERT INTO runs ({}) VALUES ({})", columns, marks));
        });
  }

  Result<void> prepare(std::optional<Statement>& statement, const std::string& sql) {
    auto prepared = connection_.prepare(sql);
    if (!prepared) return tl::unexpected(prepared.error());
    statement.emplace(std::move(*prepared));
    return {};
  }

  static Result<void> run(Statement& bound, Statement& statement) {
    const auto done = bound.step();
    statement.reset();
    if (!done) return tl::unexpected(done.error());
    return {};
  }

  Result<void> write_experiment(const OmplExperiment& experiment) {
    const std::string version_text = fmt::format("mneme {}", version());
    const std::string machine = experiment.machine + "\n", setup = experiment.setup + "\n";
    experiments_->bind(1, std::string_view(experiment.name))
        .bind_real(2, experiment.total_time_s)
        .bind_real(3, experiment.timeout_s)
        .bind(4, static_cast<std::int64_t>(experiment.run_count))
        .bind(5, std::string_view(version_text))
        .bind(6, std::string_view(experiment.host))
        .bind(7, std::string_view(machine))
        .bind(8, std::string_view(experiment.date))
        .bind(9, std::string_view(experiment.seed))
        .bind(10, std::string_view(setup));
    auto written = run(*experiments_, *experiments_);
    const std::int64_t id = ++experiment_count_;
    for (std::size_t i = 0; i < experiment.planners.size() && written; ++i) {
      written = write_planner(id, experiment.planners[i]);
    }
    return written;
  }

  Result<void> write_planner(std::int64_t experiment, const OmplPlanner& planner) {
    const std::pair key{planner.name, settings_text(planner)};
    auto known = std::ranges::find(known_planners_, key);
    if (known == known_planners_.end()) {
      known_planners_.push_back(key);
      known = known_planners_.end() - 1;
      planners_->bind(1, std::string_view(key.first)).bind(2, std::string_view(key.second));
      if (auto written = run(*planners_, *planners_); !written) return written;
    }
    const std::int64_t id = known - known_planners_.begin() + 1;
    for (const auto& values : planner.runs) {
      runs_->bind(1, experiment).bind(2, id);
      for (std::size_t i = 0; i < values.size(); ++i) {
        runs_->bind(static_cast<int>(i) + 3, std::string_view(values[i]));
      }
      if (auto written = run(*runs_, *runs_); !written) return written;
    }
    return {};
  }

  Connection& connection_;
  std::optional<Statement> enums_, experiments_, planners_, runs_;
  std::int64_t experiment_count_ = 0;
  std::vector<std::pair<std::string, std::string>> known_planners_;
};

}  // namespace

Result<void> write_planner_arena(const std::string& path, std::span<const BenchmarkRow> rows) {
  const std::string fresh = path + ".new";
  std::error_code error;
  std::filesystem::remove(fresh, error);
  {
    auto connection = Connection::open(fresh, Connection::Access::create);
    if (!connection) return tl::unexpected(connection.error());
    auto transaction =
        internal::Transaction::begin(*connection, internal::Transaction::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    const auto written =
        ArenaWriter(*connection).write(rows).and_then([&] { return transaction->commit(); });
    if (!written) return written;
  }
  std::filesystem::rename(fresh, path, error);
  if (error)
    return fail(ErrorCode::io, fmt::format("cannot write '{}': {}", path, error.message()));
  return {};
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/postgres_store.h"
#include "store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace mneme::internal {
namespace {

// Locking the head keeps two processes from creating the table at the same time.
constexpr std::array kCreate = {
    "BEGIN",
    "SELECT 1 FROM mneme_head FOR UPDATE",
    "CREATE TABLE IF NOT EXISTS mneme_task (job bigint NOT NULL, task bigint NOT NULL, attempt "
    "bigint NOT NULL DEFAULT 0, worker text NOT NULL DEFAULT '', leased_until timestamptz, "
    "done_generation bigint, PRIMARY KEY (job, task))",
    "CREATE INDEX IF NOT EXISTS mneme_task_open ON mneme_task (job, task) WHERE done_generation IS "
    "NULL",
    "COMMIT",
};

// No process waits: rows locked by another process are skipped.
constexpr const char* kTake =
    "WITH free AS MATERIALIZED (SELECT task FROM mneme_task WHERE job = $1::bigint AND "
    "done_generation IS NULL AND (leased_until IS NULL OR leased_until < clock_timestamp()) "
    "ORDER BY task LIMIT $2::bigint FOR UPDATE SKIP LOCKED) "
    "UPDATE mneme_task t SET attempt = t.attempt + 1, worker = $3, leased_until = "
    "clock_timestamp() + make_interval(secs => $4::float8) FROM free "
    "WHERE t.job = $1::bigint AND t.task = free.task RETURNING t.task, t.attempt";

constexpr const char* kRenew =
    "UPDATE mneme_task t SET leased_until = clock_timestamp() + make_interval(secs => $4::float8) "
    "FROM unnest($2::bigint[], $3::bigint[]) AS held (task, attempt) WHERE t.job = $1::bigint AND "
    "t.task = held.task AND t.attempt = held.attempt AND t.done_generation IS NULL "
    "RETURNING t.task, t.attempt";

constexpr const char* kRelease =
    "UPDATE mneme_task t SET leased_until = NULL "
    "FROM unnest($2::bigint[], $3::bigint[]) AS held (task, attempt) WHERE t.job = $1::bigint AND "
    "t.task = held.task AND t.attempt = held.attempt AND t.done_generation IS NULL";

// Also matches a task that this attempt already finished, after a commit whose answer was lost.
constexpr const char* kFinish =
    "UPDATE mneme_task t SET done_generation = $4::bigint, leased_until = NULL "
    "FROM unnest($2::bigint[], $3::bigint[]) AS held (task, attempt) WHERE t.job = $1::bigint AND "
    "t.task = held.task AND t.attempt = held.attempt RETURNING t.task, t.attempt";

std::vector<Lease> leases_of(const PostgresAnswer& answer) {
  std::vector<Lease> leases;
  for (int row = 0; row < answer.row_count(); ++row) {
    leases.push_back({answer.integer(row, 0), answer.integer(row, 1)});
  }
  std::ranges::sort(leases, {}, &Lease::task);
  return leases;
}

class PostgresTasks final : public TaskQueue {
 public:
  PostgresTasks(std::shared_ptr<PostgresConnection> connection, RobotSignature signature,
                TaskOwner owner)
      : connection_(std::move(connection)),
        store_(make_postgres_store(connection_, OpenMode::read_write)),
        signature_(std::move(signature)),
        job_(std::to_string(owner.job)),
        worker_(std::move(owner.worker)) {}

  Result<void> create() {
    const auto exists =
        MNEME_TRY(connection_->query("SELECT to_regclass('mneme_task') IS NOT NULL"));
    if (exists.integer(0, 0) != 0) return {};
    for (const char* sql : kCreate) {
      const auto done = connection_->query(sql);
      if (done) continue;
      (void)connection_->query("ROLLBACK");
      return tl::unexpected(done.error());
    }
    return {};
  }

  Result<void> add(std::span<const std::int64_t> tasks, std::int64_t generation) override {
    const auto added = run(
        "INSERT INTO mneme_task (job, task) SELECT $1::bigint, unnest($2::bigint[]) ON CONFLICT "
        "(job, task) DO UPDATE SET done_generation = NULL WHERE mneme_task.done_generation <= "
        "$3::bigint",
        {job_, array_of(tasks), std::to_string(generation)});
    return added.map([](const PostgresAnswer&) {});
  }

  Result<std::vector<Lease>> take(int count, double seconds) override {
    return run(kTake, {job_, std::to_string(count), worker_, fmt::to_string(seconds)})
        .map(leases_of);
  }

  Result<std::vector<Lease>> renew(std::span<const Lease> leases, double seconds) override {
    auto parameters = parameters_of(leases);
    parameters.push_back(fmt::to_string(seconds));
    return run(kRenew, parameters).map(leases_of);
  }

  Result<void> release(std::span<const Lease> leases) override {
    return run(kRelease, parameters_of(leases)).map([](const PostgresAnswer&) {});
  }

  Result<std::vector<Lease>> finish(std::span<const Lease> leases,
                                    std::vector<Experience> rows) override {
    MNEME_TRY(prepare_rows(rows, signature_));
    std::map<std::int64_t, Experience> results;
    for (std::size_t i = 0; i < leases.size(); ++i) {
      results.emplace(leases[i].task, std::move(rows[i]));
    }
    std::vector<Lease> good;
    std::vector<Experience> chosen;
    const auto choose = [&](const StoreState& head) -> Result<std::span<const Experience>> {
      auto parameters = parameters_of(leases);
      parameters.push_back(std::to_string(head.generation + 1));
      const auto marked = MNEME_TRY(connection_->query(kFinish, parameters));
      good = leases_of(marked);
      for (const Lease& lease : good) chosen.push_back(std::move(results.at(lease.task)));
      return chosen;
    };
    MNEME_TRY(append_rows_of(*store_, choose, Duplicates::keep_first));
    return good;
  }

  Result<std::int64_t> count_open() override {
    return run("SELECT count(*) FROM mneme_task WHERE job = $1::bigint AND done_generation IS "
               "NULL",
               {job_})
        .map([](const PostgresAnswer& answer) { return answer.integer(0, 0); });
  }

 private:
  Result<PostgresAnswer> run(const char* sql, const std::vector<std::string>& parameters) {
    return connection_->revive().and_then([&] { return connection_->query(sql, parameters); });
  }

  [[nodiscard]] std::vector<std::string> parameters_of(std::span<const Lease> leases) const {
    std::vector<std::int64_t> tasks;
    std::vector<std::int64_t> attempts;
    for (const Lease& lease : leases) {
      tasks.push_back(lease.task);
      attempts.push_back(lease.attempt);
    }
    return {job_, array_of(tasks), array_of(attempts)};
  }

  std::shared_ptr<PostgresConnection> connection_;
  std::unique_ptr<Store> store_;
  RobotSignature signature_;
  std::string job_;
  std::string worker_;
};

}  // namespace

Result<std::unique_ptr<TaskQueue>> open_postgres_tasks(const std::string& url,
                                                       const RobotSignature& signature,
                                                       TaskOwner owner) {
  auto connection = MNEME_TRY(PostgresConnection::open(url));
  auto queue = std::make_unique<PostgresTasks>(
      std::make_shared<PostgresConnection>(std::move(connection)), signature, std::move(owner));
  MNEME_TRY(queue->create());
  return queue;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "support/exported.h"
#include "support/planar_memory.h"

#ifdef MNEME_HAS_POSTGRESQL
#include "engines/postgres_server.h"
#endif

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

namespace mneme::test {
namespace {

LearnJob shared_job(const std::string& url, int jobs = 1) {
  LearnJob job;
  job.settings = cheap_settings();
  job.jobs = jobs;
  job.shared = SharedWork{url, 60};
  return job;
}

#ifdef MNEME_HAS_POSTGRESQL

Result<LearnSummary> work(const std::string& url, const Robot& robot,
                          const std::vector<PrimitiveKey>& keys, const LearnJob& job) {
  const auto space = make_signature(robot);
  auto database = Database::open(url, space, OpenMode::create);
  if (!database) return tl::unexpected(database.error());
  return learn_primitives(robot, keys, *database, job);
}

/// The same lessons by one process in a file.
std::string learned_alone(const Robot& robot, const std::vector<PrimitiveKey>& keys) {
  const TemporaryDirectory directory;
  Database database = make_database(directory / "a.db", robot);
  learn_into(database, robot, keys);
  return exported(directory / "a.db");
}

std::int64_t ask(internal::PostgresConnection& connection, const char* sql) {
  return require(connection.query(sql)).integer(0, 0);
}

std::int64_t ask(const std::string& url, const char* sql) {
  auto connection = connect_to(url);
  return ask(connection, sql);
}

/// Asks again and again, with pauses that leave the processor to others, until the answer is true.
void wait_until(const std::string& url, const char* condition) {
  auto connection = connect_to(url);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (ask(connection, fmt::format("SELECT ({})::int", condition).c_str()) == 0) {
    REQUIRE(std::chrono::steady_clock::now() < patience);
    require(connection.query("SELECT pg_sleep(0.01)"));
  }
}

/// A process that works on a job, and ends with 0 if all went well.
pid_t start_worker(const std::string& url, const Robot& robot,
                   const std::vector<PrimitiveKey>& keys) {
  return start_child([&] {
    LearnJob job = shared_job(url);
    job.shared->lease_s = 0.5;  // so that the others soon have what a killed one held
    return work(url, robot, keys, job) ? 0 : 1;
  });
}

#endif

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("work in a file cannot be shared") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    Database database = make_database(directory / "a.db", robot);
    const auto keys = random_keys(2, 1);
    const Error refused =
        require_error(learn_primitives(robot, keys, database, shared_job(directory / "a.db")));
    CHECK(refused.code == ErrorCode::unsupported);
    CHECK(contains(refused.message, "a.db"));
    CHECK(database.size() == 0);
  }

  TEST_CASE("a lease that cannot be kept is refused") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    Database database = make_database(directory / "a.db", robot);
    for (const double lease_s : {0.0, -1.0, 1e6, std::nan("")}) {
      LearnJob job = shared_job("postgresql://nowhere.invalid/x");
      job.shared->lease_s = lease_s;
      const Error refused =
          require_error(learn_primitives(robot, random_keys(1, 1), database, job));
      CHECK(refused.code == ErrorCode::invalid);
    }
  }
}

#ifdef MNEME_HAS_POSTGRESQL

TEST_SUITE("flow") {
  TEST_CASE("a process that works alone learns what it would in a file, and nothing twice") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    auto keys = random_keys(12, 61);
    keys.push_back(keys[3]);
    std::vector<LearnProgress> progress;
    LearnJob job = shared_job(url, 3);
    job.on_progress = [&](const LearnProgress& latest) { progress.push_back(latest); };
    const LearnSummary summary = require(work(url, robot, keys, job));
    CHECK(summary.learned == 12);
    CHECK(summary.skipped == 1);
    CHECK(!summary.is_cancelled);
    REQUIRE(!progress.empty());
    CHECK(progress.back().done == 13);
    CHECK(progress.back().total == 13);
    CHECK(exported(url) == learned_alone(robot, keys));

    const LearnSummary again = require(work(url, robot, keys, shared_job(url)));
    CHECK(again.learned == 0);
    CHECK(again.skipped == 13);
    CHECK(ask(url, "SELECT max(attempt) FROM mneme_task") == 1);
  }

  TEST_CASE("what was learned before is not learned again, and what was lost is") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    const auto keys = random_keys(6, 62);
    {
      Database database = make_database(url, robot);
      learn_into(database, robot, {keys[0], keys[4]});
    }
    CHECK(require(work(url, robot, keys, shared_job(url))).learned == 4);
    const std::string whole = exported(url);
    CHECK(ask(url, "UPDATE mneme_mixture SET seed = 1 WHERE id = 5 RETURNING 1") == 1);
    REQUIRE(verify_database(url, VerifyMode::quarantine)->size() == 1);
    const LearnSummary summary = require(work(url, robot, keys, shared_job(url)));
    CHECK(summary.learned == 1);
    CHECK(summary.skipped == 5);
    CHECK(exported(url) == whole);
  }

  TEST_CASE("a cancelled process saves what it has and gives the rest back") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    const auto keys = random_keys(300, 63);
    std::atomic<bool> is_cancelled = false;
    LearnJob job = shared_job(url, 2);
    job.shared->lease_s = 3600;
    job.cancel = &is_cancelled;
    job.settings.paths_per_start = 20;
    job.on_progress = [&](const LearnProgress&) { is_cancelled = true; };
    const LearnSummary summary = require(work(url, robot, keys, job));
    CHECK(summary.is_cancelled);
    CHECK(summary.learned == make_database(url, robot, OpenMode::read_only).size());
    CHECK(summary.learned < 300);
    CHECK(ask(url, "SELECT count(leased_until) FROM mneme_task") == 0);
  }

  TEST_CASE("a server that is killed and started again is waited for") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    const auto keys = random_keys(24, 65);
    const LearnJob job = shared_job(url);
    Result<LearnSummary> summary = LearnSummary();
    {
      (void)make_database(url, robot);
      const std::jthread worker([&] { summary = work(url, robot, keys, job); });
      wait_until(url, "EXISTS (SELECT 1 FROM mneme_experience)");
      server->kill_postmaster();
      REQUIRE(server->start());
    }
    REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
    CHECK(verify_database(url)->empty());
    CHECK(exported(url) == learned_alone(robot, keys));
  }

  TEST_CASE("a server that is killed when all is learned is waited for") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    const auto keys = random_keys(4, 66);
    LearnJob job = shared_job(url);
    std::atomic<bool> is_killed = false;
    job.on_progress = [&](const LearnProgress& latest) {
      if (latest.done < latest.total || is_killed) return;
      server->kill_postmaster();
      while (internal::PostgresConnection::open(url)) {
      }
      is_killed = true;
      is_killed.notify_one();
    };
    Result<LearnSummary> summary = LearnSummary();
    {
      const std::jthread worker([&] { summary = work(url, robot, keys, job); });
      is_killed.wait(false);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));  // so that it calls in vain
      REQUIRE(server->start());
    }
    REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
    CHECK(summary->learned == 4);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("workers of which one is killed again and again do every task once in effect") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    const Robot robot = planar8();
    const auto keys = random_keys(rounds(100), 64);
    (void)make_database(url, robot);
    auto watcher = connect_to(url);
    // While nobody can save, the first one surely has something to lose.
    for (const char* step : {"BEGIN", "LOCK TABLE mneme_experience IN SHARE ROW EXCLUSIVE MODE"}) {
      require(watcher.query(step));
    }
    const pid_t first = start_worker(url, robot, keys);
    wait_until(url, "to_regclass('mneme_task') IS NOT NULL");
    wait_until(url, "EXISTS (SELECT 1 FROM mneme_task WHERE attempt = 1)");
    ::kill(first, SIGKILL);
    REQUIRE(wait_for(first) == -1);
    require(watcher.query("ROLLBACK"));
    std::array<pid_t, 4> workers{};
    for (pid_t& worker : workers) worker = start_worker(url, robot, keys);
    int killed = 1;
    const int wanted = rounds(6);
    const auto open_tasks = [&] {
      return ask(watcher, "SELECT count(*) - count(done_generation) FROM mneme_task");
    };
    for (std::int64_t open = open_tasks(); killed < wanted || open > 0; open = open_tasks()) {
      // The next one goes when there is something new to lose.
      wait_until(url, fmt::format("SELECT count(*) - count(done_generation) < greatest({}, 1) "
                                  "FROM mneme_task",
                                  open)
                          .c_str());
      pid_t& victim = workers[static_cast<std::size_t>(killed) % workers.size()];
      ::kill(victim, SIGKILL);
      killed += wait_for(victim) == -1 ? 1 : 0;
      victim = start_worker(url, robot, keys);
    }
    for (const pid_t worker : workers) CHECK(wait_for(worker) == 0);
    CHECK(ask(url, "SELECT max(attempt) FROM mneme_task") > 1);
    const auto count = static_cast<std::int64_t>(keys.size());
    CHECK(ask(url, "SELECT count(*) FROM mneme_task") == count);
    CHECK(ask(url, "SELECT count(done_generation) FROM mneme_task") == count);
    CHECK(ask(url, "SELECT count(*) FROM mneme_experience") == count);
    CHECK(ask(url, "SELECT count(*) FROM mneme_tombstone") == 0);
    CHECK(verify_database(url)->empty());
    CHECK(exported(url) == learned_alone(robot, keys));
  }
}

#endif

}  // namespace mneme::test

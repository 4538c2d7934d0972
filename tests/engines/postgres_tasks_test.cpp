// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/postgres_server.h"
#include "engines/postgres_store.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <thread>

namespace mneme::test {
namespace {

using internal::Lease;
using internal::TaskQueue;

constexpr double kHour = 3600;

std::unique_ptr<TaskQueue> open_queue(const std::string& url, std::int64_t job = 7) {
  return require(internal::open_postgres_tasks(url, arm_signature(), {job, "tester"}));
}

std::vector<std::int64_t> first_tasks(std::int64_t count) {
  std::vector<std::int64_t> tasks(static_cast<std::size_t>(count));
  std::iota(tasks.begin(), tasks.end(), 0);
  return tasks;
}

/// The URL of a database without rows, with `count` tasks.
std::string make_tasks(PostgresServer& server, std::int64_t count) {
  const std::string url = server.new_url();
  (void)open_database(url);
  require(open_queue(url)->add(first_tasks(count), 0));
  return url;
}

std::vector<Lease> take(TaskQueue& queue, int count, double seconds) {
  return require(queue.take(count, seconds));
}

std::vector<Lease> finish(TaskQueue& queue, const std::vector<Lease>& leases,
                          const std::vector<Experience>& rows) {
  return require(queue.finish(leases, rows));
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("every task is taken once, and is gone when it is done") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 5);
    const auto a = open_queue(url);
    const auto b = open_queue(url);
    const auto first = take(*a, 3, kHour);
    CHECK(first == std::vector<Lease>{{0, 1}, {1, 1}, {2, 1}});
    CHECK(take(*b, 3, kHour) == std::vector<Lease>{{3, 1}, {4, 1}});
    CHECK(take(*a, 3, kHour).empty());
    CHECK(a->count_open() == 5);
    Rng rng(1);
    CHECK(finish(*a, first, random_rows(rng, 3)) == first);
    CHECK(a->count_open() == 2);
    CHECK(open_database(url, OpenMode::read_only).size() == 3);
    // Tasks of another job are nobody else's business.
    CHECK(take(*open_queue(url, 8), 3, kHour).empty());
    CHECK(open_queue(url, 8)->count_open() == 0);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("an expired lease goes to another, who fences the first one off") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 2);
    const auto slow = open_queue(url);
    const auto quick = open_queue(url);
    const auto lost = take(*slow, 2, 0);
    const auto taken = take(*quick, 1, kHour);
    REQUIRE(taken == std::vector<Lease>{{0, 2}});
    Rng rng(2);
    const auto rows = random_rows(rng, 3);
    // The second task had expired too, but nobody noticed.
    CHECK(slow->renew(lost, kHour) == std::vector<Lease>{{1, 1}});
    CHECK(finish(*slow, lost, {rows[0], rows[1]}) == std::vector<Lease>{{1, 1}});
    CHECK(open_database(url, OpenMode::read_only).size() == 1);
    CHECK(finish(*quick, taken, {rows[2]}) == taken);
    CHECK(slow->renew(lost, kHour)->empty());
    const Database database = open_database(url, OpenMode::read_only);
    REQUIRE(database.size() == 2);
    CHECK(is_same_content(*database.get(0), rows[1]));
    CHECK(is_same_content(*database.get(1), rows[2]));
    CHECK(quick->count_open() == 0);
  }

  TEST_CASE("a heartbeat keeps a lease, and what is given back is free at once") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 1);
    const auto a = open_queue(url);
    const auto b = open_queue(url);
    const auto lease = take(*a, 1, 0);
    CHECK(a->renew(lease, kHour) == lease);
    CHECK(take(*b, 1, kHour).empty());
    CHECK(a->release(lease).has_value());
    CHECK(take(*b, 1, kHour) == std::vector<Lease>{{0, 2}});
  }

  TEST_CASE("a result whose commit was not answered may be sent again") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 2);
    const auto queue = open_queue(url);
    const auto leases = take(*queue, 2, kHour);
    Rng rng(3);
    const auto rows = random_rows(rng, 2);
    CHECK(finish(*queue, leases, rows) == leases);
    CHECK(finish(*queue, leases, rows) == leases);
    CHECK(open_database(url, OpenMode::read_only).size() == 2);
    CHECK(verify_database(url)->empty());
  }

  TEST_CASE("a row that cannot be stored leaves its task, and those beside it, undone") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 2);
    const auto queue = open_queue(url);
    const auto leases = take(*queue, 2, kHour);
    Rng rng(4);
    auto rows = random_rows(rng, 2);
    rows[1].key.pop_back();
    CHECK(require_error(queue->finish(leases, rows)).code == ErrorCode::invalid);
    CHECK(queue->count_open() == 2);
    CHECK(open_database(url, OpenMode::read_only).size() == 0);
    CHECK(queue->renew(leases, kHour) == leases);
  }

  TEST_CASE("a task opens again only if its result is missing from what the adder has seen") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = make_tasks(*server, 2);
    const auto queue = open_queue(url);
    Rng rng(5);
    CHECK(finish(*queue, take(*queue, 1, kHour), random_rows(rng, 1)).size() == 1);
    const std::int64_t done_at = open_database(url, OpenMode::read_only).info().generation;
    require(queue->add(first_tasks(2), done_at - 1));
    CHECK(queue->count_open() == 1);
    require(queue->add(first_tasks(2), done_at));
    CHECK(queue->count_open() == 2);
    CHECK(take(*queue, 1, kHour) == std::vector<Lease>{{0, 2}});
  }

  TEST_CASE("queues that are opened and asked at the same time share the tasks out") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    const std::string url = server->new_url();
    (void)open_database(url);
    std::array<std::vector<Lease>, 4> taken;
    std::array<bool, 4> is_sound{};
    {
      std::vector<std::jthread> threads;
      for (std::size_t i = 0; i < taken.size(); ++i) {
        threads.emplace_back([&, i] {
          auto queue = internal::open_postgres_tasks(url, arm_signature(), {7, "tester"});
          if (!queue || !(*queue)->add(first_tasks(200), 0)) return;
          for (;;) {
            const auto leases = (*queue)->take(3, kHour);
            if (!leases) return;
            if (leases->empty()) break;
            taken[i].insert(taken[i].end(), leases->begin(), leases->end());
          }
          is_sound[i] = true;
        });
      }
    }
    std::set<std::int64_t> tasks;
    std::size_t count = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      CHECK(is_sound[i]);
      for (const Lease& lease : taken[i]) tasks.insert(lease.task);
      count += taken[i].size();
    }
    CHECK(tasks.size() == count);
    // Whoever finds all free tasks locked for a moment goes home early; nobody may take one twice.
    const auto rest = take(*open_queue(url), 200, kHour);
    CHECK(count + rest.size() == 200);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"
#include "engines/open_store.h"

#include <atomic>
#include <set>
#include <thread>

namespace mneme::test {
namespace {

/// Inserts `count` batches of two rows each; returns the number that succeeded.
int insert_batches(Database& database, std::uint64_t seed, int count) {
  Rng rng(seed);
  int succeeded = 0;
  for (int i = 0; i < count; ++i) {
    const auto ids = database.insert(random_rows(rng, 2));
    // Two rows of a batch stand next to each other, because they share a transaction.
    if (ids && ids->size() == 2 && ids->at(1) == ids->at(0) + 1) ++succeeded;
  }
  return succeeded;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("threads insert and search at the same time") {
    const TemporaryDirectory directory;
    constexpr int kBatches = 25;
    {
      Database database = open_database(directory / "a.db");
      std::atomic<int> succeeded = 0;
      std::atomic<bool> is_done = false;
      std::atomic<bool> is_sound = true;
      std::vector<std::thread> writers;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        writers.emplace_back([&, seed] { succeeded += insert_batches(database, seed, kBatches); });
      }
      std::vector<std::thread> readers;
      for (std::uint64_t seed = 5; seed <= 6; ++seed) {
        readers.emplace_back([&, seed] {
          Rng rng(seed);
          while (!is_done) {
            const auto matches = find_like(database, make_primitive(random_key(rng)), 3, 8);
            if (!matches) is_sound = false;
            for (const KeyMatch& match : matches.value_or(std::vector<KeyMatch>())) {
              if (match.experience->id < 1 || match.similarity_error >= 3) is_sound = false;
            }
            const std::int64_t size = database.size();
            if (size > 0 && database.get(size - 1)->id != size) is_sound = false;
          }
        });
      }
      for (std::thread& thread : writers) thread.join();
      is_done = true;
      for (std::thread& thread : readers) thread.join();
      CHECK(succeeded == 4 * kBatches);
      CHECK(is_sound);
      CHECK(database.size() == 2 * 4 * kBatches);
    }
    CHECK(verify_database(directory / "a.db")->empty());
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 2 * 4 * kBatches);
  }

  TEST_CASE("whoever searches or refreshes does not wait for whoever waits to write") {
    const TemporaryDirectory directory;
    Rng rng(59);
    const auto rows = random_rows(rng, 50);
    REQUIRE(open_database(directory / "a.db").insert(rows));
    const auto partly =
        Database::open(directory / "a.db", arm_signature(), OpenMode::read_only, {0});
    REQUIRE(partly.has_value());
    Database reader = open_database(directory / "a.db", OpenMode::read_only);
    Database writer = open_database(directory / "a.db", OpenMode::read_write);
    auto lock = require(internal::open_store(directory / "a.db", OpenMode::read_write));
    auto held = require(lock->begin(internal::Store::Kind::write));
    std::atomic<bool> is_inserted = false;
    std::thread waiting([&] {
      Rng other(60);
      is_inserted = writer.insert(random_rows(other, 2)).has_value();
    });
    // Each of these would last until the lock is let go, which only happens after them.
    for (const Experience& row : rows) {
      CHECK(find_like(writer, make_primitive(row.key), 1e-9, 1)->size() == 1);
      CHECK(find_like(*partly, make_primitive(row.key), 1e-9, 1)->size() == 1);
    }
    CHECK(writer.size() == 50);
    CHECK(reader.refresh() == 0);
    CHECK(!is_inserted);
    held.reset();
    waiting.join();
    CHECK(is_inserted);
    CHECK(writer.size() == 52);
    CHECK(reader.refresh() == 2);
  }

  TEST_CASE("processes that create and fill one database do not lose each other's rows") {
    const TemporaryDirectory directory;
    constexpr int kBatches = 25;
    std::vector<pid_t> children;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      children.push_back(start_child([&, seed] {
        auto database = Database::open(directory / "a.db", arm_signature(), OpenMode::create);
        return database && insert_batches(*database, seed, kBatches) == kBatches ? 0 : 1;
      }));
    }
    for (const pid_t child : children) CHECK(wait_for(child) == 0);
    CHECK(verify_database(directory / "a.db")->empty());
    const Database database = open_database(directory / "a.db", OpenMode::read_only);
    REQUIRE(database.size() == 3 * 2 * kBatches);
    std::set<std::uint64_t> seeds;
    for (std::int64_t i = 0; i < database.size(); ++i) {
      CHECK(database.get(i)->id == i + 1);
      seeds.insert(database.get(i)->provenance.seed);
    }
    CHECK(seeds.size() == 3 * 2 * kBatches);
  }
}

}  // namespace mneme::test

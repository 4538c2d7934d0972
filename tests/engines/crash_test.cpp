// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"

#include <chrono>
#include <csignal>
#include <set>

namespace mneme::test {
namespace {

struct Pipe {
  Pipe() { REQUIRE(::pipe(ends) == 0); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    ::close(ends[0]);
    close_writer();
  }
  void close_writer() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  /// Returns false at the end.
  bool read(std::int64_t& id) const { return ::read(ends[0], &id, sizeof id) == sizeof id; }
  void write(std::int64_t id) const { (void)!::write(ends[1], &id, sizeof id); }
  int ends[2] = {-1, -1};
};

/// Inserts until it is killed, and says which rows it was told are safe.
int insert_forever(const std::string& path, std::uint64_t seed, const Pipe& acknowledged) {
  auto database = Database::open(path, arm_signature(), OpenMode::create);
  if (!database) return 1;
  Rng rng(seed);
  for (;;) {
    const auto ids = database->insert(random_rows(rng, 1 + static_cast<int>(rng.index(3))));
    if (!ids) return 2;
    for (const std::int64_t id : *ids) acknowledged.write(id);
  }
}

/// Queues rows until it is killed, and says how many are stored.
int queue_forever(const std::string& path, std::uint64_t seed, const Pipe& stored) {
  auto database = Database::open(path, arm_signature(), OpenMode::create);
  if (!database) return 1;
  Rng rng(seed);
  for (;;) {
    if (!database->insert_later(random_rows(rng, 1))) return 2;
    if (rng.index(100) == 0 && !database->flush()) return 3;
    stored.write(database->queued_rows().stored);
  }
}

std::set<std::int64_t> ids_of(const Database& database) {
  std::set<std::int64_t> ids;
  for (std::int64_t i = 0; i < database.size(); ++i) ids.insert(database.get(i)->id);
  return ids;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a killed writer loses nothing that was acknowledged") {
    const std::uint64_t seed = 91;
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(seed);
    std::set<std::int64_t> acknowledged;
    for (int round = 0; round < rounds(12); ++round) {
      Pipe pipe;
      const std::uint64_t child_seed = rng.next();
      const pid_t child = start_child([&] { return insert_forever(path, child_seed, pipe); });
      pipe.close_writer();
      std::int64_t id = 0;
      for (std::uint32_t count = 1 + rng.index(10); count > 0 && pipe.read(id); --count) {
        acknowledged.insert(id);
      }
      spin(std::chrono::microseconds(rng.index(5000)));
      ::kill(child, SIGKILL);
      REQUIRE(wait_for(child) == -1);
      while (pipe.read(id)) acknowledged.insert(id);

      INFO("seed " << seed << ", round " << round);
      REQUIRE(verify_database(path)->empty());
      const std::set<std::int64_t> stored = ids_of(open_database(path, OpenMode::read_only));
      REQUIRE(
          std::includes(stored.begin(), stored.end(), acknowledged.begin(), acknowledged.end()));
    }
    CHECK(acknowledged.size() >= 12);
  }

  TEST_CASE("a killed process loses only queued rows that it did not report as stored") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(96);
    std::int64_t before = 0, reported = 0;
    for (int round = 0; round < rounds(12); ++round) {
      Pipe pipe;
      const std::uint64_t seed = rng.next();
      const pid_t child = start_child([&] { return queue_forever(path, seed, pipe); });
      pipe.close_writer();
      std::int64_t stored = 0;
      for (std::uint32_t count = 500 + rng.index(2000); count > 0 && pipe.read(stored); --count) {
      }
      ::kill(child, SIGKILL);
      REQUIRE(wait_for(child) == -1);
      while (pipe.read(stored)) {
      }
      INFO("round ", round, ": ", stored, " rows");
      REQUIRE(verify_database(path)->empty());
      const std::int64_t size = open_database(path, OpenMode::read_only).size();
      CHECK(size >= before + stored);
      before = size;
      reported += stored;
    }
    CHECK(reported > 0);
  }

  TEST_CASE("whoever is killed while they merge, quarantine or compact leaves a sound database") {
    const std::uint64_t seed = 94;
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(seed);
    REQUIRE(open_database(directory / "b.db").insert(random_rows(rng, 600)));
    REQUIRE(open_database(path).insert(random_rows(rng, 300)));
    int killed = 0;
    const int count = rounds(6);
    for (int round = 0; round < count; ++round) {
      run_sql(path,
              "UPDATE mixture SET seed = seed + 1 WHERE id % 37 = 3 AND id NOT IN "
              "(SELECT row FROM tombstone)");
      const pid_t child = start_child([&] {
        for (;;) {
          (void)verify_database(path, VerifyMode::quarantine);
          (void)merge_databases(path, directory / "b.db");
          (void)compact_database(path);
        }
        return 0;
      });
      spin(std::chrono::microseconds(1000 + rng.index(60000)));
      ::kill(child, SIGKILL);
      killed += wait_for(child) == -1 ? 1 : 0;
      INFO("seed " << seed << ", round " << round);
      // The damage above may not have been set aside yet; nothing else may be wrong.
      const auto damages = require(verify_database(path, VerifyMode::quarantine));
      for (const Damage& damage : damages) {
        REQUIRE_MESSAGE(damage.id % 37 == 3, damage.what);
      }
      REQUIRE(verify_database(path)->empty());
    }
    CHECK(killed == count);
    require(merge_databases(path, directory / "b.db"));
    REQUIRE(open_database(path, OpenMode::read_only).size() >= 600);
  }

  TEST_CASE("a file whose creation was killed is an empty database") {
    const std::uint64_t seed = 92;
    const TemporaryDirectory directory;
    Rng rng(seed);
    for (int round = 0; round < rounds(12); ++round) {
      const std::string path = directory / ("round" + std::to_string(round));
      const pid_t child = start_child([&] {
        write_file(path, "");
        const auto database = Database::open(path, arm_signature(), OpenMode::create);
        for (;;) ::pause();
        return database ? 0 : 1;
      });
      // As far as the file, its journal or its log, and then a little further.
      const char* stage = std::array{"", "-journal", "-wal"}[rng.index(3)];
      const auto patience = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
      while (!std::filesystem::exists(path + stage) &&
             std::chrono::steady_clock::now() < patience) {
      }
      spin(std::chrono::microseconds(rng.index(3000)));
      ::kill(child, SIGKILL);
      REQUIRE(wait_for(child) == -1);

      INFO("seed " << seed << ", round " << round << ", killed after " << path << stage);
      if (std::filesystem::exists(path)) {
        CHECK(verify_database(path)->empty());
        CHECK(open_database(path, OpenMode::read_only).size() == 0);
      }
      Database database = open_database(path);
      CHECK(database.size() == 0);
      CHECK(database.insert(random_rows(rng, 1)).has_value());
    }
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "experience/row_loader.h"
#include "engines/fixtures.h"
#include "engines/sqlite_store.h"

#include <thread>

namespace mneme::test {
namespace {

using internal::bytes_of;
using internal::ExperienceCache;
using internal::SharedExperience;

SharedExperience make_row(std::int64_t id, int components = 5) {
  Rng rng(81);
  Experience row = random_experience(rng, components);
  row.id = id;
  return std::make_shared<const Experience>(std::move(row));
}

void keep(ExperienceCache& cache, std::int64_t id) { cache.keep(std::vector{make_row(id)}); }

bool holds(ExperienceCache& cache, std::int64_t id) { return cache.find({&id, 1})[0] != nullptr; }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows come back in the order that was asked for, and nothing for those not here") {
    ExperienceCache cache(1 << 20);
    for (const std::int64_t id : {1, 2, 3}) keep(cache, id);
    const auto found = cache.find(std::vector<std::int64_t>{3, 9, 1});
    REQUIRE(found.size() == 3);
    CHECK(found[0]->id == 3);
    CHECK(found[1] == nullptr);
    CHECK(found[2]->id == 1);
    CHECK(!cache.is_full());
  }

  TEST_CASE("what was not asked for the longest time goes first") {
    ExperienceCache cache(3 * bytes_of(*make_row(1)));
    for (const std::int64_t id : {1, 2, 3}) keep(cache, id);
    CHECK(!cache.is_full());
    CHECK(holds(cache, 1));
    keep(cache, 4);
    CHECK(cache.is_full());
    CHECK(!holds(cache, 2));
    for (const std::int64_t id : {1, 3, 4}) CHECK(holds(cache, id));
  }

  TEST_CASE("without room nothing stays, and what was handed out is not touched") {
    ExperienceCache cache(0);
    const SharedExperience row = make_row(1);
    cache.keep(std::vector{row});
    CHECK(!holds(cache, 1));
    CHECK(row->sampler().component_count() == 5);
  }

  TEST_CASE("what is forgotten leaves room, and may come again") {
    ExperienceCache cache(2 * bytes_of(*make_row(1)));
    keep(cache, 1);
    keep(cache, 2);
    cache.forget(std::vector<std::int64_t>{1, 7});
    CHECK(!holds(cache, 1));
    keep(cache, 3);
    CHECK(holds(cache, 2));
    CHECK(!cache.is_full());
    keep(cache, 3);
    CHECK(!cache.is_full());
  }

  TEST_CASE("a row with more means takes more bytes") {
    CHECK(bytes_of(*make_row(1, 100)) - bytes_of(*make_row(1, 10)) >= 90 * 3 * 4);
  }

  TEST_CASE("clearances and near misses of a path count") {
    Experience bare, full;
    bare.content = RememberedPath{2, {0, 0, 1, 1}, 0, {}, {}, {}};
    full.content = RememberedPath{2, {0, 0, 1, 1}, 0, {}, {0.1f, 0.2f}, {1, 2, 3, 4, 5, 6}};
    CHECK(bytes_of(full) - bytes_of(bare) == 8 * 4);
  }
}

TEST_SUITE("law") {
  TEST_CASE("threads that keep, find and forget never see another row than they asked for") {
    ExperienceCache cache(20 * bytes_of(*make_row(1)));
    std::atomic<bool> is_sound = true;
    std::vector<std::jthread> threads;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      threads.emplace_back([&, seed] {
        Rng rng(seed);
        for (int i = 0; i < 2000; ++i) {
          const auto id = static_cast<std::int64_t>(rng.index(50));
          if (i % 7 == 0) cache.forget({&id, 1});
          const auto found = cache.find({&id, 1})[0];
          if (found == nullptr) keep(cache, id);
          if (found != nullptr && found->id != id) is_sound = false;
        }
      });
    }
    threads.clear();
    CHECK(is_sound);
  }
}

namespace {

using internal::Caching;
using internal::RowLoader;

constexpr std::int64_t kMuch = 1 << 20;

/// Four rows with the ids 1 to 4.
std::vector<Experience> fill(const std::string& path) {
  Rng rng(101);
  auto rows = random_rows(rng, 4);
  REQUIRE(open_database(path).insert(rows));
  return rows;
}

std::vector<std::int64_t> ids_of(const RowLoader& loader, std::vector<std::int64_t> ids) {
  const auto rows = require(loader.load(ids, Caching::keep));
  std::vector<std::int64_t> found;
  for (const auto& row : rows) found.push_back(row == nullptr ? 0 : row->id);
  return found;
}

Error load_error(const RowLoader& loader, std::int64_t id) {
  return require_error(loader.load({&id, 1}, Caching::keep));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows are read in the order that was asked for, as they were stored") {
    const TemporaryDirectory directory;
    const auto rows = fill(directory / "a.db");
    const RowLoader loader(directory / "a.db", arm_signature(), kMuch);
    CHECK(ids_of(loader, {3, 1, 4}) == std::vector<std::int64_t>{3, 1, 4});
    CHECK(is_same_content(*loader.load(std::array{std::int64_t{2}}, Caching::keep)->front(),
                          rows[1]));
    CHECK(ids_of(loader, {}).empty());
  }

  TEST_CASE("what was read once is not read again, unless it was not to be kept") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    const RowLoader loader(directory / "a.db", arm_signature(), kMuch);
    require(loader.load(std::array{std::int64_t{1}}, Caching::keep));
    require(loader.load(std::array{std::int64_t{2}}, Caching::pass));
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1");
    CHECK(ids_of(loader, {1}) == std::vector<std::int64_t>{1});
    CHECK(load_error(loader, 2).code == ErrorCode::corrupt);
  }

  TEST_CASE("a damaged or missing row is an error that names it, and says what helps") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET time = 'never' WHERE id = 2");
    run_sql(directory / "a.db", "DELETE FROM experience WHERE id = 3");
    RowLoader loader(directory / "a.db", arm_signature(), kMuch);
    auto connection = require(
        internal::Connection::open(directory / "a.db", internal::Connection::Access::create));
    loader.set_epoch(require(internal::read_head(connection)).epoch);
    const Error damaged = load_error(loader, 2);
    CHECK(damaged.code == ErrorCode::corrupt);
    CHECK(contains(damaged.message, "row 2 is damaged"));
    CHECK(contains(damaged.message, "mneme db verify"));
    CHECK(contains(load_error(loader, 3).message, "row 3 is damaged: it is missing"));
    CHECK(ids_of(loader, {1, 4}) == std::vector<std::int64_t>{1, 4});
  }

  TEST_CASE("rows that were set aside, or removed after that, are left out") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    RowLoader loader(directory / "a.db", arm_signature(), kMuch);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(ids_of(loader, {1, 2}) == std::vector<std::int64_t>{1, 0});
    require(compact_database(directory / "a.db"));
    CHECK(ids_of(loader, {2, 3}) == std::vector<std::int64_t>{0, 3});
  }

  TEST_CASE("a file that is gone is an error") {
    const TemporaryDirectory directory;
    const RowLoader loader(directory / "none.db", arm_signature(), kMuch);
    CHECK(load_error(loader, 1).code == ErrorCode::io);
  }
}

}  // namespace mneme::test

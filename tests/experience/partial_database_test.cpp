// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Databases that are larger than what they may take in memory.
#include "mneme/upkeep.h"

#include "engines/fixtures.h"
#include "support/kinds.h"
#include "experience/index_file.h"

#include <thread>

namespace mneme::test {
namespace {

constexpr DatabaseSettings kNothing = {0};
/// Some fifty of the rows below.
constexpr DatabaseSettings kLittle = {40000};

Database open_partly(const std::string& path, OpenMode mode = OpenMode::read_only,
                     const DatabaseSettings& settings = kNothing) {
  return require(Database::open(path, arm_signature(), mode, settings));
}

std::vector<Experience> fill(const std::string& path, int count) {
  Rng rng(111);
  auto rows = random_rows(rng, count);
  REQUIRE(open_database(path).insert(rows));
  return rows;
}

std::vector<std::int64_t> ids(const std::vector<KeyMatch>& matches) {
  std::vector<std::int64_t> found;
  for (const KeyMatch& match : matches) found.push_back(match.experience->id);
  return found;
}

/// Asks both for the same matches.
void check_same(const Database& a, const Database& b) {
  Rng rng(112);
  REQUIRE(a.size() == b.size());
  for (int i = 0; i < 30; ++i) {
    const LocalPrimitive primitive = make_primitive(random_key(rng));
    const auto of_a = require(find_like(a, primitive, 3, 9));
    const auto of_b = require(find_like(b, primitive, 3, 9));
    REQUIRE(ids(of_a) == ids(of_b));
    for (std::size_t k = 0; k < of_a.size(); ++k) {
      REQUIRE(is_same_content(*of_a.at(k).experience, *of_b.at(k).experience));
    }
  }
}

void flip_bit(const std::string& path, std::size_t at) {
  std::string bytes = read_file(path);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_file(path, bytes);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("whatever may stay in memory, the answers are the same") {
    const TemporaryDirectory directory;
    const auto rows = fill(directory / "a.db", 300);
    const Database whole = open_database(directory / "a.db", OpenMode::read_only);
    for (const auto& settings : {kNothing, kLittle}) {
      const Database database = open_partly(directory / "a.db", OpenMode::read_only, settings);
      for (int round = 0; round < 2; ++round) check_same(database, whole);
      CHECK(database.info().components == whole.info().components);
      CHECK(is_same_content(*database.get(7), rows[7]));
      std::size_t position = 0;
      REQUIRE(database.for_each(
          [&](const auto& row) { REQUIRE(is_same_content(*row, rows[position++])); }));
      CHECK(position == rows.size());
    }
  }

  TEST_CASE("only a database that is too large has its index in a file") {
    const TemporaryDirectory directory;
    fill(directory / "a.db", 50);
    const std::string file = internal::index_file_of(directory / "a.db");
    open_database(directory / "a.db", OpenMode::read_only);
    CHECK(!std::filesystem::exists(file));
    open_partly(directory / "a.db");
    REQUIRE(std::filesystem::exists(file));
    const auto saved = require(internal::load_index(file, arm_signature()));
    CHECK(saved.groups.at({kPairs}).size() == 50);
  }

  TEST_CASE("what is inserted beyond the bound is found, and leaves an index behind") {
    const TemporaryDirectory directory;
    Rng rng(113);
    const auto rows = random_rows(rng, 300);
    {
      Database database = open_partly(directory / "a.db", OpenMode::create, kLittle);
      for (const Experience& row : rows) REQUIRE(database.insert({row}));
      for (const std::size_t i : {0, 150, 299}) {
        const auto matches = require(find_like(database, make_primitive(rows[i].key), 1e-9, 1));
        REQUIRE(matches.size() == 1);
        CHECK(is_same_content(*matches.front().experience, rows[i]));
      }
    }
    const auto saved =
        internal::load_index(internal::index_file_of(directory / "a.db"), arm_signature());
    REQUIRE(saved.has_value());
    CHECK(saved->groups.at({kPairs}).size() == 300);
  }

  TEST_CASE("a change of the directory does not change which files are meant") {
    const TemporaryDirectory directory;
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(directory / "");
    {
      Rng rng(115);
      Database database = open_partly("a.db", OpenMode::create);
      std::filesystem::current_path(before);
      REQUIRE(database.insert(random_rows(rng, 20)));
      CHECK(database.get(3).has_value());
      CHECK(database.info().bytes > 8192);
      CHECK(database.info().url == "a.db");
    }
    CHECK(!std::filesystem::exists(internal::index_file_of("a.db")));
    CHECK(std::filesystem::exists(internal::index_file_of(directory / "a.db")));
  }

  TEST_CASE("an index that is behind is read on from where it stands") {
    const TemporaryDirectory directory;
    fill(directory / "a.db", 100);
    open_partly(directory / "a.db");
    Rng rng(114);
    REQUIRE(open_database(directory / "a.db").insert(random_rows(rng, 5)));
    check_same(open_partly(directory / "a.db"),
               open_database(directory / "a.db", OpenMode::read_only));
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id IN (3, 103)");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 2);
    check_same(open_partly(directory / "a.db"),
               open_database(directory / "a.db", OpenMode::read_only));
    require(compact_database(directory / "a.db"));
    const Database database = open_partly(directory / "a.db");
    CHECK(database.size() == 103);
    check_same(database, open_database(directory / "a.db", OpenMode::read_only));
  }

  TEST_CASE("the index of another file with the same name is not used") {
    const TemporaryDirectory directory;
    Rng rng(115);
    for (const char* name : {"a.db", "b.db"}) {
      REQUIRE(open_database(directory / name).insert(random_rows(rng, 80)));
    }
    REQUIRE(open_database(directory / "b.db").insert(random_rows(rng, 20)));
    open_partly(directory / "a.db");
    std::filesystem::copy_file(internal::index_file_of(directory / "a.db"),
                               internal::index_file_of(directory / "b.db"));
    check_same(open_partly(directory / "b.db"),
               open_database(directory / "b.db", OpenMode::read_only));
    // The same if rows have vanished from the other file, so that all of it is read.
    run_sql(directory / "b.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 50");
    REQUIRE(verify_database(directory / "b.db", VerifyMode::quarantine)->size() == 1);
    require(compact_database(directory / "b.db"));
    std::filesystem::copy_file(internal::index_file_of(directory / "a.db"),
                               internal::index_file_of(directory / "b.db"),
                               std::filesystem::copy_options::overwrite_existing);
    check_same(open_partly(directory / "b.db"),
               open_database(directory / "b.db", OpenMode::read_only));
  }

  TEST_CASE("a damaged row is named when it matches, and the others can be used") {
    const TemporaryDirectory directory;
    const auto rows = fill(directory / "a.db", 60);
    open_partly(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 7");
    const Database database = open_partly(directory / "a.db");
    const Error error = require_error(find_like(database, make_primitive(rows[6].key), 1e-9, 1));
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(contains(error.message, "row 7 is damaged"));
    CHECK(find_like(database, make_primitive(rows[7].key), 1e-9, 1)->size() == 1);
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(find_like(database, make_primitive(rows[6].key), 1e-9, 1)->empty());
  }

  TEST_CASE("a damaged key is noticed, with or without an index that still knows it") {
    const TemporaryDirectory directory;
    const auto rows = fill(directory / "a.db", 60);
    open_partly(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE experience SET components = 1 WHERE id = 7");
    CHECK(!find_like(open_partly(directory / "a.db"), make_primitive(rows[6].key), 1e-9, 1)
               .has_value());
    std::filesystem::remove(internal::index_file_of(directory / "a.db"));
    const auto refused =
        Database::open(directory / "a.db", arm_signature(), OpenMode::read_only, kNothing);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().code == ErrorCode::corrupt);
  }

  TEST_CASE("refreshing brings the rows of others") {
    const TemporaryDirectory directory;
    fill(directory / "a.db", 60);
    Database reader = open_partly(directory / "a.db");
    Rng rng(116);
    const auto rows = random_rows(rng, 3);
    REQUIRE(open_database(directory / "a.db").insert(rows));
    CHECK(reader.refresh() == 3);
    for (const Experience& row : rows) {
      const auto matches = find_like(reader, make_primitive(row.key), 1e-9, 1);
      REQUIRE(matches->size() == 1);
      CHECK(is_same_content(*matches->front().experience, row));
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("an index file that is damaged anywhere changes no answer") {
    const std::uint64_t seed = 117;
    const TemporaryDirectory directory;
    fill(directory / "a.db", 60);
    const std::string file = internal::index_file_of(directory / "a.db");
    const Database whole = open_database(directory / "a.db", OpenMode::read_only);
    Rng rng(seed);
    for (int i = 0; i < 60; ++i) {
      open_partly(directory / "a.db");
      INFO("seed " << seed << ", round " << i);
      const std::size_t at = rng.index(std::filesystem::file_size(file));
      if (i % 3 == 0) {
        std::filesystem::resize_file(file, at);
      } else {
        flip_bit(file, at);
      }
      check_same(open_partly(directory / "a.db"), whole);
      require(internal::load_index(file, arm_signature()));
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("whoever is killed while it saves the index leaves one that is whole or not used") {
    const TemporaryDirectory directory;
    fill(directory / "a.db", 1000);
    const std::string file = internal::index_file_of(directory / "a.db");
    const Database whole = open_database(directory / "a.db", OpenMode::read_only);
    Rng rng(118);
    for (int i = 0; i < rounds(10); ++i) {
      const pid_t child = start_child([&] {
        for (;;) {
          std::filesystem::remove(file);
          if (!Database::open(directory / "a.db", arm_signature(), OpenMode::read_only, kNothing)) {
            return 1;
          }
        }
      });
      spin(std::chrono::microseconds(2000 + rng.index(20000)));
      ::kill(child, SIGKILL);
      CHECK(wait_for(child) == -1);
      check_same(open_partly(directory / "a.db"), whole);
    }
  }

  TEST_CASE("threads search a database that does not fit while another process adds to it") {
    const TemporaryDirectory directory;
    fill(directory / "a.db", 200);
    Database database = open_partly(directory / "a.db", OpenMode::read_only, kLittle);
    const pid_t child = start_child([&] {
      Rng rng(119);
      auto writer = Database::open(directory / "a.db", arm_signature(), OpenMode::read_write);
      for (int i = 0; writer && i < 20; ++i) {
        if (!writer->insert(random_rows(rng, 2))) return 1;
      }
      return writer ? 0 : 1;
    });
    std::atomic<bool> is_sound = true;
    {
      std::vector<std::jthread> threads;
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        threads.emplace_back([&, seed] {
          Rng rng(seed);
          for (int i = 0; i < 300; ++i) {
            const LocalPrimitive primitive = make_primitive(random_key(rng));
            const auto matches = find_like(database, primitive, 3, 8);
            if (!matches) is_sound = false;
            for (const KeyMatch& match : matches.value_or(std::vector<KeyMatch>())) {
              const double error = pair_error(primitive.key, match.experience->key);
              if (std::abs(error - match.similarity_error) > 1e-12) is_sound = false;
            }
            if (i % 10 == 0 && !database.refresh()) is_sound = false;
          }
        });
      }
    }
    CHECK(wait_for(child) == 0);
    CHECK(is_sound);
    CHECK(database.refresh().has_value());
    CHECK(database.size() == 240);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include <algorithm>

namespace mneme::test {
namespace {

void fill_database(const std::string& path, const std::vector<Experience>& rows) {
  REQUIRE(open_database(path).insert(rows).has_value());
}

/// What a database holds but for its ids.
std::vector<std::string> contents(const std::string& path) {
  const Database database = open_database(path, OpenMode::read_only);
  std::vector<std::string> result;
  for (std::int64_t i = 0; i < database.size(); ++i) {
    const Experience row = *database.get(i);
    std::string text = row.provenance.time + row.provenance.tool;
    for (const double number : row.key) text += " " + std::to_string(number);
    result.push_back(text + std::to_string(row.provenance.seed));
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("merging is idempotent, commutative and associative") {
    const TemporaryDirectory directory;
    Rng rng(24);
    const auto rows = random_rows(rng, 30);
    std::vector<std::vector<Experience>> parts(3);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // Every row is in one part or more, each time with another provenance.
      for (std::size_t part = 0; part < 3; ++part) {
        if (i % 3 != part && rng.index(3) > 0) continue;
        Experience row = rows[i];
        row.provenance.time = "20" + std::to_string(20 + rng.index(5));
        row.provenance.tool = "tool " + std::to_string(rng.index(3));
        parts[part].push_back(row);
      }
    }
    const std::vector<std::vector<int>> orders = {{0, 1, 2}, {2, 1, 0}, {1, 0, 2, 1, 0, 0}};
    std::vector<std::vector<std::string>> results;
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const std::string into = directory / ("into" + std::to_string(i));
      for (const int part : orders[i]) {
        const std::string from = directory / ("part" + std::to_string(part));
        if (!std::filesystem::exists(from))
          fill_database(from, parts[static_cast<std::size_t>(part)]);
        REQUIRE(merge_databases(into, from).has_value());
      }
      CHECK(verify_database(into)->empty());
      results.push_back(contents(into));
      CHECK(merge_databases(into, into)->added == 0);
      CHECK(contents(into) == results.back());
    }
    CHECK(results[0].size() == rows.size());
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the rows of another robot are not merged, and neither are damaged ones") {
    const TemporaryDirectory directory;
    Rng rng(25);
    fill_database(directory / "a.db", random_rows(rng, 2));
    ExperienceSpace other = arm_space();
    other.robot_hash = "other";
    REQUIRE(Database::open(directory / "b.db", other, OpenMode::create).has_value());
    CHECK(merge_databases(directory / "a.db", directory / "b.db").error().code ==
          ErrorCode::wrong_robot);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = 0 WHERE id = 2");
    const auto damaged = merge_databases(directory / "c.db", directory / "a.db");
    REQUIRE(!damaged.has_value());
    CHECK(damaged.error().code == ErrorCode::corrupt);
    CHECK(damaged.error().message.find("row 2") != std::string::npos);
    CHECK(merge_databases(directory / "c.db", directory / "none.db").error().code == ErrorCode::io);
    write_file(directory / "empty.db", "");
    CHECK(merge_databases(directory / "d.db", directory / "empty.db")->read == 0);
  }

  TEST_CASE("a sound copy heals a row that was set aside") {
    const TemporaryDirectory directory;
    Rng rng(26);
    const auto rows = random_rows(rng, 5);
    fill_database(directory / "a.db", rows);
    fill_database(directory / "b.db", rows);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = 0 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(merge_databases(directory / "a.db", directory / "b.db")->added == 1);
    CHECK(contents(directory / "a.db") == contents(directory / "b.db"));
  }

  TEST_CASE("compacting tells what it removed, and refuses a damaged database") {
    const TemporaryDirectory directory;
    Rng rng(27);
    fill_database(directory / "a.db", random_rows(rng, 100));
    run_sql(directory / "a.db",
            "UPDATE mixture SET seed = 0 WHERE id > 20;"
            "UPDATE experience SET cell = 0 WHERE id = 1");
    CHECK(compact_database(directory / "a.db").error().code == ErrorCode::corrupt);
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 81);
    const auto compacted = compact_database(directory / "a.db");
    REQUIRE(compacted.has_value());
    CHECK(compacted->removed == 81);
    CHECK(compacted->bytes_after < compacted->bytes_before);
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 19);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/experience_table.h"
#include "experience/schema.h"

namespace mneme::test {
namespace {

using internal::Connection;
using internal::StoredRow;

Connection connect(const std::string& path) {
  auto connection = Connection::open(path, Connection::Access::create);
  REQUIRE(connection.has_value());
  REQUIRE(internal::create_schema(*connection, arm_space()));
  return std::move(*connection);
}

Result<std::vector<std::int64_t>> read_ids(Connection& connection) {
  std::vector<std::int64_t> ids;
  const auto read = internal::read_rows(connection, [&](const StoredRow& row) {
    ids.push_back(row.id);
    return Result<void>();
  });
  if (!read) return tl::unexpected(read.error());
  return ids;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows come back in the order of their ids with what was written") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(43);
    const auto rows = random_rows(rng, 5);
    const auto first = internal::append_rows(connection, std::span(rows).first(2));
    const auto second = internal::append_rows(connection, std::span(rows).last(3));
    CHECK(first == std::vector<std::int64_t>{1, 2});
    CHECK(second == std::vector<std::int64_t>{3, 4, 5});
    std::size_t position = 0;
    const auto read = internal::read_rows(connection, [&](const StoredRow& row) {
      Experience experience;
      const auto flaw = internal::decode(row.content, row.checksum, arm_space(), experience);
      CHECK(!flaw.has_value());
      CHECK(is_same_content(experience, rows[position++]));
      return Result<void>();
    });
    CHECK(read.has_value());
    CHECK(position == 5);
  }

  TEST_CASE("no rows at all can be appended and read") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    CHECK(internal::append_rows(connection, {}) == std::vector<std::int64_t>{});
    CHECK(read_ids(connection) == std::vector<std::int64_t>{});
  }

  TEST_CASE("an error of the visitor ends the reading") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(44);
    REQUIRE(internal::append_rows(connection, random_rows(rng, 3)));
    int visited = 0;
    const auto read = internal::read_rows(connection, [&](const StoredRow&) -> Result<void> {
      ++visited;
      return fail(ErrorCode::invalid, "enough");
    });
    REQUIRE(!read.has_value());
    CHECK(read.error().message == "enough");
    CHECK(visited == 1);
  }

  TEST_CASE("a row that vanished, was doubled or got another id is noticed") {
    for (const std::string change :
         {"DELETE FROM experience WHERE id = 3", "UPDATE experience SET id = 9 WHERE id = 3",
          "INSERT INTO experience SELECT 9, key, means, factor_rows, factors, origins, tool, "
          "settings, seed, time, checksum FROM experience WHERE id = 1",
          "UPDATE experience SET checksum = 5 WHERE id = 2", "DELETE FROM tally",
          "UPDATE tally SET digest = digest + 1"}) {
      const TemporaryDirectory directory;
      Rng rng(45);
      {
        Connection connection = connect(directory / "a.db");
        REQUIRE(internal::append_rows(connection, random_rows(rng, 3)));
        REQUIRE(read_ids(connection).has_value());
      }
      run_sql(directory / "a.db", change);
      Connection connection = connect(directory / "a.db");
      const auto ids = read_ids(connection);
      INFO(change);
      REQUIRE(!ids.has_value());
      CHECK(ids.error().code == ErrorCode::corrupt);
    }
  }
}

}  // namespace mneme::test

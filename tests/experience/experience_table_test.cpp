// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/experience_table.h"
#include "experience/schema.h"

namespace mneme::test {
namespace {

using internal::Connection;
using internal::EncodedRow;
using internal::RowParts;
using internal::StoredRow;

Connection connect(const std::string& path) {
  auto connection = Connection::open(path, Connection::Access::create);
  REQUIRE(connection.has_value());
  REQUIRE(internal::create_schema(*connection, arm_space()));
  return std::move(*connection);
}

/// Adds rows under the ids from `first` on.
void add(Connection& connection, const std::vector<Experience>& rows, std::int64_t first) {
  for (const Experience& row : rows) {
    const EncodedRow encoded(row);
    const StoredRow stored = encoded.stored(first++, 1);
    REQUIRE(internal::add_rows(connection, std::span(&stored, 1)));
  }
}

std::vector<std::int64_t> ids_after(Connection& connection, std::int64_t after, RowParts parts) {
  std::vector<std::int64_t> ids;
  REQUIRE(internal::read_rows(connection, after, parts, [&](const StoredRow& row) {
    CHECK(row.columns.means.empty() == (parts == RowParts::keys));
    ids.push_back(row.id);
    return Result<void>();
  }));
  return ids;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows come back in the order of their ids with what was written") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(43);
    const auto rows = random_rows(rng, 5);
    add(connection, rows, 1);
    std::size_t position = 0;
    const auto check = [&](const StoredRow& row) {
      Experience experience;
      CHECK(!internal::decode(row, arm_space(), experience).has_value());
      CHECK(experience.id == static_cast<std::int64_t>(position) + 1);
      CHECK(is_same_content(experience, rows[position++]));
      return Result<void>();
    };
    REQUIRE(internal::read_rows(connection, 0, RowParts::all, check));
    CHECK(position == 5);
    CHECK(ids_after(connection, 3, RowParts::all) == std::vector<std::int64_t>{4, 5});
    CHECK(ids_after(connection, 0, RowParts::keys) == std::vector<std::int64_t>{1, 2, 3, 4, 5});
  }

  TEST_CASE("rows can be asked for by id, and ids that do not exist are passed over") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(44);
    add(connection, random_rows(rng, 4), 1);
    std::vector<std::int64_t> ids;
    const std::vector<std::int64_t> wanted = {4, 9, 2};
    REQUIRE(internal::read_rows_by_id(connection, wanted, [&](const StoredRow& row) {
      ids.push_back(row.id);
      return Result<void>();
    }));
    CHECK(ids == std::vector<std::int64_t>{4, 2});
  }

  TEST_CASE("an error of the visitor ends the reading") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(44);
    add(connection, random_rows(rng, 3), 1);
    int visited = 0;
    const auto read =
        internal::read_rows(connection, 0, RowParts::all, [&](const StoredRow&) -> Result<void> {
          ++visited;
          return fail(ErrorCode::invalid, "enough");
        });
    REQUIRE(!read.has_value());
    CHECK(read.error().message == "enough");
    CHECK(visited == 1);
  }

  TEST_CASE("live rows are found by their content, dead ones are not") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(45);
    const auto rows = random_rows(rng, 3);
    add(connection, rows, 1);
    std::vector<internal::ContentHash> contents;
    for (const Experience& row : rows) contents.push_back(EncodedRow(row).content());
    contents.push_back(EncodedRow(random_experience(rng)).content());
    internal::Tombstone tombstone{1, 2, 1, "test", "now", 0};
    tombstone.checksum = checksum_of(tombstone);
    REQUIRE(internal::add_tombstones(connection, std::span(&tombstone, 1)));
    const auto known = internal::find_contents(connection, contents);
    REQUIRE(known.has_value());
    REQUIRE(known->size() == 2);
    CHECK(known->at(0).id == 1);
    CHECK(known->at(1).id == 3);
    CHECK(known->at(1).content == contents[2]);
    CHECK(known->at(1).time == rows[2].provenance.time);

    REQUIRE(internal::remove_dead(connection));
    CHECK(ids_after(connection, 0, RowParts::all) == std::vector<std::int64_t>{1, 3});
  }

  TEST_CASE("a mixture without its key is an orphan, a key without its mixture has a flaw") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    Rng rng(46);
    add(connection, random_rows(rng, 3), 1);
    REQUIRE(connection.execute(
        "DELETE FROM experience WHERE id = 2; DELETE FROM mixture WHERE id = 3"));
    CHECK(internal::find_orphans(connection) == std::vector<std::int64_t>{2});
    std::string flaw;
    REQUIRE(internal::read_rows(connection, 2, RowParts::all, [&](const StoredRow& row) {
      flaw = row.flaw;
      return Result<void>();
    }));
    CHECK(flaw == "its mixture is missing");
  }

  TEST_CASE("the head is one row, and a change of it is noticed") {
    const TemporaryDirectory directory;
    Connection connection = connect(directory / "a.db");
    CHECK(internal::read_head(connection) == internal::StoreState{});
    const internal::StoreState state{1, 2, 3, 4, 5, 6, 7, 8};
    REQUIRE(internal::write_head(connection, state));
    CHECK(internal::read_head(connection) == state);
    REQUIRE(connection.execute("UPDATE head SET last_row = 4"));
    const auto changed = internal::read_head(connection);
    REQUIRE(!changed.has_value());
    CHECK(changed.error().code == ErrorCode::corrupt);
    REQUIRE(connection.execute("DELETE FROM head"));
    CHECK(internal::read_head(connection).error().code == ErrorCode::corrupt);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/legacy_table.h"

#include "experience/fixtures.h"

namespace mneme::test {
namespace {

using internal::Connection;
using internal::StoredRow;

Connection open_copy(const std::string& path) {
  std::filesystem::copy_file(source_file("tests/experience/schema1.db"), path);
  auto connection = Connection::open(path, Connection::Access::read_write);
  REQUIRE(connection.has_value());
  return std::move(*connection);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("old rows look like new ones, and the head counts them") {
    const TemporaryDirectory directory;
    Connection connection = open_copy(directory / "a.db");
    const auto head = internal::read_legacy_head(connection);
    REQUIRE(head.has_value());
    CHECK(head->row_count == 2);
    CHECK(head->last_row == 2);
    std::int64_t digest = 0;
    REQUIRE(internal::read_legacy_rows(connection, 0, [&](const StoredRow& row) {
      Experience experience;
      CHECK(!internal::decode(row, arm_space(), experience).has_value());
      digest ^= internal::tally_mark(row.id, row.tally_checksum);
      return Result<void>();
    }));
    CHECK(digest == head->row_digest);
    const std::vector<std::int64_t> wanted = {2, 7};
    int count = 0;
    REQUIRE(internal::read_legacy_rows_by_id(connection, wanted, [&](const StoredRow& row) {
      CHECK(row.id == 2);
      ++count;
      return Result<void>();
    }));
    CHECK(count == 1);
  }

  TEST_CASE("a damaged old row has a flaw") {
    const TemporaryDirectory directory;
    Connection connection = open_copy(directory / "a.db");
    REQUIRE(connection.execute("UPDATE experience SET seed = 5 WHERE id = 1"));
    std::vector<bool> has_flaw;
    REQUIRE(internal::read_legacy_rows(connection, 0, [&](const StoredRow& row) {
      has_flaw.push_back(!row.flaw.empty());
      return Result<void>();
    }));
    CHECK(has_flaw == std::vector<bool>{true, false});
  }

  TEST_CASE("an old file without its tally is damaged") {
    const TemporaryDirectory directory;
    Connection connection = open_copy(directory / "a.db");
    REQUIRE(connection.execute("DELETE FROM tally"));
    CHECK(internal::read_legacy_head(connection).error().code == ErrorCode::corrupt);
  }
}

}  // namespace mneme::test

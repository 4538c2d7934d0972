// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/row_loader.h"

namespace mneme::test {
namespace {

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
  const auto rows = loader.load(ids, true);
  REQUIRE_MESSAGE(rows.has_value(), (rows ? "" : rows.error().message));
  std::vector<std::int64_t> found;
  for (const auto& row : *rows) found.push_back(row == nullptr ? 0 : row->id);
  return found;
}

Error load_error(const RowLoader& loader, std::int64_t id) {
  const auto rows = loader.load({&id, 1}, true);
  REQUIRE(!rows.has_value());
  return rows.error();
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows are read in the order that was asked for, as they were stored") {
    const TemporaryDirectory directory;
    const auto rows = fill(directory / "a.db");
    const RowLoader loader(directory / "a.db", arm_space(), kMuch);
    CHECK(ids_of(loader, {3, 1, 4}) == std::vector<std::int64_t>{3, 1, 4});
    CHECK(is_same_content(*loader.load(std::array{std::int64_t{2}}, true)->front(), rows[1]));
    CHECK(ids_of(loader, {}).empty());
  }

  TEST_CASE("what was read once is not read again, unless it was not to be kept") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    const RowLoader loader(directory / "a.db", arm_space(), kMuch);
    REQUIRE(loader.load(std::array{std::int64_t{1}}, true).has_value());
    REQUIRE(loader.load(std::array{std::int64_t{2}}, false).has_value());
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1");
    CHECK(ids_of(loader, {1}) == std::vector<std::int64_t>{1});
    CHECK(load_error(loader, 2).code == ErrorCode::corrupt);
  }

  TEST_CASE("a damaged or missing row is an error that names it, and says what helps") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET time = 'never' WHERE id = 2");
    run_sql(directory / "a.db", "DELETE FROM experience WHERE id = 3");
    const RowLoader loader(directory / "a.db", arm_space(), kMuch);
    const Error damaged = load_error(loader, 2);
    CHECK(damaged.code == ErrorCode::corrupt);
    CHECK(damaged.message.find("row 2 is damaged") != std::string::npos);
    CHECK(damaged.message.find("mneme db verify") != std::string::npos);
    CHECK(load_error(loader, 3).message.find("row 3 is damaged: it is missing") !=
          std::string::npos);
    CHECK(ids_of(loader, {1, 4}) == std::vector<std::int64_t>{1, 4});
  }

  TEST_CASE("rows that were set aside, or removed after that, are left out") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    RowLoader loader(directory / "a.db", arm_space(), kMuch);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(ids_of(loader, {1, 2}) == std::vector<std::int64_t>{1, 0});
    REQUIRE(compact_database(directory / "a.db").has_value());
    CHECK(ids_of(loader, {2, 3}) == std::vector<std::int64_t>{0, 3});
  }

  TEST_CASE("a file that is gone is an error") {
    const TemporaryDirectory directory;
    const RowLoader loader(directory / "none.db", arm_space(), kMuch);
    CHECK(load_error(loader, 1).code == ErrorCode::io);
  }

  TEST_CASE("a change of the directory does not change which file is meant") {
    const TemporaryDirectory directory;
    fill(directory / "a.db");
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(directory / "");
    const RowLoader loader("a.db", arm_space(), kMuch);
    std::filesystem::current_path(before);
    CHECK(ids_of(loader, {1}) == std::vector<std::int64_t>{1});
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store_reads.h"

#include "experience/fixtures.h"
#include "experience/open_store.h"

namespace mneme::test {
namespace {

using internal::RowParts;
using internal::StoreState;

internal::OpenedStore open(const std::string& path) {
  auto opened = internal::inspect_store(path);
  REQUIRE(opened.has_value());
  return std::move(*opened);
}

std::vector<std::int64_t> ids_since(internal::Store& store, StoreState& state) {
  std::vector<std::int64_t> ids;
  const auto changes =
      internal::read_changes(store, state, RowParts::all, [&](const internal::StoredRow& row) {
        ids.push_back(row.id);
        return Result<void>();
      });
  REQUIRE_MESSAGE(changes.has_value(), (changes ? "" : changes.error().message));
  state = changes->state;
  return ids;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("only what came since a state is read") {
    const TemporaryDirectory directory;
    Rng rng(21);
    Database writer = open_database(directory / "a.db");
    const auto opened = open(directory / "a.db");
    StoreState state;
    CHECK(ids_since(*opened.store, state).empty());
    REQUIRE(writer.insert(random_rows(rng, 2)));
    CHECK(ids_since(*opened.store, state) == std::vector<std::int64_t>{1, 2});
    CHECK(ids_since(*opened.store, state).empty());
    REQUIRE(writer.insert(random_rows(rng, 1)));
    CHECK(ids_since(*opened.store, state) == std::vector<std::int64_t>{3});
    CHECK(state.row_count == 3);
    CHECK(state.generation == 2);
  }

  TEST_CASE("everything is read again once rows may have vanished, but not the dead ones") {
    const TemporaryDirectory directory;
    Rng rng(22);
    REQUIRE(open_database(directory / "a.db").insert(random_rows(rng, 3)));
    const auto opened = open(directory / "a.db");
    StoreState state;
    CHECK(ids_since(*opened.store, state).size() == 3);
    run_sql(directory / "a.db", "DELETE FROM mixture WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine).has_value());
    CHECK(ids_since(*opened.store, state) == std::vector<std::int64_t>{1, 3});
  }

  TEST_CASE("a row that vanished, was doubled or got another id is noticed") {
    for (const std::string change :
         {"DELETE FROM experience WHERE id = 3", "UPDATE experience SET id = 9 WHERE id = 3",
          "INSERT INTO experience SELECT 9, generation, cell, kind, content, components, key, "
          "checksum "
          "FROM experience WHERE id = 1",
          "UPDATE experience SET checksum = 5 WHERE id = 2", "DELETE FROM head",
          "INSERT INTO tombstone VALUES (1, 2, 1, '', '', 0)"}) {
      const TemporaryDirectory directory;
      Rng rng(45);
      REQUIRE(open_database(directory / "a.db").insert(random_rows(rng, 3)));
      run_sql(directory / "a.db", change);
      const auto opened = open(directory / "a.db");
      const auto changes = internal::read_changes(*opened.store, {}, RowParts::keys,
                                                  [](const auto&) { return Result<void>(); });
      INFO(change);
      REQUIRE(!changes.has_value());
      CHECK(changes.error().code == ErrorCode::corrupt);
    }
  }

  TEST_CASE("rows are listed by content and visited in that order, in several parts") {
    const TemporaryDirectory directory;
    Rng rng(23);
    const auto rows = random_rows(rng, 1203, 1);
    REQUIRE(open_database(directory / "a.db").insert(rows));
    const auto opened = open(directory / "a.db");
    const auto list = internal::list_by_content(*opened.store);
    REQUIRE(list.has_value());
    REQUIRE(list->size() == rows.size());
    std::size_t position = 0;
    REQUIRE(internal::visit_rows(*opened.store, opened.space, *list, [&](auto part) {
      for (const Experience& row : part) {
        CHECK(row.id == list->at(position).id);
        CHECK(internal::EncodedRow(row).content() == list->at(position).content);
        if (position > 0) CHECK(list->at(position - 1).content < list->at(position).content);
        ++position;
      }
      return Result<void>();
    }));
    CHECK(position == rows.size());
  }
}

}  // namespace mneme::test

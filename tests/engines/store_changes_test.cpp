// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"
#include "engines/open_store.h"
#include "store/store.h"
#include "upkeep/store_upkeep.h"

namespace mneme::test {
namespace {

using internal::RowParts;
using internal::StoreState;

internal::OpenedStore open(const std::string& path) {
  return require(internal::inspect_store(path));
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
    write_file(directory / "a.db", "");
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
    require(verify_database(directory / "a.db", VerifyMode::quarantine));
    CHECK(ids_since(*opened.store, state) == std::vector<std::int64_t>{1, 3});
  }

  TEST_CASE("a row that vanished, was doubled or got another id is noticed") {
    for (const std::string change :
         {"DELETE FROM experience WHERE id = 3", "UPDATE experience SET id = 9 WHERE id = 3",
          "INSERT INTO experience SELECT 9, generation, cell, kind, content, components, "
          "constraint_hash, key, checksum FROM experience WHERE id = 1",
          "UPDATE experience SET checksum = 5 WHERE id = 2", "DELETE FROM head",
          "INSERT INTO tombstone VALUES (1, 2, 1, '', '', 0)"}) {
      const TemporaryDirectory directory;
      Rng rng(45);
      REQUIRE(open_database(directory / "a.db").insert(random_rows(rng, 3)));
      run_sql(directory / "a.db", change);
      const auto opened = open(directory / "a.db");
      const Error error = require_error(internal::read_changes(
          *opened.store, {}, RowParts::keys, [](const auto&) { return Result<void>(); }));
      INFO(change);
      CHECK(error.code == ErrorCode::corrupt);
    }
  }

  TEST_CASE("rows are listed by content and visited in that order, in several parts") {
    const TemporaryDirectory directory;
    Rng rng(23);
    const auto rows = random_rows(rng, 1203, 1);
    REQUIRE(open_database(directory / "a.db").insert(rows));
    const auto opened = open(directory / "a.db");
    const auto list = require(internal::list_by_content(*opened.store));
    REQUIRE(list.size() == rows.size());
    std::size_t position = 0;
    REQUIRE(internal::visit_rows(*opened.store, opened.signature, list, [&](auto part) {
      for (const Experience& row : part) {
        CHECK(row.id == list.at(position).id);
        CHECK(internal::EncodedRow(row).content() == list.at(position).content);
        if (position > 0) CHECK(list.at(position - 1).content < list.at(position).content);
        ++position;
      }
      return Result<void>();
    }));
    CHECK(position == rows.size());
  }
}

namespace {

using internal::append_rows;
using internal::Duplicates;

std::unique_ptr<internal::Store> create_store(const std::string& path) {
  auto opened = require(internal::open_store_of(path, arm_signature(), OpenMode::create));
  return std::move(opened.store);
}

Experience with(Experience row, const std::string& time, const std::string& tool) {
  row.provenance.time = time;
  row.provenance.tool = tool;
  return row;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("appending gives ids in order and moves the head on") {
    const TemporaryDirectory directory;
    const auto store = create_store(directory / "a.db");
    Rng rng(11);
    const auto first = require(append_rows(*store, random_rows(rng, 3), Duplicates::keep_first));
    CHECK(first.ids == std::vector<std::int64_t>{1, 2, 3});
    CHECK(first.before == internal::StoreState{.epoch = first.before.epoch});
    CHECK(first.state.generation == 1);
    const auto second = append_rows(*store, random_rows(rng, 1), Duplicates::keep_first);
    CHECK(second->before == first.state);
    CHECK(second->state.last_row == 4);
    const auto nothing = append_rows(*store, {}, Duplicates::keep_first);
    CHECK(nothing->state == second->state);
  }

  TEST_CASE("of equal rows the first or the earliest stays, in whatever order they come") {
    Rng rng(12);
    const Experience row = random_experience(rng);
    const Experience early = with(row, "2020", "b");
    const Experience late = with(row, "2021", "a");
    const Experience early_tool = with(row, "2020", "a");
    for (const auto& order : std::vector<std::vector<Experience>>{
             {late, early, early_tool}, {early_tool, late, early}, {early, early_tool, late}}) {
      for (const bool is_one_batch : {false, true}) {
        const TemporaryDirectory directory;
        const auto store = create_store(directory / "a.db");
        if (is_one_batch) {
          REQUIRE(append_rows(*store, order, Duplicates::keep_earliest));
        } else {
          for (const Experience& one : order) {
            REQUIRE(append_rows(*store, std::span(&one, 1), Duplicates::keep_earliest));
          }
        }
        CHECK(verify_database(directory / "a.db")->empty());
        const Database database = open_database(directory / "a.db", OpenMode::read_only);
        REQUIRE(database.size() == 1);
        CHECK(is_same_content(*database.get(0), early_tool));
      }
    }
    const TemporaryDirectory directory;
    const auto store = create_store(directory / "a.db");
    REQUIRE(append_rows(*store, std::span(&late, 1), Duplicates::keep_first));
    const auto again = append_rows(*store, std::span(&early, 1), Duplicates::keep_first);
    CHECK(again->ids == std::vector<std::int64_t>{1});
    CHECK(again->is_new == std::vector<bool>{false});
  }

  TEST_CASE("compacting removes what was set aside and keeps the ids of the rest") {
    const TemporaryDirectory directory;
    const auto store = create_store(directory / "a.db");
    Rng rng(13);
    REQUIRE(append_rows(*store, random_rows(rng, 200), Duplicates::keep_first));
    std::vector<Damage> damages;
    for (std::int64_t id = 1; id <= 150; ++id) damages.push_back({id, "test"});
    REQUIRE(internal::quarantine_rows(*store, damages));
    const std::int64_t bytes = *store->bytes();
    CHECK(internal::compact_store(*store) == 150);
    CHECK(internal::compact_store(*store) == 0);
    CHECK(*store->bytes() < bytes);
    CHECK(verify_database(directory / "a.db")->empty());
    const Database database = open_database(directory / "a.db", OpenMode::read_only);
    REQUIRE(database.size() == 50);
    CHECK(database.get(0)->id == 151);
    const auto more = append_rows(*store, random_rows(rng, 1), Duplicates::keep_first);
    CHECK(more->ids == std::vector<std::int64_t>{201});
  }

  TEST_CASE("a batch beyond one part is still one transaction") {
    const TemporaryDirectory directory;
    const auto store = create_store(directory / "a.db");
    Rng rng(14);
    auto rows = random_rows(rng, 4100, 1);
    rows.back() = rows.front();
    const auto appended = require(append_rows(*store, rows, Duplicates::keep_first));
    CHECK(appended.state.generation == 1);
    CHECK(appended.state.row_count == 4099);
    CHECK(appended.ids.back() == 1);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("merged rows are counted as read, added and replaced") {
    const TemporaryDirectory directory;
    Rng rng(19);
    auto rows = random_rows(rng, 3);
    const auto target =
        internal::open_store_of(directory / "a.db", arm_signature(), OpenMode::create);
    MergeSummary summary;
    REQUIRE(internal::merge_rows(*target->store, std::span(rows).first(2), summary));
    rows[0].provenance.time = "1999";
    REQUIRE(internal::merge_rows(*target->store, rows, summary));
    CHECK(summary.read == 5);
    CHECK(summary.added == 3);
    CHECK(summary.replaced == 1);
  }

  TEST_CASE("an epoch follows that of the old head, and is new where that is lost") {
    StoreState head;
    head.epoch = 6;
    CHECK(internal::next_epoch(&head) == 7);
    const std::int64_t first = internal::next_epoch(nullptr);
    CHECK(first > std::int64_t{1} << 40);
    CHECK(internal::next_epoch(nullptr) >= first);
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store_writes.h"

#include "experience/fixtures.h"
#include "experience/open_store.h"

namespace mneme::test {
namespace {

using internal::append_rows;
using internal::Duplicates;

std::unique_ptr<internal::Store> create_store(const std::string& path) {
  auto opened = internal::open_store_of(path, arm_space(), OpenMode::create);
  REQUIRE(opened.has_value());
  return std::move(opened->store);
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
    const auto first = append_rows(*store, random_rows(rng, 3), Duplicates::keep_first);
    REQUIRE(first.has_value());
    CHECK(first->ids == std::vector<std::int64_t>{1, 2, 3});
    CHECK(first->before == internal::StoreState{});
    CHECK(first->state.generation == 1);
    const auto second = append_rows(*store, random_rows(rng, 1), Duplicates::keep_first);
    CHECK(second->before == first->state);
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
    std::vector<internal::Burial> burials;
    for (std::int64_t id = 1; id <= 150; ++id) burials.push_back({id, "test"});
    REQUIRE(internal::quarantine_rows(*store, burials));
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
    const auto appended = append_rows(*store, rows, Duplicates::keep_first);
    REQUIRE(appended.has_value());
    CHECK(appended->state.generation == 1);
    CHECK(appended->state.row_count == 4099);
    CHECK(appended->ids.back() == 1);
  }

  TEST_CASE("the current time is UTC in ISO 8601") {
    const std::string time = internal::current_time();
    REQUIRE(time.size() == 20);
    CHECK(time[10] == 'T');
    CHECK(time[19] == 'Z');
  }
}

}  // namespace mneme::test

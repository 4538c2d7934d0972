// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/sqlite_store.h"

#include "experience/fixtures.h"

namespace mneme::test {
namespace {

std::unique_ptr<internal::Store> open(const std::string& path, OpenMode mode) {
  auto store = internal::open_sqlite_store(path, mode);
  REQUIRE_MESSAGE(store.has_value(), (store ? "" : store.error().message));
  return std::move(*store);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("an empty store has no schema, no rows and no head") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    CHECK(store->schema_version() == 0);
    CHECK(store->name() == directory / "a.db");
    const auto transaction = store->begin(internal::Store::Kind::read);
    REQUIRE(transaction.has_value());
    CHECK((*transaction)->head() == internal::StoreState{});
    const auto read = (*transaction)->read_rows(0, internal::RowParts::all, [](const auto&) {
      return fail(ErrorCode::invalid, "no row");
    });
    CHECK(read.has_value());
  }

  TEST_CASE("a reader begins no writing transaction, and two writers do not share one") {
    const TemporaryDirectory directory;
    const auto first = open(directory / "a.db", OpenMode::create);
    REQUIRE(first->create(arm_space()));
    CHECK(first->schema_version() == 3);
    const auto reader = open(directory / "a.db", OpenMode::read_only);
    const auto refused = reader->begin(internal::Store::Kind::write);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().message.find("reading only") != std::string::npos);
    const auto writing = first->begin(internal::Store::Kind::write);
    REQUIRE(writing.has_value());
    CHECK(reader->begin(internal::Store::Kind::read).has_value());
  }

  TEST_CASE("a transaction that is not committed leaves nothing") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    REQUIRE(store->create(arm_space()));
    Rng rng(15);
    const Experience row = random_experience(rng);
    const internal::EncodedRow encoded(row);
    const auto stored = encoded.stored(1, 1);
    for (const bool is_committed : {false, true}) {
      {
        const auto writing = store->begin(internal::Store::Kind::write);
        REQUIRE((*writing)->add_rows(std::span(&stored, 1)));
        if (is_committed) REQUIRE((*writing)->commit());
      }
      int count = 0;
      const auto reading = store->begin(internal::Store::Kind::read);
      REQUIRE((*reading)->read_rows(0, internal::RowParts::all, [&](const auto&) {
        ++count;
        return Result<void>();
      }));
      CHECK(count == (is_committed ? 1 : 0));
    }
  }

  TEST_CASE("a sound file's structure has no damage") {
    const TemporaryDirectory directory;
    const auto store = open(directory / "a.db", OpenMode::create);
    REQUIRE(store->create(arm_space()));
    std::vector<Damage> damages;
    CHECK(store->check_structure(damages));
    CHECK(damages.empty());
    CHECK(store->reclaim());
    CHECK(*store->bytes() > 8192);
  }
}

}  // namespace mneme::test

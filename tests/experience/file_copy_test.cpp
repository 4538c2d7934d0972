// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/file_copy.h"

#include "experience/fixtures.h"

namespace mneme::test {

using internal::Connection;

TEST_SUITE("unit") {
  TEST_CASE("a copy holds what was committed by then, under a free name") {
    const TemporaryDirectory directory;
    Rng rng(18);
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert(random_rows(rng, 3)));
    auto source = Connection::open(directory / "a.db", Connection::Access::read_write);
    CHECK(internal::copy_beside(*source, directory / "a.db", "old") == directory / "a.db.old");
    CHECK(internal::copy_beside(*source, directory / "a.db", "old") == directory / "a.db.old.2");
    CHECK(open_database(directory / "a.db.old", OpenMode::read_only).size() == 3);
    CHECK(!std::filesystem::exists(directory / "a.db.old.unfinished"));
  }

  TEST_CASE("removing takes the logs along and does not mind what is missing") {
    const TemporaryDirectory directory;
    for (const char* suffix : {"", "-wal", "-shm"}) write_file(directory / "a.db" + suffix, "x");
    internal::remove_with_logs(directory / "a.db");
    CHECK(std::filesystem::is_empty(directory / ""));
  }
}

}  // namespace mneme::test

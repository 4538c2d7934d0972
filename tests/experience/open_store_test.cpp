// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/open_store.h"

#include "experience/fixtures.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a path opens SQLite, and the space is read or created") {
    const TemporaryDirectory directory;
    {
      const auto created =
          internal::open_store_of(directory / "a.db", arm_space(), OpenMode::create);
      REQUIRE(created.has_value());
      CHECK(created->schema_version == 3);
    }
    const auto seen = internal::inspect_store(directory / "a.db");
    REQUIRE(seen.has_value());
    CHECK(seen->space.robot_hash == arm_space().robot_hash);
    write_file(directory / "empty.db", "");
    CHECK(internal::inspect_store(directory / "empty.db")->schema_version == 0);
    const auto empty =
        internal::open_store_of(directory / "empty.db", arm_space(), OpenMode::read_only);
    CHECK(empty->space.joint_count == 3);
  }

  TEST_CASE("an engine that is unknown or not built in is named") {
    const auto unknown = internal::open_store("redis://host", OpenMode::read_only);
    REQUIRE(!unknown.has_value());
    CHECK(unknown.error().code == ErrorCode::unsupported);
    const auto server =
        internal::open_store("postgresql://me:secret@127.0.0.1:1/x", OpenMode::read_only);
    REQUIRE(!server.has_value());
    CHECK(server.error().message.find("secret") == std::string::npos);
#ifdef MNEME_HAS_POSTGRESQL
    CHECK(server.error().code == ErrorCode::io);
#else
    CHECK(server.error().code == ErrorCode::unsupported);
#endif
  }

  TEST_CASE("advice is given on damage only") {
    CHECK(internal::with_advice({ErrorCode::corrupt, "x"}, "a.db").message ==
          "x; `mneme db verify a.db` names all damage and saves what can be saved");
    CHECK(internal::with_advice({ErrorCode::io, "x"}, "a.db").message == "x");
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "engines/open_store.h"
#include "support/support.h"

namespace mneme::test {

using internal::Engine;
using internal::engine_of;
using internal::without_password;

TEST_SUITE("unit") {
  TEST_CASE("paths are SQLite's, URLs of PostgreSQL are its own, and others are refused") {
    for (const char* path :
         {"a.db", "/x/a.db", "./a b.db", "dir/postgresql", "1://x", "C:\\a.db"}) {
      CHECK(engine_of(path) == Engine::sqlite);
    }
    CHECK(engine_of("postgresql://host/x") == Engine::postgresql);
    CHECK(engine_of("postgres://") == Engine::postgresql);
    const Error error = require_error(engine_of("mysql://me:secret@host/x"));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'mysql'"));
    CHECK(!contains(error.message, "secret"));
  }

  TEST_CASE("a password is not shown, wherever it stands") {
    CHECK(without_password("postgresql://me:secret@host:5432/x?sslmode=require") ==
          "postgresql://me:***@host:5432/x?sslmode=require");
    CHECK(without_password("postgresql://host:5432/x") == "postgresql://host:5432/x");
    CHECK(without_password("postgresql://me@host/x?password=secret&sslpassword=other") ==
          "postgresql://me@host/x?password=***&sslpassword=***");
    CHECK(without_password("postgresql://me:se:cr@et@host/x") == "postgresql://me:***@host/x");
    CHECK(without_password("postgresql://me:se?cret@host/x") == "postgresql://me:***@host/x");
    CHECK(without_password("postgresql://host:5432?sslmode=require") ==
          "postgresql://host:5432?sslmode=require");
    CHECK(without_password("a.db") == "a.db");
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a path opens SQLite, and the space is read or created") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    {
      const auto created =
          internal::open_store_of(directory / "a.db", arm_signature(), OpenMode::create);
      REQUIRE(created.has_value());
      CHECK(created->schema_version == 4);
    }
    const auto seen = require(internal::inspect_store(directory / "a.db"));
    CHECK(seen.signature.model_hash == arm_signature().model_hash);
    write_file(directory / "empty.db", "");
    CHECK(internal::inspect_store(directory / "empty.db")->schema_version == 0);
    const auto empty =
        internal::open_store_of(directory / "empty.db", arm_signature(), OpenMode::read_only);
    CHECK(empty->signature.joint_count == 3);
  }

  TEST_CASE("an engine that is unknown or not built in is named") {
    const Error error = require_error(internal::open_store("redis://host", OpenMode::read_only));
    CHECK(error.code == ErrorCode::unsupported);
    const auto server =
        internal::open_store("postgresql://me:secret@127.0.0.1:1/x", OpenMode::read_only);
    REQUIRE(!server.has_value());
    CHECK(!contains(server.error().message, "secret"));
#ifdef MNEME_HAS_POSTGRESQL
    CHECK(server.error().code == ErrorCode::io);
#else
    CHECK(server.error().code == ErrorCode::unsupported);
#endif
  }

  TEST_CASE("advice is given on damage only") {
    CHECK(internal::with_advice({ErrorCode::corrupt, "x"}, "a.db").message ==
          "x; `mneme db verify a.db` lists the damage and what to do");
    CHECK(internal::with_advice({ErrorCode::io, "x"}, "a.db").message == "x");
  }
}

}  // namespace mneme::test

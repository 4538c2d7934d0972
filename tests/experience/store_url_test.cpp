// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store_url.h"

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
    const auto other = engine_of("mysql://me:secret@host/x");
    REQUIRE(!other.has_value());
    CHECK(other.error().code == ErrorCode::unsupported);
    CHECK(other.error().message.find("'mysql'") != std::string::npos);
    CHECK(other.error().message.find("secret") == std::string::npos);
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

}  // namespace mneme::test

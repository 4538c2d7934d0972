// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/postgres_connection.h"

#include "experience/postgres_server.h"

namespace mneme::test {

using internal::PostgresAnswer;
using internal::PostgresConnection;

TEST_SUITE("unit") {
  TEST_CASE("numbers, texts and bytes come back as they were sent") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->url());
    const auto answer = connection.query(
        "SELECT $1::bigint, $2::text, decode($3, 'hex'), NULL::text, -5::integer, true",
        {"-9223372036854775808", "'; DROP TABLE x; --", "00ff10"});
    REQUIRE(answer.has_value());
    CHECK(answer->row_count() == 1);
    CHECK(answer->integer(0, 0) == INT64_MIN);
    CHECK(answer->text(0, 1) == "'; DROP TABLE x; --");
    REQUIRE(answer->blob(0, 2).size() == 3);
    CHECK(answer->blob(0, 2)[1] == std::byte{0xff});
    CHECK(answer->is_null(0, 3));
    CHECK(answer->integer(0, 4) == -5);
    CHECK(answer->integer(0, 5) == 1);
  }

  TEST_CASE("rows are streamed until the visitor refuses one, and the connection goes on") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->url());
    std::int64_t sum = 0;
    const auto add = [&](const PostgresAnswer& row) -> Result<void> {
      sum += row.integer(0, 0);
      return sum < 100 ? Result<void>() : fail(ErrorCode::invalid, "enough");
    };
    CHECK(connection.stream("SELECT generate_series(1, $1::bigint)", {"10"}, add));
    CHECK(sum == 55);
    const auto refused = connection.stream("SELECT generate_series(1, 1000)", {}, add);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().message == "enough");
    CHECK(connection.query("SELECT 1").has_value());
  }

  TEST_CASE("what the server refuses is an error of its kind") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->url());
    const auto missing = connection.query("SELECT * FROM nothing");
    REQUIRE(!missing.has_value());
    CHECK(missing.error().code == ErrorCode::corrupt);
    CHECK(connection.last_state() == "42P01");
    CHECK(missing.error().message.find('\n') == std::string::npos);
    CHECK(connection.query("SELECT 1 / 0").error().code == ErrorCode::io);
    CHECK(connection.copy_in("COPY nothing FROM STDIN", "x").error().code == ErrorCode::corrupt);
    CHECK(connection.query("SELECT 1").has_value());
  }

  TEST_CASE("who cannot connect is told why, without the password") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    for (const std::string& url :
         {server->url() + "&user=nobody&password=secret",
          std::string("postgresql://me:secret@x?a=b"),
          server->url() + "&sslmode=verify-full&password=secret&hostaddr=127.0.0.1&port=1"}) {
      const auto refused = PostgresConnection::open(url);
      REQUIRE(!refused.has_value());
      CHECK(refused.error().code == ErrorCode::io);
      CHECK(refused.error().message.find("secret") == std::string::npos);
    }
  }
}

}  // namespace mneme::test

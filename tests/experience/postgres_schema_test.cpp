// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/postgres_schema.h"

#include "experience/postgres_server.h"

namespace mneme::test {

using internal::PostgresConnection;

TEST_SUITE("unit") {
  TEST_CASE("there is no schema before it is created, and creating it again changes nothing") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->new_url());
    CHECK(internal::read_postgres_version(connection) == 0);
    REQUIRE(internal::create_postgres_schema(connection, arm_space()));
    CHECK(internal::read_postgres_version(connection) == 3);
    ExperienceSpace other = arm_space();
    other.robot_name = "other";
    REQUIRE(internal::create_postgres_schema(connection, other));
    const auto space = internal::read_postgres_space(connection);
    REQUIRE(space.has_value());
    CHECK(space->robot_name == "arm");
    CHECK(space->joint_count == 3);
  }

  TEST_CASE("a newer or older schema is refused, and a changed space or head is damage") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->new_url());
    REQUIRE(internal::create_postgres_schema(connection, arm_space()));
    CHECK(internal::read_postgres_head(connection, false) == internal::StoreState{});
    const internal::StoreState state{1, 2, 3, 4, 5, -6, 7, -8};
    REQUIRE(internal::write_postgres_head(connection, state));
    CHECK(internal::read_postgres_head(connection, true) == state);
    REQUIRE(connection.query("UPDATE mneme_head SET epoch = 9"));
    CHECK(internal::read_postgres_head(connection, false).error().code == ErrorCode::corrupt);
    REQUIRE(connection.query("UPDATE mneme_space SET joint_count = 4"));
    CHECK(internal::read_postgres_space(connection).error().code == ErrorCode::corrupt);
    for (const char* other : {"9", "2"}) {
      REQUIRE(connection.query("UPDATE mneme_space SET schema_version = $1::integer", {other}));
      CHECK(internal::read_postgres_version(connection).error().code == ErrorCode::unsupported);
    }
    REQUIRE(connection.query("DELETE FROM mneme_space"));
    CHECK(internal::read_postgres_version(connection).error().code == ErrorCode::corrupt);
  }
}

}  // namespace mneme::test

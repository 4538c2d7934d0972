// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/postgres_server.h"

namespace mneme::test {
namespace {

std::string url_of(const PostgresServer& server, const std::string& options) {
  return fmt::format("postgresql://mneme@/postgres?hostaddr=127.0.0.1&port={}&{}", server.port(),
                     options);
}

std::string refusal(const std::string& url) {
  const auto database = Database::open(url, arm_space(), OpenMode::create);
  if (database) return "";
  CHECK(database.error().code == ErrorCode::io);
  return database.error().message;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a server is spoken with as securely as the URL demands") {
    const auto server = PostgresServer::start_with_tls();
    if (server == nullptr) {
      MESSAGE("skipped: PostgreSQL or openssl cannot be started here");
      return;
    }
    const std::string own = "&sslrootcert=" + server->certificate("server");
    const std::string strange = "&sslrootcert=" + server->certificate("stranger");
    Rng rng(7);
    const auto rows = random_rows(rng, 3);
    for (const std::string& options :
         {std::string("host=localhost&sslmode=require"), "host=localhost&sslmode=verify-ca" + own,
          "host=localhost&sslmode=verify-full" + own}) {
      const std::string url = url_of(*server, options);
      auto database = Database::open(url, arm_space(), OpenMode::create);
      REQUIRE_MESSAGE(database.has_value(), (database ? "" : database.error().message));
      REQUIRE(database->insert(rows).has_value());
      CHECK(find_like(*database, make_primitive(rows[1].key), 1e-9, 1)->size() == 1);
      const auto is_secure =
          connect_to(url).query("SELECT ssl::int FROM pg_stat_ssl WHERE pid = pg_backend_pid()");
      REQUIRE(is_secure.has_value());
      CHECK(is_secure->integer(0, 0) == 1);
    }
    const auto refused = [&](const std::string& options) {
      return refusal(url_of(*server, options));
    };
    CHECK(refused("host=localhost&sslmode=disable").find("no encryption") != std::string::npos);
    CHECK(refused("host=localhost&sslmode=verify-full" + strange).find("certificate") !=
          std::string::npos);
    CHECK(refused("host=another.example&sslmode=verify-full" + own).find("another.example") !=
          std::string::npos);
  }
}

}  // namespace mneme::test

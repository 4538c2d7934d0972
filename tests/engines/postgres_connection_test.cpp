// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/postgres_connection.h"
#include "engines/postgres_server.h"
#include "support/support.h"

#include <sys/un.h>
#include <array>
#include <chrono>
#include <cstring>
#include <thread>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("rows stand between a header and an end mark, numbers in big-endian order") {
    internal::BinaryCopy copy;
    const std::byte blob[] = {std::byte{7}};
    copy.row(3).add(std::int64_t{-2}).add(std::string_view("ab")).add(std::span(blob));
    const std::string expected =
        std::string("PGCOPY\n\377\r\n\0\0\0\0\0\0\0\0\0", 19) + std::string("\0\3", 2) +
        std::string("\0\0\0\10\377\377\377\377\377\377\377\376", 12) +
        std::string("\0\0\0\2ab", 6) + std::string("\0\0\0\1\7", 5) + "\377\377";
    CHECK(copy.finish() == expected);
  }
}

using internal::PostgresAnswer;
using internal::PostgresConnection;

namespace {

/// A server that lets one client in and then sends one byte of an answer every 20 ms, `most` of
/// them: the answer is longer.
class DrippingServer {
 public:
  explicit DrippingServer(int most) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = directory_ / ".s.PGSQL.5432";
    std::memcpy(address.sun_path, path.data(), path.size());
    REQUIRE(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(socket_, 1) == 0);
    thread_ = std::thread([this, most] { serve(most); });
  }
  DrippingServer(const DrippingServer&) = delete;
  DrippingServer& operator=(const DrippingServer&) = delete;
  ~DrippingServer() {
    thread_.join();
    ::close(socket_);
  }
  [[nodiscard]] std::string url() const {
    return "postgresql://mneme@/postgres?host=" + (directory_ / "");
  }

 private:
  void serve(int most) const {
    const int client = ::accept(socket_, nullptr, nullptr);
    std::array<char, 4096> request;
    const auto hear = [&] { (void)!::recv(client, request.data(), request.size(), 0); };
    const auto say = [&](std::string_view bytes) {
      return ::send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0;
    };
    hear();
    using namespace std::string_view_literals;
    say("R\0\0\0\10\0\0\0\0Z\0\0\0\5I"sv);  // welcome, and ready
    hear();
    say("T\0\1\0\0"sv);  // columns of 65 kB
    for (int i = 0; i < most && say("\1"sv); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ::close(client);
  }

  TemporaryDirectory directory_;
  int socket_;
  std::thread thread_;
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("single bytes of an answer do not prolong the wait for it") {
    const DrippingServer server(500);
    PostgresConnection connection =
        require(PostgresConnection::open(server.url(), {.answer_s = 0.2}));
    const Error error = require_error(connection.query("SELECT 1"));
    CHECK_MESSAGE(contains(error.message, "the server did not answer within 0.2 s"), error.message);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("numbers, texts and bytes come back as they were sent") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->url());
    const auto answer = require(connection.query(
        "SELECT $1::bigint, $2::text, decode($3, 'hex'), NULL::text, -5::integer, true",
        {"-9223372036854775808", "'; DROP TABLE x; --", "00ff10"}));
    CHECK(answer.row_count() == 1);
    CHECK(answer.integer(0, 0) == INT64_MIN);
    CHECK(answer.text(0, 1) == "'; DROP TABLE x; --");
    REQUIRE(answer.blob(0, 2).size() == 3);
    CHECK(answer.blob(0, 2)[1] == std::byte{0xff});
    CHECK(answer.is_null(0, 3));
    CHECK(answer.integer(0, 4) == -5);
    CHECK(answer.integer(0, 5) == 1);
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
    const Error refused =
        require_error(connection.stream("SELECT generate_series(1, 1000)", {}, add));
    CHECK(refused.message == "enough");
    CHECK(connection.query("SELECT 1").has_value());
  }

  TEST_CASE("what the server refuses is an error of its kind") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    PostgresConnection connection = connect_to(server->url());
    const Error error = require_error(connection.query("SELECT * FROM nothing"));
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(connection.last_state() == "42P01");
    CHECK(!contains(error.message, "\n"));
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
      const Error refused = require_error(PostgresConnection::open(url));
      CHECK(refused.code == ErrorCode::io);
      CHECK(!contains(refused.message, "secret"));
    }
  }
}

namespace {

std::string url_of(const PostgresServer& server, const std::string& options) {
  return fmt::format("postgresql://mneme@/postgres?hostaddr=127.0.0.1&port={}&{}", server.port(),
                     options);
}

std::string refusal(const std::string& url) {
  const auto database = Database::open(url, arm_signature(), OpenMode::create);
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
      auto database = require(Database::open(url, arm_signature(), OpenMode::create));
      require(database.insert(rows));
      CHECK(find_like(database, make_primitive(rows[1].key), 1e-9, 1)->size() == 1);
      const auto is_secure =
          connect_to(url).query("SELECT ssl::int FROM pg_stat_ssl WHERE pid = pg_backend_pid()");
      REQUIRE(is_secure.has_value());
      CHECK(is_secure->integer(0, 0) == 1);
    }
    const auto refused = [&](const std::string& options) {
      return refusal(url_of(*server, options));
    };
    CHECK(contains(refused("host=localhost&sslmode=disable"), "no encryption"));
    CHECK(contains(refused("host=localhost&sslmode=verify-full" + strange), "certificate"));
    CHECK(contains(refused("host=another.example&sslmode=verify-full" + own), "another.example"));
  }
}

}  // namespace mneme::test

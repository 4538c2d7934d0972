// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Heads of requests that are not taken, whatever the body.
#include "service/raw_client.h"
#include "service/request_reader.h"
#include "service/service_fixture.h"

#include <sys/resource.h>

namespace mneme::test {
namespace {

const std::string kPost =
    "POST /v1/plan HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n";
const std::string kGet = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n";
const std::string kHidden = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";

/// Connections that are kept open end soon, so that what is answered too often is told soon.
ServiceSettings impatient() {
  ServiceSettings settings;
  settings.idle_timeout_s = 1;
  return settings;
}

/// All that is heard on a connection of its own.
std::string heard_after(const RunningService& running, const std::string& said) {
  const RawClient client(running.port());
  static_cast<void>(client.offer(said));
  return client.hear();
}

/// Gives a reader more bytes. Returns its refusal.
std::optional<internal::Answer> read_all(internal::RequestReader& reader,
                                         boost::beast::flat_buffer& bytes, std::string_view more) {
  boost::asio::buffer_copy(bytes.prepare(more.size()),
                           boost::asio::buffer(more.data(), more.size()));
  bytes.commit(more.size());
  if (!reader.has_head()) {
    if (auto refused = reader.read_head(bytes)) return refused;
  }
  return reader.has_head() ? reader.read_body(bytes) : std::nullopt;
}

TEST_SUITE("unit") {
  TEST_CASE("a body of chunks is read to its end, however few bytes arrive at once") {
    const std::string head = kPost + "Transfer-Encoding: chunked\r\n\r\n";
    for (const auto& [sent, body] : {std::pair("0\r\n\r\n", ""), std::pair("0\r\nA: b\r\n\r\n", ""),
                                     std::pair("2\r\n{}\r\n0\r\n\r\n", "{}")}) {
      internal::RequestReader reader({.body_bytes = 100});
      boost::beast::flat_buffer bytes;
      const std::string chunks = sent;
      for (const char c : head + chunks) {
        CAPTURE(chunks);
        CHECK(!reader.is_done());
        boost::asio::buffer_copy(bytes.prepare(1), boost::asio::buffer(&c, 1));
        bytes.commit(1);
        CHECK(!(reader.has_head() ? reader.read_body(bytes) : reader.read_head(bytes)));
      }
      CHECK(reader.is_done());
      CHECK(reader.request().body() == body);
    }
  }

  TEST_CASE("extensions of chunks and trailers are limited as heads are, however they arrive") {
    const std::string head = kPost + "Transfer-Encoding: chunked\r\n\r\n";
    std::string many, trailers = "0\r\n";
    for (int i = 0; i < 100; ++i) {
      many += "1;a=" + std::string(1000, 'x') + "\r\n \r\n";
      trailers += "A: " + std::string(1000, 'x') + "\r\n";
    }
    for (const std::string& chunks :
         {many + "0\r\n\r\n", "1;a=" + std::string(100'000, 'x') + "\r\n \r\n0\r\n\r\n",
          trailers + "\r\n"}) {
      internal::RequestReader reader({.body_bytes = 1000});
      boost::beast::flat_buffer bytes;
      std::optional<internal::Answer> refused;
      std::string_view rest = chunks;
      CHECK(!read_all(reader, bytes, head));
      for (; !refused && !rest.empty();
           rest.remove_prefix(std::min<std::size_t>(900, rest.size()))) {
        refused = read_all(reader, bytes, rest.substr(0, 900));
        CHECK(bytes.size() < 70'000);
      }
      REQUIRE(refused);
      CHECK(refused->status == 431);
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("what may be a body or the next request is neither") {
    const RunningService running(impatient());
    const std::string length = fmt::format("Content-Length: {}\r\n", kHidden.size());
    const std::string chunked = "Transfer-Encoding: chunked\r\n";
    for (const std::string& head : {kGet + length,
                                    kGet + chunked,
                                    "OPTIONS /healthz HTTP/1.1\r\nHost: localhost\r\n" + length,
                                    "HEAD /healthz HTTP/1.1\r\nHost: localhost\r\n" + length,
                                    "DELETE /v1/scenes/a HTTP/1.1\r\nHost: localhost\r\n" + chunked,
                                    kPost + "Content-Length: 5\r\n" + chunked,
                                    kPost + chunked + chunked,
                                    kPost + "Content-Length: 0\r\n" + length,
                                    kPost + "Host: evil.com\r\n" + length,
                                    kPost + "Content-Length: abc\r\n",
                                    kPost + "Content-Length: +0\r\n",
                                    kPost + "Content-Length: 0x0\r\n",
                                    kPost + "Content-Length: 18446744073709551616\r\n",
                                    kPost + "Content-Length : 0\r\n" + length,
                                    kPost + "Content-Length: %33%38\r\n",
                                    kPost + "Content-Length: \r\n",
                                    kPost + length + length,
                                    kPost + "Content-Length: 38, 38\r\n",
                                    kPost + "Transfer-Encoding: %63hunked\r\n",
                                    kPost + "X: a\rb\r\n" + length,
                                    kPost + "X: a\nY: b\r\n" + length,
                                    kPost + "X: a\r\n b\r\n" + length,
                                    kPost + "X: a\r\n\tb\r\n" + length,
                                    kPost + "X: a" + std::string(1, '\0') + "\r\n" + length,
                                    "POST /v1/plan HTTP/1.0\r\nHost: localhost\r\n"
                                    "Content-Type: application/json\r\n" +
                                        chunked,
                                    kPost + "Transfer-Encoding: gzip, chunked\r\n",
                                    kPost + "Transfer-Encoding: identity\r\n",
                                    kPost}) {
      const std::string heard = heard_after(running, head + "\r\n" + kHidden);
      INFO(head, heard);
      CHECK(count_answers(heard) == 1);
      CHECK(heard.starts_with("HTTP/1.1 4"));
    }
    // The connection goes on after a sound request.
    const std::string heard = heard_after(
        running, kGet +
                     "Content-Length: 0\r\n\r\nDELETE /v1/scenes/a HTTP/1.1\r\nHost: localhost\r\n"
                     "Content-Length: 2\r\n\r\n{}");
    CHECK_MESSAGE(heard.starts_with("HTTP/1.1 200"), heard);
    CHECK_MESSAGE(contains(heard, "there is no scene"), heard);
  }

  TEST_CASE("the size of a chunk is hexadecimal digits and nothing else") {
    const RunningService running(impatient());
    const std::string chunked = "Transfer-Encoding: chunked\r\n";
    for (const char* chunk :
         {"0x2\r\n{}\r\n", "2g\r\n{}\r\n", "+2\r\n{}\r\n", "2\r\n{}", "2\n{}\n"}) {
      const std::string heard =
          heard_after(running, kPost + chunked + "\r\n" + chunk + "0\r\n\r\n" + kHidden);
      INFO(chunk, heard);
      CHECK(count_answers(heard) == 1);
      CHECK(heard.starts_with("HTTP/1.1 4"));
    }
  }

  TEST_CASE("lines of chunks and trailers that may be read in two ways are refused") {
    const RunningService running(impatient());
    const std::string chunked = "Transfer-Encoding: chunked\r\n";
    const std::string put = "PUT /v1/scenes/v HTTP/1.1\r\nHost: localhost\r\n" + chunked +
                            "Content-Type: application/json\r\n\r\n";
    for (const std::string& rest : {std::string("2;a=\"x\ny\"\r\n{}\r\n0\r\n\r\n"),
                                    "2;a=\"x" + std::string(1, '\0') + "y\"\r\n{}\r\n0\r\n\r\n",
                                    std::string("2\r\n{}\r\n0;a=\"x\ny\"\r\n\r\n"),
                                    std::string("2\r\n{}\r\n0\r\nA: b\r\n c\r\n\r\n"),
                                    std::string("2\r\n{}\r\n0\r\nA: b\r\nB: c\r\n\td\r\n\r\n")}) {
      const std::string heard = heard_after(running, put + rest + kHidden);
      INFO(rest, heard);
      CHECK(count_answers(heard) == 1);
      CHECK(heard.starts_with("HTTP/1.1 400"));
    }
    const std::string sound =
        heard_after(running, put + "2;a=\"x y\"\r\n{}\r\n0\r\nA: b\r\n\r\n" + kHidden);
    CHECK_MESSAGE(count_answers(sound) == 2, sound);
  }

  TEST_CASE("an answer is whole and sent once, whatever ranges of it a client wants") {
    const RunningService running;
    for (const char* ranges : {"0-,0-,0-,0-", "0-,0-,0-,5-1"}) {
      const auto answer = running.client()->Get(
          "/healthz", httplib::Headers{{"Range", std::string("bytes=") + ranges}});
      REQUIRE(bool(answer));
      CHECK(answer->status == 200);
      CHECK(Json::parse(answer->body)["status"] == "ok");
    }
  }

  TEST_CASE("a head has a limit of its own, a body the one that is set") {
    const RunningService running(impatient());
    std::string head = kGet;
    while (head.size() < 70000) head += "a: b\r\n";
    const std::string heard = heard_after(running, head + "\r\n");
    CHECK_MESSAGE(!contains(heard, "HTTP/1.1 2"), heard);
    Json body = question();
    body["name"] = std::string(1000000, 'n');
    CHECK(post(*running.client(), "/v1/plan", body).status == 200);
  }

  TEST_CASE("a page that gives its name this machine's address is not answered") {
    const auto status_of = [](const RunningService& running, const std::string& host) {
      return heard_after(running,
                         "GET /healthz HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n")
          .substr(9, 3);
    };
    const RunningService running;
    for (const char* host : {"localhost", "LocalHost:80", "127.0.0.1", "127.1.2.3:7890", "[::1]:80",
                             "localhost:65535"}) {
      CHECK_MESSAGE(status_of(running, host) == "200", host);
    }
    for (const char* host : {"evil.example",
                             "evil.example:7890",
                             "127.0.0.1.evil.example",
                             "localhost.evil",
                             "10.0.0.1",
                             "[::1%25eth0]",
                             "[::1%lo]:80",
                             "[::2]",
                             "[::1",
                             "[",
                             ":",
                             "http",
                             "",
                             "[::1].evil.example",
                             "127.0.0.1:80.evil",
                             "::1",
                             "localhost:",
                             "localhost:65536",
                             "localhost:99999999",
                             "localhost:+80"}) {
      CHECK_MESSAGE(status_of(running, host) == "403", host);
    }
    ServiceSettings settings;
    settings.token = "secret";
    CHECK(status_of(RunningService(settings), "robots.example") == "200");
  }

  TEST_CASE("a client of HTTP/1.0 is not invited to go on, which it would take for the answer") {
    const RunningService running(impatient());
    const std::string rest =
        "\r\nHost: localhost\r\nContent-Type: application/json\r\nExpect: 100-continue\r\n"
        "Content-Length: 2\r\n\r\n{}";
    for (const auto& [version, answers] : {std::pair("HTTP/1.0", 1), std::pair("HTTP/1.1", 2)}) {
      const std::string heard =
          heard_after(running, std::string("POST /v1/plan ") + version + rest);
      CHECK_MESSAGE(count_answers(heard) == answers, heard);
      CHECK(contains(heard, "100 Continue") == (answers == 2));
    }
  }

  TEST_CASE("a client of HTTP/1.0 keeps its connection if it wants to") {
    const RunningService running;
    const std::string old = "GET /healthz HTTP/1.0\r\nHost: localhost\r\n";
    const std::string heard =
        heard_after(running, old + "Connection: keep-alive\r\n\r\n" + old + "\r\n");
    CHECK_MESSAGE(count_answers(heard) == 2, heard);
    CHECK(contains(heard, "Connection: keep-alive"));
    CHECK(heard.find("Connection: keep-alive") == heard.rfind("Connection: keep-alive"));
  }

  TEST_CASE("a token is compared as it came") {
    ServiceSettings settings;
    settings.token = "a%41b";
    const RunningService running(settings);
    const auto status_of = [&](const std::string& authorization) {
      return heard_after(running,
                         "GET /metrics HTTP/1.1\r\nHost: x\r\nConnection: close\r\n"
                         "Authorization: " +
                             authorization + "\r\n\r\n")
          .substr(9, 3);
    };
    CHECK(status_of("Bearer a%41b") == "200");
    CHECK(status_of("bearer a%41b") == "200");
    for (const char* wrong : {"Bearer aAb", "Bearer a%41", "Bearer a%41bb", "Bearer", "a%41b"}) {
      CHECK_MESSAGE(status_of(wrong) == "401", wrong);
    }
  }

  TEST_CASE("browsers are told not to guess types, nor to frame pages") {
    const RunningService running;
    for (const char* path : {"/", "/healthz"}) {
      const auto answer = running.client()->Get(path);
      REQUIRE(bool(answer));
      CHECK(answer->get_header_value("X-Content-Type-Options") == "nosniff");
      CHECK(answer->get_header_value("X-Frame-Options") == "DENY");
      const std::string policy = answer->get_header_value("Content-Security-Policy");
      CHECK(contains(policy, "default-src 'none'"));
      CHECK((contains(policy, "script-src")) == (std::string(path) == "/"));
    }
  }

  TEST_CASE("JSON is known by the whole name of its type") {
    const RunningService running;
    const auto status_of = [&](const char* type) {
      return running.client()->Post("/v1/plan", question().dump(), type)->status;
    };
    CHECK(status_of("Application/JSON; charset=utf-8") == 200);
    for (const char* type : {"application/jsonx", "application/json5", "application/ json"}) {
      CHECK_MESSAGE(status_of(type) == 415, type);
    }
  }

  TEST_CASE("settings of a service that make no sense are refused") {
    const auto failure = [](auto member, auto value) {
      ServiceSettings settings = loopback();
      settings.*member = value;
      const auto started = Service::start(planar8(), nullptr, settings);
      return started ? "" : started.error().message;
    };
    CHECK(failure(&ServiceSettings::traces, 0) == "setting 'traces' is 0: expected 1 to 100000");
    CHECK(failure(&ServiceSettings::queue, -1).starts_with("setting 'queue'"));
    CHECK(failure(&ServiceSettings::connections, 0).starts_with("setting 'connections'"));
    CHECK(
        failure(&ServiceSettings::idle_timeout_s, -INFINITY).starts_with("setting 'idle-timeout'"));
    CHECK(failure(&ServiceSettings::refresh_s, std::nan("")).starts_with("setting 'refresh'"));
  }

  TEST_CASE("a machine without descriptors is told when the service starts") {
    const int lowest = ::socket(AF_INET, SOCK_STREAM, 0);
    close(lowest);
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_NOFILE, &before) == 0);
    // One for the socket, none for what wakes the service.
    const rlimit few{static_cast<rlim_t>(lowest) + 1, before.rlim_max};
    REQUIRE(setrlimit(RLIMIT_NOFILE, &few) == 0);
    const Error error = require_error(Service::start(planar8(), nullptr, loopback()));
    setrlimit(RLIMIT_NOFILE, &before);
    CHECK(error.code == ErrorCode::io);
    CHECK_MESSAGE(contains(error.message, "Too many open files"), error.message);
  }
}

}  // namespace
}  // namespace mneme::test

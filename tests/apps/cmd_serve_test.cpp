// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inputs.h"
#include "apps/run_program.h"
#include "support/write_lock.h"

#include <fmt/format.h>

#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>

namespace mneme::test {
namespace {

/// A client of a service at a socket file, connected once the service listens.
class SocketClient {
 public:
  explicit SocketClient(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::memcpy(address.sun_path, path.data(), path.size());
    const Stopwatch stopwatch;
    while (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      REQUIRE(stopwatch.elapsed_s() < 60);
    }
  }
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;
  ~SocketClient() { close(socket_); }

  void post(const std::string& path, const std::string& body) const {
    const std::string text = fmt::format(
        "POST {} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: {}\r\n\r\n{}",
        path, body.size(), body);
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t count = send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      REQUIRE(count > 0);
      sent += static_cast<std::size_t>(count);
    }
  }
  /// Reads until the text contains `end` or the service closes the connection.
  [[nodiscard]] std::string hear(const std::string& end) const {
    std::string text;
    char buffer[4096];
    while (!contains(text, end)) {
      const ssize_t count = recv(socket_, buffer, sizeof buffer, 0);
      if (count <= 0) break;
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  int socket_;
};

/// A plan in front of a large mesh, which takes long to read and to prepare.
std::string large_request() {
  std::string numbers = "0, 0, 9, 0, 1, 9, 1, 0, 9";
  for (int i = 0; i < 60000; ++i) {
    numbers += fmt::format(", {0}, 0, 9, {0}, 20, {1}, 20, {0}, 9", i % 200 * 0.1, 9 + i % 7);
  }
  return fmt::format(
      "{{\"start\": [0,0,0,0,0,0,0,0], \"goal\": [1,0,0,0,0,0,0,0], \"settings\": {{\"timeout\": "
      "50}}, \"obstacles\": [{{\"name\": \"m\", \"type\": \"mesh\", \"triangles\": [{}]}}]}}",
      numbers);
}

TEST_SUITE("unit") {
  TEST_CASE("rows that are lost at the end are told with a reason, also before any error") {
    CHECK(app::describe_lost_rows({.stored = 3}).empty());
    CHECK(app::describe_lost_rows({.waiting = 20}) ==
          "20 remembered rows were lost: the database had not stored them when the process ended");
    CHECK(app::describe_lost_rows({.waiting = 2, .lost = 3, .failure = "disk full"}) ==
          "5 remembered rows were lost: disk full");
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a problem of another robot is refused by its name") {
    if (run_program({"serve", "--help"}).exit_code != 0) return;
    const TemporaryDirectory files;
    write_file(files / "p.yaml",
               "robot: panda\nstart: [0, 0]\ngoal: [1, 1]\nscene: {obstacles: []}\n");
    check_bad_inputs({{{"serve", "--robot", "planar8", "--problem", files / "p.yaml"},
                       1,
                       {"p.yaml", "expected a start of 8 values", "got 2", "another robot"}}});
  }

  TEST_CASE("a note says that a problem's constraints do not hold for all requests") {
    if (run_program({"serve", "--help"}).exit_code != 0) return;
    const TemporaryDirectory files;
    const std::string problem =
        "robot: planar8\nstart: [0, 0, 0, 0, 0, 0, 0, 0]\ngoal: [1, 0, 0, 0, 0, 0, 0, 0]\n"
        "scene: {obstacles: []}\n";
    const std::string constraints = "constraints: [{link: link_8, up: [0, 0, 1], angle: 0.2}]\n";
    for (const bool is_constrained : {false, true}) {
      write_file(files / "p.yaml", problem + (is_constrained ? constraints : ""));
      // The database is opened after the problem is read: a directory is none.
      const ProgramRun run = run_program(
          {"serve", "--robot", "planar8", "--problem", files / "p.yaml", "--db", files / ""});
      CHECK(contains(run.err, "is a directory"));
      CHECK(contains(run.err, "its constraints hold for plans of the page only") == is_constrained);
    }
  }

  TEST_CASE("a token that no client could send is refused") {
    if (run_program({"serve", "--help"}).exit_code != 0) return;
    const TemporaryDirectory files;
    const std::string token = files / "token";
    for (const auto& [text, byte] :
         {std::pair(std::string("secret\0more\n", 12), "0x00 at position 6"),
          {"secret\rmore\r\n", "0x0d at position 6"},
          {"secret \n", "0x20 at position 6"},
          {"\x7f", "0x7f at position 0"}}) {
      write_file(token, text);
      // The database is opened after the token is read: a directory is none.
      check_bad_inputs({{{"serve", "--robot", "planar8", "--token-file", token, "--db", files / ""},
                         1,
                         {token, "a token that a header can hold", byte}}});
    }
    write_file(token, "se cret\r\nmore\n");
    check_bad_inputs({{{"serve", "--robot", "planar8", "--token-file", token, "--db", files / ""},
                       1,
                       {"is a directory"}}});
  }

  TEST_CASE("a service ends within a second of SIGTERM, whatever its requests are at") {
    if (run_program({"serve", "--help"}).exit_code != 0) return;
    const TemporaryDirectory files;
    const std::string socket = files / "s";
    RunningProgram program({"serve", "--robot", "planar8", "--listen", "unix:" + socket});
    const SocketClient client(socket);
    client.post("/v1/plan", large_request());
    const Stopwatch stopwatch;
    program.send(SIGTERM);
    const ProgramRun run = program.wait();
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    // A second is promised; a machine that runs other tests may be late.
    CHECK(stopwatch.elapsed_s() < 3);
    CHECK_FALSE(std::filesystem::exists(socket));
  }

  TEST_CASE("a service that is stopped with queued rows says how many it loses, and fails") {
    if (run_program({"serve", "--help"}).exit_code != 0) return;
    const TemporaryDirectory files;
    const std::string socket = files / "s", db = files / "m.db";
    RunningProgram program({"serve", "--robot", "planar8", "--listen", "unix:" + socket, "--db", db,
                            "--remember-after", "0", "--refresh", "0.01"});
    const SocketClient client(socket);
    const WriteLock lock(db);
    client.post("/v1/plan",
                R"({"start": [0,0,0,0,0,0,0,0], "goal": [1,0,0,0,0,0,0,0],
                    "circles": [[6,2.5,1.2]], "settings": {"timeout": 50, "kind": "paths"}})");
    const std::string heard = client.hear("\"queued\"");
    CHECK_MESSAGE(contains(heard, "\"queued\""), heard);
    program.send(SIGTERM);
    const ProgramRun run = program.wait();
    CHECK(run.exit_code == 1);
    CHECK_MESSAGE(contains(run.err, "remembered rows were lost: "), run.err);
  }
}

}  // namespace
}  // namespace mneme::test

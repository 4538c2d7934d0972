// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "service/raw_client.h"
#include "service/service_fixture.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <list>
#include <thread>

namespace mneme::test {
namespace {

std::string metrics(const RunningService& running) {
  return running.client()->Get("/metrics")->body;
}

bool has(const RunningService& running, const std::string& line) {
  return contains(metrics(running), line + "\n");
}

/// Waits for what must come, however slow the machine is.
bool comes_true(const std::function<bool()>& is_true) {
  for (int i = 0; i < 4000; ++i) {
    if (is_true()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

ServiceSettings one_thread(int queue) {
  ServiceSettings settings;
  settings.threads = 1;
  settings.queue = queue;
  return settings;
}

TEST_SUITE("flow") {
  TEST_CASE("once a client is gone its plan stops, and the next one has its turn") {
    const RunningService running(one_thread(1));
    {
      const RawClient leaving(running.port());
      leaving.post("/v1/plan", endless_question());
      const RawClient on_spare_thread(running.port());
      on_spare_thread.post("/v1/plan", endless_question());
      const RawClient waiting(running.port());
      waiting.post("/v1/plan", endless_question());
      REQUIRE(comes_true([&] { return has(running, "mneme_waiting 1"); }));
    }
    // The one that waited may have begun before it was seen to be gone.
    const std::string cancelled = "mneme_plans_total{status=\"cancelled\"} ";
    CHECK(comes_true([&] { return contains(metrics(running), cancelled); }));
    CHECK(post(*running.client(), "/v1/plan", question()).body["solved"] == true);
  }

  TEST_CASE("a full line sends clients away for a while") {
    const RunningService running(one_thread(0));
    std::list<RawClient> planning;
    Reply reply;
    // A check that came first has the only turn for a moment, and a plan is sent away.
    const auto is_busy = [&] {
      planning.emplace_back(running.port()).post("/v1/plan", endless_question());
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      reply = post(*running.client(), "/v1/check", {{"configurations", Json::array()}});
      return reply.status == 503;
    };
    REQUIRE(comes_true(is_busy));
    CHECK(reply.body["error"]["code"] == "busy");
    CHECK(reply.headers.find("Retry-After")->second == "1");
  }

  TEST_CASE("slow and silent clients are cut, and cost nobody else") {
    ServiceSettings settings = one_thread(4);
    settings.request_timeout_s = 0.3;
    settings.idle_timeout_s = 0.3;
    settings.connections = 5;
    const RunningService running(settings);
    const RawClient silent(running.port());
    const RawClient slow(running.port());
    slow.say("POST /v1/plan HTTP/1.1\r\nContent-Le");
    const RawClient half(running.port());
    half.say(
        "POST /v1/plan HTTP/1.1\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{");
    // On a slow machine this client may be too slow itself.
    CHECK(comes_true([&] {
      const auto reply = running.client()->Post("/v1/plan", question().dump(), "application/json");
      return reply && reply->status == 200;
    }));
    CHECK(silent.hear().empty());
    CHECK(!contains(slow.hear(), "200 OK"));
    CHECK(!contains(half.hear(), "200 OK"));
  }

  TEST_CASE("more connections than may be are told so") {
    ServiceSettings settings;
    settings.connections = 1;
    const RunningService running(settings);
    const RawClient first(running.port());
    first.say("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(contains(first.hear("uptime"), "200 OK"));
    const std::string told = RawClient(running.port()).hear();
    CHECK(contains(told, "503 Service Unavailable"));
    CHECK(contains(told, "too many connections: try again soon\"}}"));
  }

  TEST_CASE("noise is refused, and the service goes on") {
    const RunningService running;
    const std::string post_head = "POST /v1/plan HTTP/1.1\r\nContent-Type: application/json\r\n";
    for (const std::string& noise :
         {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string(100000, 'x'),
          "GET /" + std::string(9000, 'a') + " HTTP/1.1\r\n\r\n",
          post_head + "Content-Length: -1\r\n\r\n{}",
          post_head + "Transfer-Encoding: chunked\r\n\r\nzz\r\n"}) {
      const RawClient client(running.port());
      static_cast<void>(client.offer(noise + "\r\nConnection: close\r\n\r\n"));
      const std::string heard = client.hear();
      INFO(noise.substr(0, 100), " -> ", heard);
      CHECK(!contains(heard, "HTTP/1.1 2"));
      CHECK(count_answers(heard) <= 1);
    }
    CHECK(post(*running.client(), "/v1/plan", question()).status == 200);
  }

  TEST_CASE("what surrounds the chunks of a body has a limit, too") {
    const RunningService running;
    const std::string head =
        "POST /v1/plan HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Transfer-Encoding: chunked\r\n\r\n";
    for (const std::string& endless :
         {"2;" + std::string(1 << 20, 'x'), "0\r\nX: " + std::string(1 << 20, 'x')}) {
      const RawClient client(running.port());
      static_cast<void>(client.offer(head + endless));
      CHECK(client.hear().starts_with("HTTP/1.1 431"));
    }
  }

  TEST_CASE("a service that stops answers what runs as cancelled") {
    RunningService running(one_thread(4));
    const RawClient planning(running.port());
    planning.post("/v1/plan", endless_question());
    const RawClient on_spare_thread(running.port());
    on_spare_thread.post("/v1/plan", endless_question());
    const RawClient waiting(running.port());
    waiting.post("/v1/plan", endless_question());
    REQUIRE(comes_true([&] { return has(running, "mneme_waiting 1"); }));
    std::thread other_thread([&] { running.service.stop(); });
    running.service.stop();
    // Whichever came first, all has been answered when either returns.
    const std::string heard = planning.hear_now(), other = waiting.hear_now();
    other_thread.join();
    // Either may have come first, and the other one still have had its turn for a moment.
    CHECK(contains((heard + other), "\"status\": \"cancelled\""));
    CHECK(contains(heard, "\"cancelled\""));
    CHECK(contains(other, "\"cancelled\""));
    CHECK_FALSE(bool(running.client()->Get("/healthz")));
  }

  TEST_CASE("a socket file is for its owner, and is there as long as the service") {
    const TemporaryDirectory files;
    const std::string path = files / "socket";
    ServiceSettings settings;
    settings.listen = "unix:" + path;
    for (int round = 0; round < 2; ++round) {
      auto service = require(Service::start(planar8(), nullptr, settings));
      CHECK(service.address() == settings.listen);
      using std::filesystem::perms;
      CHECK((std::filesystem::status(path).permissions() &
             (perms::group_all | perms::others_all)) == perms::none);
      CHECK_FALSE(Service::start(planar8(), nullptr, settings).has_value());
      const RawClient client(path);
      client.say("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
      CHECK(contains(client.hear(), "\"status\":\"ok\""));
      service.stop();
      CHECK_FALSE(std::filesystem::exists(path));
    }
  }

  TEST_CASE("a socket file of somebody else is left alone") {
    const TemporaryDirectory files;
    const std::string path = files / "socket";
    ServiceSettings settings;
    settings.listen = "unix:" + path;
    SUBCASE("of a program whose line of clients is full") {
      const Listening listening(path);
      std::list<RawClient> waiting;
      while (waiting.empty() || waiting.back().is_connected()) {
        waiting.emplace_back(path, SOCK_NONBLOCK);
        REQUIRE(waiting.size() < 100);
      }
      CHECK(contains(require_error(Service::start(planar8(), nullptr, settings)).message,
                     "another program listens there"));
      CHECK(std::filesystem::exists(path));
    }
    SUBCASE("of a successor") {
      auto service = require(Service::start(planar8(), nullptr, settings));
      std::filesystem::rename(path, path + ".old");
      const Listening successor(path);
      service.stop();
      CHECK(std::filesystem::exists(path));
    }
  }
}

}  // namespace
}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/http_server.h"
#include "service/raw_client.h"

#include <algorithm>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

namespace mneme::test {
namespace {

using internal::Answer, internal::HttpRequest, internal::HttpServer;

int nice_of_thread() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

double cpu_time_of_thread_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Answers with the priority of its thread. A long request computes until that is low, or for long.
Answer compute(const HttpRequest& request) {
  const double begin_s = cpu_time_of_thread_s();
  const int before = nice_of_thread();
  constexpr int kLowest = 19;
  while (request.target() == "/long" && before < kLowest && nice_of_thread() == before &&
         cpu_time_of_thread_s() - begin_s < 10) {
  }
  return {200, fmt::format("nice {} {}.", before, nice_of_thread())};
}

TEST_SUITE("unit") {
  TEST_CASE("a request that computes for long goes on at low priority, and later ones do not") {
    HttpServer server(
        {[](const HttpRequest&) { return std::nullopt; },
         [](const HttpRequest& request, const auto&) { return compute(request); }, [](int) {}},
        {.connections = 8});
    require(server.start("127.0.0.1:0", false));
    const int port = std::stoi(server.address().substr(server.address().rfind(':') + 1));
    const int usual = nice_of_thread();
    const auto answer_to = [&](const std::string& target) {
      const RawClient client(port);
      client.say("GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
      const std::string heard = client.hear();
      return heard.substr(heard.find("nice"));
    };
    // More often than the server has threads.
    for (int i = 0; i < 12; ++i) {
      CHECK(answer_to("/long") == fmt::format("nice {} {}.", usual, std::min(usual + 10, 19)));
      CHECK(answer_to("/short") == fmt::format("nice {} {}.", usual, usual));
    }
  }
}

}  // namespace
}  // namespace mneme::test

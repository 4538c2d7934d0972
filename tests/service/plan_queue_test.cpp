// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace mneme::test {
namespace {

using internal::PlanQueue, internal::TurnRequest;

constexpr TurnRequest kLarge{.bytes = PlanQueue::kSmallBytes + 1};

void wait_until_waiting(const PlanQueue& queue, int count) {
  while (queue.waiting() != count) std::this_thread::yield();
}

TEST_SUITE("unit") {
  TEST_CASE("a turn of several threads waits for all of them, and no large request overtakes it") {
    PlanQueue queue(3, 10);
    std::atomic<bool> never = false;
    auto first = queue.wait_for_turn(never, {.threads = 2});
    REQUIRE(first.has_value());
    std::atomic<int> served = 0;
    std::jthread all([&] {
      const auto turn = queue.wait_for_turn(never, {.threads = 3});
      CHECK(served++ == 0);
    });
    wait_until_waiting(queue, 1);
    std::jthread one([&] {
      const auto turn = queue.wait_for_turn(never, kLarge);
      CHECK(served++ == 1);
    });
    wait_until_waiting(queue, 2);
    CHECK(served == 0);
    first.reset();
    all.join();
    one.join();
    CHECK(queue.wait_for_turn(never, {.threads = 3}).has_value());
  }

  TEST_CASE("large requests that hold all threads leave one more for small requests") {
    PlanQueue queue(2, 10);
    std::atomic<bool> never = false, leaves = false;
    const auto first = queue.wait_for_turn(never, kLarge);
    auto second = queue.wait_for_turn(never, kLarge);
    std::jthread third([&] { CHECK_FALSE(queue.wait_for_turn(leaves, kLarge).has_value()); });
    wait_until_waiting(queue, 1);
    CHECK(queue.wait_for_turn(never).has_value());
    const auto small = queue.wait_for_turn(never);  // the thread was given back
    CHECK(small.has_value());
    std::jthread other([&] { CHECK_FALSE(queue.wait_for_turn(leaves).has_value()); });
    wait_until_waiting(queue, 2);
    leaves = true;
  }

  TEST_CASE("requests wait in the order of the work that their bodies are") {
    PlanQueue queue(1, 10);
    std::atomic<bool> never = false;
    auto first = queue.wait_for_turn(never, kLarge);
    std::atomic<int> served = 0;
    std::vector<std::jthread> waiting;
    const auto add = [&](std::size_t bytes, int rank) {
      waiting.emplace_back([&, bytes, rank] {
        const auto turn = queue.wait_for_turn(never, {.bytes = bytes});
        CHECK(served++ == rank);
      });
      wait_until_waiting(queue, static_cast<int>(waiting.size()));
    };
    // An hour and a minute of reading, so that the time between the calls does not matter.
    constexpr std::size_t kMinute = std::size_t{60} * 10'000'000;
    add(60 * kMinute, 3);
    add(kMinute, 1);
    add(kMinute + kMinute / 2, 2);
    add(2 * PlanQueue::kSmallBytes, 0);
    first.reset();
  }

  TEST_CASE("requests that leave the queue let those behind pass") {
    PlanQueue queue(2, 10);
    std::atomic<bool> never = false, leaves = false;
    const auto first = queue.wait_for_turn(never, kLarge);
    std::jthread leaving(
        [&] { CHECK_FALSE(queue.wait_for_turn(leaves, {.threads = 2}).has_value()); });
    wait_until_waiting(queue, 1);
    std::jthread behind([&] { CHECK(queue.wait_for_turn(never, kLarge).has_value()); });
    wait_until_waiting(queue, 2);
    leaves = true;
    leaving.join();
    behind.join();
  }

  TEST_CASE("of those that run alone one runs at a time, and others overtake them") {
    PlanQueue queue(2, 10);
    std::atomic<bool> never = false;
    auto first = queue.wait_for_turn(never, {.is_alone = true});
    REQUIRE(first.has_value());
    std::jthread alone([&] { CHECK(queue.wait_for_turn(never, {.is_alone = true}).has_value()); });
    wait_until_waiting(queue, 1);
    CHECK(queue.wait_for_turn(never, kLarge).has_value());
    CHECK(queue.waiting() == 1);
    first.reset();
  }

  TEST_CASE("a full queue refuses requests") {
    PlanQueue queue(1, 0);
    std::atomic<bool> never = false;
    const auto first = queue.wait_for_turn(never);
    CHECK_FALSE(queue.wait_for_turn(never, kLarge).has_value());
    const auto second = queue.wait_for_turn(never);
    CHECK(second.has_value());
    CHECK_FALSE(queue.wait_for_turn(never).has_value());
  }
}

}  // namespace
}  // namespace mneme::test

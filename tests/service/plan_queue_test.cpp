// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

namespace mneme::test {
namespace {

using internal::PlanQueue;

void wait_until_waiting(const PlanQueue& queue, int count) {
  while (queue.waiting() != count) std::this_thread::yield();
}

TEST_SUITE("unit") {
  TEST_CASE("a turn of several threads waits for all of them, and nobody overtakes it") {
    PlanQueue queue(3, 10);
    std::atomic<bool> never = false;
    auto first = queue.wait_for_turn(never, 2);
    REQUIRE(first.has_value());
    std::atomic<int> served = 0;
    std::jthread all([&] {
      const auto turn = queue.wait_for_turn(never, 3);
      CHECK(served++ == 0);
    });
    wait_until_waiting(queue, 1);
    std::jthread one([&] {
      const auto turn = queue.wait_for_turn(never, 1);
      CHECK(served++ == 1);
    });
    wait_until_waiting(queue, 2);
    CHECK(served == 0);
    first.reset();
    all.join();
    one.join();
    CHECK(queue.wait_for_turn(never, 3).has_value());
  }

  TEST_CASE("who leaves the line lets those behind pass") {
    PlanQueue queue(2, 10);
    std::atomic<bool> never = false, leaves = false;
    const auto first = queue.wait_for_turn(never, 1);
    std::jthread leaving([&] { CHECK_FALSE(queue.wait_for_turn(leaves, 2).has_value()); });
    wait_until_waiting(queue, 1);
    std::jthread behind([&] { CHECK(queue.wait_for_turn(never, 1).has_value()); });
    wait_until_waiting(queue, 2);
    leaves = true;
    leaving.join();
    behind.join();
  }

  TEST_CASE("of those that run alone one runs at a time, and others overtake them") {
    PlanQueue queue(2, 10);
    std::atomic<bool> never = false;
    auto first = queue.wait_for_turn(never, 1, true);
    REQUIRE(first.has_value());
    std::jthread alone([&] { CHECK(queue.wait_for_turn(never, 1, true).has_value()); });
    wait_until_waiting(queue, 1);
    CHECK(queue.wait_for_turn(never).has_value());
    CHECK(queue.waiting() == 1);
    first.reset();
  }

  TEST_CASE("the line has an end") {
    PlanQueue queue(1, 0);
    std::atomic<bool> never = false;
    const auto first = queue.wait_for_turn(never);
    CHECK_FALSE(queue.wait_for_turn(never).has_value());
  }
}

}  // namespace
}  // namespace mneme::test

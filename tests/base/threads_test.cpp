// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/threads.h"
#include "support/no_threads.h"

#include <doctest/doctest.h>

#include <sched.h>
#include <sys/resource.h>
#include <algorithm>
#include <atomic>
#include <new>
#include <thread>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("as many threads do the work as are asked for") {
    std::atomic<int> calls = 0;
    for (const int count : {0, 1, 5}) {
      calls = 0;
      const auto size = static_cast<std::size_t>(count);
      CHECK(internal::Threads(size, [&] { ++calls; }).size() == size);
      CHECK(calls == count);
    }
  }

  TEST_CASE("threads that the system refuses are left out") {
    std::atomic<int> calls = 0;
    {
      const NoThreads none;
      CHECK(internal::Threads(3, [&] { ++calls; }).size() == 0);
    }
    CHECK(internal::Threads(3, [&] { ++calls; }).size() == 3);
    CHECK(calls == 3);
  }

  TEST_CASE("what ends a thread is thrown where the threads are joined, once all have ended") {
    std::atomic<int> calls = 0;
    internal::Threads threads(3, [&] {
      if (++calls == 2) throw std::bad_alloc();
    });
    CHECK_THROWS_AS(threads.join(), std::bad_alloc);
    CHECK(calls == 3);
    CHECK_NOTHROW(threads.join());
  }

  TEST_CASE("work in a scope that is over is interrupted, also in other threads") {
    std::atomic<bool> is_over = false;
    CHECK_NOTHROW(internal::poll_interrupt());
    {
      const InterruptScope scope([&] { return is_over.load(); });
      CHECK_NOTHROW(internal::poll_interrupt());
      const InterruptScope inner([] { return false; });
      is_over = true;
      CHECK_THROWS_AS(internal::poll_interrupt(), Interrupted);
      internal::Threads threads(2, [] { internal::poll_interrupt(); });
      CHECK_THROWS_AS(threads.join(), Interrupted);
      std::thread([] { CHECK_NOTHROW(internal::poll_interrupt()); }).join();
    }
    CHECK_NOTHROW(internal::poll_interrupt());
  }

#ifdef SCHED_BATCH
  TEST_CASE("a thread that gives way has a lower priority, others keep theirs") {
    const auto priority = [] { return getpriority(PRIO_PROCESS, 0); };
    const int before = priority();
    std::atomic<int> within = 0, policy = 0;
    internal::Threads(1, [&] {
      internal::give_way();
      within = priority();
      policy = sched_getscheduler(0);
    }).join();
    CHECK(policy == SCHED_BATCH);
    CHECK(within == std::max(before, 10));
    CHECK(priority() == before);
  }
#endif

  TEST_CASE("threads that are not joined keep what ended them") {
    CHECK_NOTHROW(internal::Threads(1, [] { throw std::bad_alloc(); }));
  }
}

}  // namespace mneme::test

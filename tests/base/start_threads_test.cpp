// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/start_threads.h"
#include "support/no_threads.h"

#include <doctest/doctest.h>

#include <atomic>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("as many threads do the work as are asked for") {
    std::atomic<int> calls = 0;
    for (const int count : {0, 1, 5}) {
      calls = 0;
      CHECK(internal::start_threads(static_cast<std::size_t>(count), [&] { ++calls; }).size() ==
            static_cast<std::size_t>(count));
      CHECK(calls == count);
    }
  }

  TEST_CASE("threads that the system refuses are left out") {
    std::atomic<int> calls = 0;
    {
      const NoThreads none;
      CHECK(internal::start_threads(3, [&] { ++calls; }).empty());
    }
    CHECK(internal::start_threads(3, [&] { ++calls; }).size() == 3);
    CHECK(calls == 3);
  }
}

}  // namespace mneme::test

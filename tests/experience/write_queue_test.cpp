// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "experience/write_queue.h"
#include "support/no_threads.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <new>
#include <thread>
#include <utility>

namespace mneme::test {
namespace {

using internal::WriteQueue;

constexpr double kSoon_s = 10;

void push(WriteQueue& queue, std::vector<Experience> rows) {
  const std::int64_t count = std::ssize(rows);
  queue.push(count, [rows = std::move(rows)] { return rows; });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows that wait are inserted together, in their order") {
    Rng rng(1);
    const auto rows = random_rows(rng, 30, 1);
    std::atomic<bool> is_open = false;
    std::vector<std::size_t> batches;
    std::vector<std::uint64_t> seeds;
    WriteQueue queue([&](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      while (!is_open) std::this_thread::yield();
      batches.push_back(batch.size());
      for (const Experience& row : batch) seeds.push_back(row.provenance.seed);
      return std::ssize(batch);
    });
    for (const Experience& row : rows) push(queue, {row});
    CHECK(!queue.flush(0));
    CHECK(queue.counts().waiting == 30);
    is_open = true;
    REQUIRE(queue.flush(kSoon_s));
    CHECK(batches.size() <= 3);
    REQUIRE(seeds.size() == 30);
    for (std::size_t i = 0; i < 30; ++i) CHECK(seeds[i] == rows[i].provenance.seed);
    CHECK(queue.counts().stored == 30);
    CHECK(queue.counts().failure.empty());
  }

  TEST_CASE("rows may be pushed while what a lot holds is freed") {
    Rng rng(5);
    const auto rows = random_rows(rng, 2, 1);
    WriteQueue queue([](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      return std::ssize(batch);
    });
    bool is_pushed = false;
    std::thread other;
    std::promise<void> pushed;
    std::shared_ptr<int> held(new int, [&](int* number) {
      delete number;
      other = std::thread([&] {
        push(queue, {rows[1]});
        pushed.set_value();
      });
      is_pushed = pushed.get_future().wait_for(std::chrono::duration<double>(kSoon_s)) ==
                  std::future_status::ready;
    });
    queue.push(1, [&rows, held = std::move(held)] { return std::vector{rows[0]}; });
    REQUIRE(queue.flush(kSoon_s));
    other.join();
    CHECK(is_pushed);
    CHECK(queue.counts().stored == 2);
  }

  TEST_CASE("rows are tried again after io errors, and lost after others, by number") {
    Rng rng(2);
    std::atomic<int> calls = 0;
    WriteQueue queue([&](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      const int call = ++calls;
      if (call == 1) return fail(ErrorCode::io, "away");
      if (call == 2) return std::ssize(batch);
      return fail(ErrorCode::corrupt, "damaged");
    });
    push(queue, random_rows(rng, 2, 1));
    while (calls == 0) std::this_thread::yield();
    REQUIRE(queue.flush(kSoon_s));
    CHECK(calls == 2);
    CHECK(queue.counts().stored == 2);
    push(queue, random_rows(rng, 3, 1));
    REQUIRE(queue.flush(kSoon_s));
    CHECK(queue.counts().lost == 3);
    CHECK(queue.counts().failure == "damaged");
  }

  TEST_CASE("a row that is refused loses no other row, and is not tried again") {
    Rng rng(6);
    auto rows = random_rows(rng, 7, 1);
    rows[4].kind.clear();
    std::atomic<bool> is_open = false;
    std::vector<std::uint64_t> seeds;
    bool is_away = true;
    WriteQueue queue([&](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      while (!is_open) std::this_thread::yield();
      if (std::ranges::any_of(batch, [](const Experience& row) { return row.kind.empty(); })) {
        return fail(ErrorCode::invalid, "no kind");
      }
      if (batch.front().provenance.seed == rows[5].provenance.seed &&
          std::exchange(is_away, false)) {
        return fail(ErrorCode::io, "away");
      }
      for (const Experience& row : batch) seeds.push_back(row.provenance.seed);
      return std::ssize(batch);
    });
    push(queue, rows);
    is_open = true;
    REQUIRE(queue.flush(kSoon_s));
    CHECK(queue.counts().stored == 6);
    CHECK(queue.counts().lost == 1);
    rows.erase(rows.begin() + 4);
    REQUIRE(seeds.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) CHECK(seeds[i] == rows[i].provenance.seed);
  }

  TEST_CASE("after rows were lost, no more rows are made than a transaction takes") {
    Rng rng(3);
    const Experience row = random_rows(rng, 1, 1).front();
    std::atomic<bool> is_open = false;
    // Used by the queue's thread alone.
    int made = 0, inserted = 0, most_ahead = 0;
    bool is_first = true;
    WriteQueue queue([&](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      while (!is_open) std::this_thread::yield();
      most_ahead = std::max(most_ahead, made - inserted);
      inserted += static_cast<int>(batch.size());
      if (std::exchange(is_first, false)) return fail(ErrorCode::corrupt, "damaged");
      return std::ssize(batch);
    });
    const auto push_one = [&] {
      queue.push(1, [&] {
        ++made;
        return std::vector{row};
      });
    };
    push_one();
    for (int i = 0; i < 3000; ++i) push_one();
    is_open = true;
    REQUIRE(queue.flush(kSoon_s));
    CHECK(queue.counts().stored + queue.counts().lost == 3001);
    CHECK(most_ahead <= 500);
  }

  TEST_CASE(
      "a lack of memory or of threads loses rows or tries again, and does not end the process") {
    Rng rng(4);
    std::atomic<int> calls = 0;
    WriteQueue queue([&](const std::vector<Experience>& batch) -> Result<std::int64_t> {
      if (++calls == 1) throw std::bad_alloc();
      return std::ssize(batch);
    });
    {
      const NoThreads none;
      push(queue, random_rows(rng, 2, 1));
      CHECK(queue.counts().lost == 2);
      CHECK(queue.counts().failure.starts_with("no thread to store rows"));
    }
    queue.push(1, []() -> Result<std::vector<Experience>> { throw std::bad_alloc(); });
    REQUIRE(queue.flush(kSoon_s));
    CHECK(queue.counts().lost == 3);
    push(queue, random_rows(rng, 3, 1));
    REQUIRE(queue.flush(kSoon_s));
    CHECK(calls == 2);
    CHECK(queue.counts().stored == 3);
  }

  TEST_CASE("a queue that is given up does not wait for rows that cannot be inserted") {
    Rng rng(3);
    const Stopwatch stopwatch;
    {
      WriteQueue queue([](const auto&) { return fail(ErrorCode::io, "away"); });
      push(queue, random_rows(rng, 1, 1));
      CHECK(!queue.flush(0.01));
      CHECK(queue.counts().waiting == 1);
    }
    CHECK(stopwatch.elapsed_s() < 5);
  }
}

}  // namespace mneme::test

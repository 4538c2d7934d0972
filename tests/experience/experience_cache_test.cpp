// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/experience_cache.h"

#include <thread>

namespace mneme::test {
namespace {

using internal::bytes_of;
using internal::ExperienceCache;
using internal::SharedExperience;

SharedExperience make_row(std::int64_t id, int components = 5) {
  Rng rng(81);
  Experience row = random_experience(rng, components);
  row.id = id;
  return std::make_shared<const Experience>(std::move(row));
}

void keep(ExperienceCache& cache, std::int64_t id) { cache.keep(std::vector{make_row(id)}); }

bool holds(ExperienceCache& cache, std::int64_t id) { return cache.find({&id, 1})[0] != nullptr; }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows come back in the order that was asked for, and nothing for those not here") {
    ExperienceCache cache(1 << 20);
    for (const std::int64_t id : {1, 2, 3}) keep(cache, id);
    const auto found = cache.find(std::vector<std::int64_t>{3, 9, 1});
    REQUIRE(found.size() == 3);
    CHECK(found[0]->id == 3);
    CHECK(found[1] == nullptr);
    CHECK(found[2]->id == 1);
    CHECK(!cache.is_full());
  }

  TEST_CASE("what was not asked for the longest time goes first") {
    ExperienceCache cache(3 * bytes_of(*make_row(1)));
    for (const std::int64_t id : {1, 2, 3}) keep(cache, id);
    CHECK(!cache.is_full());
    CHECK(holds(cache, 1));
    keep(cache, 4);
    CHECK(cache.is_full());
    CHECK(!holds(cache, 2));
    for (const std::int64_t id : {1, 3, 4}) CHECK(holds(cache, id));
  }

  TEST_CASE("without room nothing stays, and what was handed out is not touched") {
    ExperienceCache cache(0);
    const SharedExperience row = make_row(1);
    cache.keep(std::vector{row});
    CHECK(!holds(cache, 1));
    CHECK(row->sampler.component_count() == 5);
  }

  TEST_CASE("what is forgotten leaves room, and may come again") {
    ExperienceCache cache(2 * bytes_of(*make_row(1)));
    keep(cache, 1);
    keep(cache, 2);
    cache.forget(std::vector<std::int64_t>{1, 7});
    CHECK(!holds(cache, 1));
    keep(cache, 3);
    CHECK(holds(cache, 2));
    CHECK(!cache.is_full());
    keep(cache, 3);
    CHECK(!cache.is_full());
  }

  TEST_CASE("a row with more means takes more bytes") {
    CHECK(bytes_of(*make_row(1, 100)) - bytes_of(*make_row(1, 10)) >= 90 * 3 * 4);
  }
}

TEST_SUITE("law") {
  TEST_CASE("threads that keep, find and forget never see another row than they asked for") {
    ExperienceCache cache(20 * bytes_of(*make_row(1)));
    std::atomic<bool> is_sound = true;
    std::vector<std::jthread> threads;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      threads.emplace_back([&, seed] {
        Rng rng(seed);
        for (int i = 0; i < 2000; ++i) {
          const auto id = static_cast<std::int64_t>(rng.index(50));
          if (i % 7 == 0) cache.forget({&id, 1});
          const auto found = cache.find({&id, 1})[0];
          if (found == nullptr) keep(cache, id);
          if (found != nullptr && found->id != id) is_sound = false;
        }
      });
    }
    threads.clear();
    CHECK(is_sound);
  }
}

}  // namespace mneme::test

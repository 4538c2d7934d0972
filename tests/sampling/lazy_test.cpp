// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

#include <memory>

namespace mneme::test {
namespace {

struct Log {
  int starts = 0;
  int draws = 0;
  std::vector<std::uint64_t> seeds;
  std::vector<SampleSource> reported;
};

/// Gives its source as every value, and writes down what it is asked.
class LoggedSampler final : public Sampler {
 public:
  LoggedSampler(SampleSource source, Log& log) : source_(source), log_(log) {}

  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    ++log_.starts;
    log_.seeds.push_back(seed);
    return std::make_unique<Stream>(source_, log_);
  }

 private:
  class Stream final : public SampleStream {
   public:
    Stream(SampleSource source, Log& log) : source_(source), log_(log) {}
    SampleSource next(std::span<float> q) override {
      ++log_.draws;
      for (float& value : q) value = static_cast<float>(source_);
      return source_;
    }
    void report(SampleSource source, SampleOutcome) override { log_.reported.push_back(source); }

   private:
    SampleSource source_;
    Log& log_;
  };

  SampleSource source_;
  Log& log_;
};

/// A lazy sampler between two logged ones.
struct Fixture {
  Log first, rest;
  int made = 0;
  std::unique_ptr<Sampler> make(int count) {
    return make_lazy_sampler(std::make_shared<LoggedSampler>(-1, first), count, [this] {
      ++made;
      return std::make_shared<LoggedSampler>(5, rest);
    });
  }
};

TEST_SUITE("unit") {
  TEST_CASE("so many draws are from the first sampler, and all others from the rest") {
    for (const int count : {0, 1, 7}) {
      Fixture fixture;
      const auto sampler = fixture.make(count);
      const Samples samples = draw(*sampler, 2, 1, 20);
      for (int i = 0; i < 20; ++i) {
        const SampleSource expected = i < count ? -1 : 5;
        CHECK(samples.sources[static_cast<std::size_t>(i)] == expected);
        CHECK(samples.columns[1][static_cast<std::size_t>(i)] == expected);
      }
      CHECK(fixture.first.draws == count);
      CHECK(fixture.rest.draws == 20 - count);
      CHECK(fixture.made == 1);
    }
  }

  TEST_CASE("the rest is not made before it is drawn from") {
    Fixture fixture;
    const auto sampler = fixture.make(10);
    draw(*sampler, 2, 1, 10);
    CHECK(fixture.made == 0);
    draw(*sampler, 2, 1, 11);
    CHECK(fixture.made == 1);
  }

  TEST_CASE("the rest is made once for each stream") {
    Fixture fixture;
    const auto sampler = fixture.make(3);
    for (int stream = 1; stream <= 4; ++stream) {
      draw(*sampler, 2, static_cast<std::uint64_t>(stream), 50);
      CHECK(fixture.made == stream);
      CHECK(fixture.first.starts == stream);
      CHECK(fixture.rest.starts == stream);
    }
  }

  TEST_CASE("what becomes of a configuration is told to the sampler that is drawn from") {
    Fixture fixture;
    const auto sampler = fixture.make(1);
    const auto stream = sampler->start(1);
    std::vector<float> q(2);
    stream->report(stream->next(q), SampleOutcome::extended);
    CHECK(fixture.first.reported == std::vector<SampleSource>{-1});
    stream->report(stream->next(q), SampleOutcome::rejected);
    CHECK(fixture.rest.reported == std::vector<SampleSource>{5});
    CHECK(fixture.first.reported.size() == 1);
  }

  TEST_CASE("the first sampler is started with the stream's seed, the rest with another one") {
    Fixture fixture;
    const auto sampler = fixture.make(2);
    draw(*sampler, 2, 42, 3);
    CHECK(fixture.first.seeds == std::vector<std::uint64_t>{42});
    REQUIRE(fixture.rest.seeds.size() == 1);
    CHECK(fixture.rest.seeds[0] != 42);
  }

  TEST_CASE("a stream keeps the sampler that was made for it alone") {
    const Robot robot = all_kinds();
    const auto sampler = make_lazy_sampler(make_uniform_sampler(robot), 1, [&robot] {
      return std::shared_ptr<const Sampler>(make_uniform_sampler(robot));
    });
    CHECK(draw(*sampler, 3, 1, 1000).sources.back() == kUniformSource);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the seed decides the stream, before and after the change") {
    const Robot robot = all_kinds();
    const auto sampler = make_lazy_sampler(make_uniform_sampler(robot), 100, [&robot] {
      return std::shared_ptr<const Sampler>(make_halton_sampler(robot));
    });
    check_seeds(*sampler, 3);
    check_limits(*sampler, robot, 500);
    const Samples lazy = draw(*sampler, 3, 11, 100);
    CHECK(lazy.columns == draw(*make_uniform_sampler(robot), 3, 11, 100).columns);
  }
}

}  // namespace
}  // namespace mneme::test

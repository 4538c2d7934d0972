// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

#include <array>
#include <limits>
#include <memory>
#include <set>

namespace mneme::test {
namespace {

/// Records what its streams are asked.
class Recorder final : public Sampler {
 public:
  struct Log {
    std::vector<std::uint64_t> seeds;
    std::vector<SampleOutcome> outcomes;
  };
  Recorder(SampleSource source, std::shared_ptr<Log> log) : source_(source), log_(std::move(log)) {}
  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    log_->seeds.push_back(seed);
    return std::make_unique<Stream>(source_, log_);
  }

 private:
  class Stream final : public SampleStream {
   public:
    Stream(SampleSource source, std::shared_ptr<Log> log) : source_(source), log_(std::move(log)) {}
    SampleSource next(std::span<float> q) override {
      for (float& value : q) value = 0;
      return source_;
    }
    void report(SampleSource, SampleOutcome outcome) override { log_->outcomes.push_back(outcome); }

   private:
    SampleSource source_;
    std::shared_ptr<Log> log_;
  };
  SampleSource source_;
  std::shared_ptr<Log> log_;
};

std::shared_ptr<const Sampler> gaussian(const Robot& robot) {
  auto mixture = std::make_shared<GaussianMixture>();
  mixture->joint_count = 3;
  mixture->means = {0, 0, 1};
  mixture->sources = {5};
  return make_mixture_sampler(robot, mixture, 0.1);
}

std::unique_ptr<Sampler> mixed(double lambda) {
  const Robot robot = all_kinds();
  return make_mixed_sampler(lambda, gaussian(robot), make_uniform_sampler(robot));
}

double share_of(const std::vector<SampleSource>& sources, SampleSource source) {
  const auto count = std::count(sources.begin(), sources.end(), source);
  return static_cast<double>(count) / static_cast<double>(sources.size());
}

TEST_SUITE("unit") {
  TEST_CASE("the seed decides the mixed stream") {
    check_seeds(*mixed(0.5), 3);
    check_seeds(*mixed(1), 3);
  }

  TEST_CASE("with lambda 0 all samples are of the second source and with 1 all of the first") {
    for (const SampleSource source : draw(*mixed(0), 3, 1, 20000).sources)
      REQUIRE(source == kUniformSource);
    for (const SampleSource source : draw(*mixed(1), 3, 1, 20000).sources) REQUIRE(source == 5);
  }

  TEST_CASE("a report goes to the sampler that its source belongs to, in whatever order") {
    const auto first_log = std::make_shared<Recorder::Log>(),
               second_log = std::make_shared<Recorder::Log>();
    const auto sampler = make_mixed_sampler(0.5, std::make_shared<Recorder>(1, first_log),
                                            std::make_shared<Recorder>(2, second_log));
    const auto stream = sampler->start(3);
    stream->report(1, SampleOutcome::rejected);  // before any sample: nobody's
    CHECK(first_log->outcomes.empty());
    std::vector<float> q(1);
    std::size_t firsts = 0, seconds = 0;
    for (int batch = 0; batch < 25; ++batch) {
      std::array<SampleSource, 4> sources{};
      for (SampleSource& source : sources) source = stream->next(q);
      for (const SampleSource source : sources) {
        ++(source == 1 ? firsts : seconds);
        stream->report(source, source == 1 ? SampleOutcome::extended : SampleOutcome::connected);
      }
    }
    CHECK(firsts > 20);
    CHECK(seconds > 20);
    CHECK(first_log->outcomes == std::vector(firsts, SampleOutcome::extended));
    CHECK(second_log->outcomes == std::vector(seconds, SampleOutcome::connected));
  }

  TEST_CASE("a sampler may number its sources in any way") {
    const auto log = std::make_shared<Recorder::Log>();
    for (const SampleSource source : {std::numeric_limits<SampleSource>::min(), -2, 1 << 20,
                                      std::numeric_limits<SampleSource>::max()}) {
      const auto sampler = make_mixed_sampler(0.5, std::make_shared<Recorder>(source, log),
                                              std::make_shared<Recorder>(2, log));
      const auto stream = sampler->start(1);
      std::vector<float> q(1);
      for (int i = 0; i < 10; ++i) stream->report(stream->next(q), SampleOutcome::extended);
    }
    CHECK(log->outcomes.size() < 40);
  }

  TEST_CASE("the two sources are started with seeds of their own, different for each stream") {
    const auto log = std::make_shared<Recorder::Log>();
    const auto sampler = make_mixed_sampler(0.5, std::make_shared<Recorder>(1, log),
                                            std::make_shared<Recorder>(2, log));
    for (std::uint64_t seed = 0; seed < 100; ++seed) (void)sampler->start(seed);
    CHECK(std::set(log->seeds.begin(), log->seeds.end()).size() == 200);
  }

  TEST_CASE("a mixed sampler may be part of another") {
    const Robot robot = all_kinds();
    const auto sampler = make_mixed_sampler(0.5, mixed(0.5), make_halton_sampler(robot));
    CHECK(std::abs(share_of(draw(*sampler, 3, 4, 40000).sources, 5) - 0.25) < 0.012);
  }
}

TEST_SUITE("law") {
  TEST_CASE("mixed samples are within the limits") {
    check_limits(*mixed(0.5), all_kinds(), 20000);
  }

  TEST_CASE("the share of the first source is lambda") {
    constexpr int kCount = 100000;
    for (const double lambda : {0.01, 0.2, 0.5, 0.8, 0.99}) {
      const double share = share_of(draw(*mixed(lambda), 3, 6, kCount).sources, 5);
      CAPTURE(lambda);
      CHECK(std::abs(share - lambda) < 5 * std::sqrt(lambda * (1 - lambda) / kCount));
    }
  }

  TEST_CASE("a probability falls with the draws from its source, to its floor") {
    const Robot robot = all_kinds();
    const auto share_between = [&](const std::vector<SampleSource>& sources, int begin, int end) {
      return share_of({sources.begin() + begin, sources.begin() + end}, 5);
    };
    const auto sources =
        draw(*make_mixed_sampler({{gaussian(robot), 0.8, 0.2}}, make_uniform_sampler(robot)), 3, 9,
             200000)
            .sources;
    CHECK(share_between(sources, 0, 500) == doctest::Approx(0.75).epsilon(0.08));
    CHECK(share_between(sources, 30000, 200000) == doctest::Approx(0.2).epsilon(0.03));
    const auto soon =
        draw(*make_mixed_sampler({{gaussian(robot), 0.5, 0.02}}, make_uniform_sampler(robot)), 3, 9,
             200000)
            .sources;
    CHECK(share_between(soon, 0, 100) == doctest::Approx(0.48).epsilon(0.3));
    // The draws n among t solve n + n^2 / 1000 = t / 2.
    CHECK(share_of(soon, 5) == doctest::Approx(0.0475).epsilon(0.1));
    // A floor above lambda does not raise it.
    const auto low =
        draw(*make_mixed_sampler({{gaussian(robot), 0.3, 0.9}}, make_uniform_sampler(robot)), 3, 9,
             20000)
            .sources;
    CHECK(share_of(low, 5) == doctest::Approx(0.3).epsilon(0.05));
  }

  TEST_CASE("sources share, each with its own fall, and the rest is the rest") {
    const Robot robot = all_kinds();
    const auto log = std::make_shared<Recorder::Log>();
    const auto sampler = make_mixed_sampler(
        {{gaussian(robot), 0.4, 0.1}, {std::make_shared<Recorder>(7, log), 0.3, 0.3}},
        make_uniform_sampler(robot));
    const auto sources = draw(*sampler, 3, 10, 200000).sources;
    const std::vector<SampleSource> late(sources.begin() + 100000, sources.end());
    CHECK(share_of(late, 5) == doctest::Approx(0.1).epsilon(0.05));
    CHECK(share_of(late, 7) == doctest::Approx(0.3).epsilon(0.03));
    CHECK(share_of(late, kUniformSource) == doctest::Approx(0.6).epsilon(0.03));
  }

  TEST_CASE("beside walks they cost no more than a fiftieth and a smaller constant") {
    const Robot robot = all_kinds();
    const auto sampler =
        make_mixed_sampler({{gaussian(robot), 0.5, 0.02}}, make_uniform_sampler(robot));
    constexpr double kWanted = 300000;
    std::vector<float> q(3);
    double all = 0;
    const auto stream = sampler->start(4);
    for (int rest = 0; rest < kWanted; ++all) rest += stream->next(q) == kUniformSource ? 1 : 0;
    CHECK(all <= 1.021 * kWanted + 12001);
    // With the fall of a floor of 0.2 it would break.
    CHECK(all > 1.02 * kWanted);
  }

  TEST_CASE("draws that are worth nothing cost no more than a quarter and a constant") {
    const Robot robot = all_kinds();
    const auto sampler =
        make_mixed_sampler({{gaussian(robot), 0.8, 0.2}}, make_uniform_sampler(robot));
    constexpr int kSeeds = 20;
    for (const double wanted : {1.0, 100.0, 10000.0, 100000.0}) {
      double all = 0;
      for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        const auto stream = sampler->start(seed);
        std::vector<float> q(3);
        for (int rest = 0; rest < wanted; ++all) rest += stream->next(q) == kUniformSource ? 1 : 0;
      }
      CAPTURE(wanted);
      CHECK(all / kSeeds <= 1.25 * wanted + 15001);
      // It is no bound that anything would keep: with a lambda that stays it would break.
      if (wanted == 100000.0) CHECK(all / kSeeds > 1.25 * wanted);
    }
  }

  TEST_CASE("the choice of the source is independent from sample to sample") {
    const Samples samples = draw(*mixed(0.5), 3, 7, 100000);
    int changes = 0;
    for (std::size_t i = 1; i < samples.sources.size(); ++i) {
      changes += samples.sources[i] != samples.sources[i - 1] ? 1 : 0;
    }
    CHECK(std::abs(changes - 50000) < 800);
  }

  TEST_CASE("the stream of each source is the same whatever the other one and lambda are") {
    const Samples rare = draw(*mixed(0.2), 3, 8, 2000), frequent = draw(*mixed(0.8), 3, 8, 2000);
    for (const SampleSource source : {5, kUniformSource}) {
      const auto of_source = [&](const Samples& samples) {
        std::vector<double> values;
        for (std::size_t i = 0; i < samples.sources.size(); ++i) {
          if (samples.sources[i] == source) values.push_back(samples.columns[0][i]);
        }
        values.resize(300);
        return values;
      };
      CHECK(of_source(rare) == of_source(frequent));
    }
  }

  TEST_CASE("two sources of the same kind are independent of each other and of the choice") {
    const Robot robot = all_kinds();
    const auto sampler =
        make_mixed_sampler(0.5, make_uniform_sampler(robot), make_uniform_sampler(robot));
    // Where equal streams were mixed, every value would come twice.
    const Samples samples = draw(*sampler, 3, 9, 20000);
    const auto& values = samples.columns[0];
    CHECK(std::set(values.begin(), values.end()).size() > 19900);
    CHECK(chi_square(values, -kPi, kPi, 100) < 170);
  }

  TEST_CASE("the choice of a source does not favour any of its samples") {
    const Robot robot = all_kinds();
    const auto uniform = std::shared_ptr<const Sampler>(make_uniform_sampler(robot));
    // A choice by a source's own stream would show in the first samples of all seeds.
    for (const bool is_first : {true, false}) {
      const auto sampler = is_first ? make_mixed_sampler(0.5, uniform, gaussian(robot))
                                    : make_mixed_sampler(0.5, gaussian(robot), uniform);
      std::vector<double> values;
      std::vector<float> q(3);
      for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        if (sampler->start(seed)->next(q) == kUniformSource) values.push_back(q[0]);
      }
      CHECK(values.size() > 9500);
      CHECK(chi_square(values, -kPi, kPi, 50) < 95);
    }
  }
}

}  // namespace
}  // namespace mneme::test

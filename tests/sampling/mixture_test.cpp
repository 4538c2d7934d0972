// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sample_rows.h"

#include <memory>

namespace mneme::test {
namespace {

constexpr int kCount = 200000;

std::unique_ptr<Sampler> make_sampler(const Robot& robot, GaussianMixture mixture, double sigma,
                                      const Widening& widening = {}) {
  return make_mixture_sampler(robot, std::make_shared<const GaussianMixture>(std::move(mixture)),
                              sigma, widening);
}

Robot revolute3() {
  return joints_of({JointType::revolute, JointType::revolute, JointType::revolute});
}

/// Components that their sources tell apart: n of them at distances that sigma does not bridge.
GaussianMixture line_of(int components) {
  GaussianMixture mixture;
  mixture.joint_count = 3;
  for (int i = 0; i < components; ++i) {
    const float at = -1.5f + 2.0f * static_cast<float>(i) / static_cast<float>(components);
    mixture.means.insert(mixture.means.end(), {at, -at - 1, 1.2f + at / 10});
    mixture.sources.push_back(7 * i + 3);
  }
  return mixture;
}

/// The samples of one source.
Samples of_source(const Samples& all, SampleSource source) {
  Samples result;
  result.columns.resize(all.columns.size());
  for (std::size_t i = 0; i < all.sources.size(); ++i) {
    if (all.sources[i] != source) continue;
    for (std::size_t j = 0; j < all.columns.size(); ++j) {
      result.columns[j].push_back(all.columns[j][i]);
    }
  }
  return result;
}

TEST_SUITE("unit") {
  TEST_CASE("the seed decides the stream of a mixture") {
    check_seeds(*make_sampler(all_kinds(), line_of(4), 0.1), 3);
  }

  TEST_CASE("the number of components is that of the rows of means") {
    CHECK(line_of(5).component_count() == 5);
    CHECK(GaussianMixture{}.component_count() == 0);
  }

  TEST_CASE("without a spread, samples are the means") {
    GaussianMixture mixture = line_of(4);
    const Samples samples = draw(*make_sampler(all_kinds(), mixture, 0), 3, 1, 100);
    for (std::size_t i = 0; i < 100; ++i) {
      const auto component = static_cast<std::size_t>((samples.sources[i] - 3) / 7);
      for (std::size_t j = 0; j < 3; ++j) {
        REQUIRE(samples.columns[j][i] == mixture.means.at(3 * component + j));
      }
    }
  }

  TEST_CASE("without sources, all samples count for source 0") {
    GaussianMixture mixture = line_of(4);
    mixture.sources.clear();
    for (const SampleSource source :
         draw(*make_sampler(all_kinds(), mixture, 0.1), 3, 1, 100).sources) {
      CHECK(source == 0);
    }
  }

  TEST_CASE("a component has the factor that its row says, or none") {
    GaussianMixture mixture;
    CHECK(mixture.factor_count() == 0);
    mixture.joint_count = 2;
    mixture.means = {0, 0, 1, 1, 2, 2};
    CHECK(mixture.factor(2).empty());
    mixture.factor_rows = {1, -1, 0};
    mixture.factors = {1, 2, 3, 4, 5, 6};
    CHECK(mixture.factor_size() == 3);
    CHECK(mixture.factor_count() == 2);
    const auto values = [&](int component) {
      const std::span<const float> factor = mixture.factor(component);
      return std::vector<float>(factor.begin(), factor.end());
    };
    CHECK(values(0) == std::vector<float>{4, 5, 6});
    CHECK(values(1).empty());
    CHECK(values(2) == std::vector<float>{1, 2, 3});
    mixture.add_factor({});
    mixture.add_factor(std::vector<float>{7, 8, 9});
    CHECK(mixture.factor_rows == std::vector<int>{1, -1, 0, -1, 2});
    CHECK(values(3).empty());
    CHECK(values(4) == std::vector<float>{7, 8, 9});
  }

  TEST_CASE("a factor is as wide for a prismatic joint as it says") {
    GaussianMixture mixture;
    mixture.joint_count = 3;
    mixture.means = {0, -0.5f, 1.2f};
    mixture.factor_rows = {0};
    mixture.factors = {0.1f, 0, 0.1f, 0, 0, 0.1f};
    const Samples samples = draw(*make_sampler(all_kinds(), mixture, 0.3), 3, 25, 20000);
    for (const auto& column : samples.columns) {
      CHECK(covariance(column, column) == doctest::Approx(0.01).epsilon(0.05));
    }
  }

  TEST_CASE("with widening, only the first components are drawn from, and all of them in the end") {
    const auto farthest = [](const Widening& widening, int count) {
      SampleSource most = 0;
      for (const SampleSource source :
           draw(*make_sampler(all_kinds(), line_of(50), 0, widening), 3, 31, count).sources) {
        most = std::max(most, (source - 3) / 7);
      }
      return most;
    };
    CHECK(farthest({4, 0}, 2000) == 3);
    CHECK(farthest({1, 0}, 2000) == 0);
    CHECK(farthest({0.25, 0}, 2000) == 0);
    CHECK(farthest({4, 0.01}, 2000) == 22);
    CHECK(farthest({4, 1}, 5000) == 49);
    CHECK(farthest({1e9, 1e9}, 5000) == 49);
    CHECK(farthest({0, 0.01}, 5000) == 49);
  }

  TEST_CASE("means outside the limits are brought inside, as the kind of joint wants") {
    GaussianMixture mixture;
    mixture.joint_count = 3;
    mixture.means = {4, 4, 4};
    const Samples samples = draw(*make_sampler(all_kinds(), mixture, 0), 3, 1, 1);
    CHECK(samples.columns[0][0] == doctest::Approx(4 - 2 * kPi));
    CHECK(samples.columns[1][0] == 1.0);
    CHECK(samples.columns[2][0] == 2.0);
  }
}

TEST_SUITE("law") {
  TEST_CASE("samples of a mixture are within the limits, however wide it is") {
    check_limits(*make_sampler(all_kinds(), line_of(4), 0.3), all_kinds(), 20000);
    check_limits(*make_sampler(all_kinds(), line_of(4), 8.0), all_kinds(), 20000);
  }

  TEST_CASE("components are equally likely and have their means and the standard deviation sigma") {
    constexpr double kSigma = 0.05;
    const GaussianMixture mixture = line_of(5);
    const Samples all = draw(*make_sampler(all_kinds(), mixture, kSigma), 3, 21, kCount);
    for (int component = 0; component < 5; ++component) {
      const Samples samples = of_source(all, 7 * component + 3);
      const auto count = static_cast<double>(samples.columns[0].size());
      CAPTURE(component);
      CHECK(std::abs(count - kCount / 5.0) < 5 * std::sqrt(kCount * 0.2 * 0.8));
      for (std::size_t j = 0; j < 3; ++j) {
        const double expected = mixture.means.at(3 * static_cast<std::size_t>(component) + j);
        // The last joint is prismatic: half as many metres as radians.
        const double deviation = j == 2 ? 0.5 * kSigma : kSigma;
        CHECK(std::abs(mean(samples.columns[j]) - expected) < 5 * deviation / std::sqrt(count));
        CHECK(covariance(samples.columns[j], samples.columns[j]) ==
              doctest::Approx(deviation * deviation).epsilon(0.04));
      }
      CHECK(std::abs(correlation(samples.columns[0], samples.columns[1])) < 0.03);
      CHECK(std::abs(correlation(samples.columns[1], samples.columns[2])) < 0.03);
    }
  }

  TEST_CASE("the n-th draw is one of the first components, equally likely, that widening opens") {
    const Widening widening{3, 0.5};
    constexpr int kStreams = 20000, kDraws = 12, kComponents = 7;
    const auto sampler = make_sampler(all_kinds(), line_of(kComponents), 0, widening);
    std::vector<std::vector<int>> counts(kDraws, std::vector<int>(kComponents, 0));
    std::vector<float> q(3);
    for (int seed = 0; seed < kStreams; ++seed) {
      const auto stream = sampler->start(static_cast<std::uint64_t>(seed));
      for (auto& row : counts) ++row.at(static_cast<std::size_t>((stream->next(q) - 3) / 7));
    }
    for (int n = 0; n < kDraws; ++n) {
      const int open = std::min(kComponents, static_cast<int>(3 + 0.5 * n));
      for (int component = 0; component < kComponents; ++component) {
        const double p = component < open ? 1.0 / open : 0;
        const int count = counts[static_cast<std::size_t>(n)][static_cast<std::size_t>(component)];
        CAPTURE(n);
        CAPTURE(component);
        CHECK(std::abs(count - p * kStreams) <= 5 * std::sqrt(kStreams * p * (1 - p)));
      }
    }
  }

  TEST_CASE("a sample is normally distributed about its mean") {
    GaussianMixture mixture;
    mixture.joint_count = 3;
    mixture.means = {0, -0.5f, 1.2f};
    const Samples samples = draw(*make_sampler(all_kinds(), mixture, 0.1), 3, 22, kCount);
    std::vector<double> levels;  // uniform in [0, 1] if the samples are normal
    for (const double x : samples.columns[1])
      levels.push_back(0.5 * std::erfc(-(x + 0.5) / 0.1 / std::sqrt(2)));
    CHECK(chi_square(levels, 0, 1, 100) < 170);
  }

  TEST_CASE("components with a factor have its covariance and the others sigma") {
    GaussianMixture mixture;
    mixture.joint_count = 3;
    mixture.means = {-0.5f, -0.4f, -0.6f, 0, 0, 0, -0.5f, -0.5f, -0.5f};
    mixture.factor_rows = {1, -1, 0};
    mixture.factors = {0.02f, 0,     0.03f, 0,      0,     0.04f,   // row 0, diagonal
                       0.1f,  0.05f, 0.07f, -0.08f, 0.03f, 0.06f};  // row 1
    mixture.sources = {0, 1, 2};
    const Samples all = draw(*make_sampler(revolute3(), mixture, 0.09), 3, 23, kCount);
    Eigen::Matrix3d factor;
    factor << 0.1, 0, 0, 0.05, 0.07, 0, -0.08, 0.03, 0.06;
    const std::array<Eigen::Matrix3d, 3> expected = {
        factor * factor.transpose(), Eigen::Matrix3d::Identity() * 0.09 * 0.09,
        Eigen::Vector3d(0.02, 0.03, 0.04).cwiseAbs2().asDiagonal()};
    for (int component = 0; component < 3; ++component) {
      const Samples samples = of_source(all, component);
      const auto& covariances = expected.at(static_cast<std::size_t>(component));
      for (std::size_t i = 0; i < 3; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        const double center = mixture.means.at(3 * static_cast<std::size_t>(component) + i);
        CHECK(std::abs(mean(samples.columns[i]) - center) <
              5 * std::sqrt(covariances(row, row) / 66000));
        for (std::size_t j = 0; j < 3; ++j) {
          const auto column = static_cast<Eigen::Index>(j);
          const double scale = std::sqrt(covariances(row, row) * covariances(column, column));
          CAPTURE(component);
          CAPTURE(i);
          CAPTURE(j);
          CHECK(std::abs(covariance(samples.columns[i], samples.columns[j]) -
                         covariances(row, column)) < 0.025 * scale);
        }
      }
    }
  }

  TEST_CASE("a continuous joint wraps round where another one is cut off at its limit") {
    GaussianMixture mixture;
    mixture.joint_count = 3;
    mixture.means = {3.1f, 0.95f, 0.55f};
    const Samples samples = draw(*make_sampler(all_kinds(), mixture, 0.1), 3, 24, 50000);
    int beyond = 0, at_upper = 0, at_lower = 0;
    std::vector<double> unwrapped;
    for (std::size_t i = 0; i < 50000; ++i) {
      beyond += samples.columns[0][i] < 0 ? 1 : 0;
      at_upper += samples.columns[1][i] == 1 ? 1 : 0;
      at_lower += samples.columns[2][i] == 0.5 ? 1 : 0;
      unwrapped.push_back(std::remainder(samples.columns[0][i] - 3.1, 2 * kPi));
    }
    const auto expected = [](double deviations) {
      return 50000 * 0.5 * std::erfc(deviations / std::sqrt(2));
    };
    CHECK(std::abs(beyond - expected((kPi - 3.1) / 0.1)) < 550);
    CHECK(std::abs(at_upper - expected(0.5)) < 550);
    CHECK(std::abs(at_lower - expected(1.0)) < 550);
    CHECK(std::sqrt(covariance(unwrapped, unwrapped)) == doctest::Approx(0.1).epsilon(0.02));
  }
}

}  // namespace
}  // namespace mneme::test

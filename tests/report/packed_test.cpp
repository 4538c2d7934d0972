// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/packed.h"
#include "support/support.h"

#include <cmath>
#include <string>

namespace mneme::internal {
namespace {

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count & 255));
  }
  return bytes;
}

/// Numbers of `size` bytes, the lowest first.
std::vector<std::uint32_t> numbers(const std::string& text, std::size_t size) {
  const auto bytes = from_base64(text);
  std::vector<std::uint32_t> values;
  for (std::size_t i = 0; i + size <= bytes.size(); i += size) {
    std::uint32_t value = 0;
    for (std::size_t k = size; k-- > 0;) value = value << 8 | bytes[i + k];
    values.push_back(value);
  }
  return values;
}

std::vector<Vec3> points_of(const Packed& packed, std::size_t per_entry = 3) {
  const auto values = numbers(packed.data, 2);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + per_entry <= values.size(); i += per_entry)
    points.emplace_back(packed.low + packed.step * Vec3(values[i], values[i + 1], values[i + 2]));
  return points;
}

/// A ball of `rings` times `rings` quads, in two triangles each.
std::vector<Triangle> ball(int rings) {
  std::vector<Vec3> corners;
  for (int i = 0; i <= rings; ++i) {
    for (int k = 0; k < rings; ++k) {
      const double a = M_PI * i / rings, b = 2 * M_PI * k / rings;
      const double radius = i % rings == 0 ? 0 : std::sin(a);  // all corners at a pole are one
      corners.emplace_back(radius * std::cos(b), radius * std::sin(b), std::cos(a));
    }
  }
  const auto at = [&](int i, int k) {
    return corners[static_cast<std::size_t>(i * rings + k % rings)];
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < rings; ++k) {
      triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return triangles;
}

TEST_SUITE("unit") {
  TEST_CASE("Bytes are base64 as RFC 4648 has it") {
    const auto text = [](const std::string& plain) {
      return to_base64({reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size()});
    };
    CHECK(text("") == "");
    CHECK(text("f") == "Zg==");
    CHECK(text("fo") == "Zm8=");
    CHECK(text("foo") == "Zm9v");
    CHECK(text("foobar") == "Zm9vYmFy");
  }

  TEST_CASE("Points come back to within half a step, which is the longest extent in 16 bits") {
    Rng rng(3);
    std::vector<CloudPoint> points;
    for (int i = 0; i < 1000; ++i) {
      points.push_back({static_cast<float>(rng.uniform(-2, 3)), static_cast<float>(rng.uniform()),
                        static_cast<float>(rng.uniform(5, 6))});
    }
    const Packed packed = pack(points, 1000);
    CHECK(packed.count == 1000);
    CHECK(packed.step < 5.0 / 65535 * 1.001);
    const auto back = points_of(packed);
    REQUIRE(back.size() == points.size());
    for (std::size_t i = 0; i < back.size(); ++i) {
      const Vec3 p(points[i][0], points[i][1], points[i][2]);
      CHECK((back[i] - p).cwiseAbs().maxCoeff() <= 0.5001 * packed.step);
    }
  }

  TEST_CASE("Of too many points every so many-th is kept, and how many there are is told") {
    std::vector<CloudPoint> points;
    for (int i = 0; i < 1001; ++i) points.push_back({static_cast<float>(i), 0, 0});
    const Packed packed = pack(points, 100);
    CHECK(packed.count == 1001);
    const auto back = points_of(packed);
    CHECK(back.size() == 91);  // each eleventh
    CHECK(std::abs(back[1].x() - 11) < 0.02);
  }

  TEST_CASE("One point and equal points have a place") {
    for (const std::size_t count : {1, 5}) {
      const Packed packed = pack(std::vector<CloudPoint>(count, {1, 2, 3}), 10);
      const auto back = points_of(packed);
      REQUIRE(back.size() == count);
      CHECK((back[0] - Vec3(1, 2, 3)).norm() < 1e-6);
    }
  }

  TEST_CASE("Of too many cubes the largest are kept") {
    std::vector<Cube> cubes;
    for (int i = 0; i < 20; ++i) cubes.push_back({Vec3(i, 0, 0), i < 5 ? 0.4 : 0.1});
    const Packed packed = pack(cubes, 5);
    CHECK(packed.count == 20);
    const auto values = numbers(packed.data, 2);
    REQUIRE(values.size() == 20);
    for (std::size_t i = 3; i < values.size(); i += 4)
      CHECK(std::abs(values[i] * packed.step - 0.4) < packed.step);
  }

  TEST_CASE("Triangles share corners, and a fine surface is thinned but stays where it is") {
    const Packed whole = pack(ball(20), 10000);
    CHECK(whole.count == 800);
    CHECK(points_of(whole).size() == 382);               // 19 rings of 20, and the poles
    CHECK(numbers(whole.indices, 4).size() == 3 * 760);  // those at the poles have no area

    const Packed thin = pack(ball(100), 1000);
    CHECK(thin.count == 20000);
    const auto corners = points_of(thin);
    const auto indices = numbers(thin.indices, 4);
    CHECK(indices.size() <= 3 * 1000);
    CHECK(indices.size() > 3 * 300);
    for (const std::uint32_t index : indices) CHECK(index < corners.size());
    for (const Vec3& corner : corners) CHECK(std::abs(corner.norm() - 1) < 0.06);
  }
}

}  // namespace
}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/small_cvae.h"

#include <xxhash.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <limits>

namespace mneme::test {
namespace {

void check_refused(const std::string& path, ErrorCode code) {
  const Error error = require_error(internal::load_cvae(path));
  CHECK(error.code == code);
  CHECK(contains(error.message, path));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("weights survive the way to a file and back") {
    const TemporaryDirectory directory;
    const internal::CvaeWeights written = random_weights(planar8(), 1);
    require(internal::save_cvae(directory / "w", written));
    const auto read = require(internal::load_cvae(directory / "w"));
    CHECK(read.robot_hash == written.robot_hash);
    CHECK(read.cells == 6);
    CHECK(read.half_extent == 12);
    CHECK(read.image_layer == written.image_layer);
    CHECK(read.image_bias == written.image_bias);
    CHECK(read.latent_layer == written.latent_layer);
    CHECK(read.feature_layer == written.feature_layer);
    CHECK(read.ends_layer == written.ends_layer);
    CHECK(read.second_layer == written.second_layer);
    CHECK(read.output_bias == written.output_bias);
  }

  TEST_CASE("a file that is missing, cut, changed or of another kind is refused") {
    const TemporaryDirectory directory;
    const std::string path = directory / "w";
    check_refused(path, ErrorCode::io);
    require(internal::save_cvae(path, random_weights(planar8(), 1)));
    const std::string whole = read_file(path);
    for (const std::size_t size : {std::size_t{0}, std::size_t{20}, whole.size() - 1}) {
      write_file(path, whole.substr(0, size));
      check_refused(path, ErrorCode::corrupt);
    }
    for (const std::size_t at : {std::size_t{0}, std::size_t{13}, std::size_t{100}}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ 0x40);
      write_file(path, changed);
      check_refused(path, ErrorCode::corrupt);
    }
  }

  TEST_CASE("a file of another version is refused, with what to do") {
    const TemporaryDirectory directory;
    const std::string path = directory / "w";
    require(internal::save_cvae(path, random_weights(planar8(), 1)));
    std::string other = read_file(path);
    for (const char version : {'\x01', '\x03'}) {
      other[8] = version;
      write_file(path, other);
      check_refused(path, ErrorCode::unsupported);
      CHECK(contains(require_error(internal::load_cvae(path)).message, "train it anew"));
    }
  }

  TEST_CASE("what no training writes is neither read nor written") {
    const TemporaryDirectory directory;
    const std::string path = directory / "w";
    constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
    for (const double extent : {0.0, 1e-320, 1e308, std::numeric_limits<double>::quiet_NaN()}) {
      internal::CvaeWeights weights = random_weights(planar8(), 1);
      weights.half_extent = extent;
      CHECK(internal::save_cvae(path, weights).error().code == ErrorCode::invalid);
    }
    internal::CvaeWeights weights = random_weights(planar8(), 1);
    weights.output_bias.front() = kNoNumber;
    CHECK(internal::save_cvae(path, weights).error().code == ErrorCode::invalid);
    weights.output_bias.front() = 0.25f;
    require(internal::save_cvae(path, weights));
    std::string bytes = read_file(path);
    std::memcpy(bytes.data() + bytes.size() - 8 - 8 * sizeof(float), &kNoNumber, sizeof kNoNumber);
    const std::uint64_t checksum = XXH3_64bits(bytes.data(), bytes.size() - 8);
    std::memcpy(bytes.data() + bytes.size() - 8, &checksum, sizeof checksum);
    write_file(path, bytes);
    check_refused(path, ErrorCode::corrupt);
    CHECK(contains(require_error(internal::load_cvae(path)).message, "finite"));
  }

  TEST_CASE("weights are kept until their file is written anew, or another one is read") {
    const TemporaryDirectory directory;
    const std::string path = directory / "w";
    CHECK(require_error(internal::keep_cvae(path)).code == ErrorCode::io);
    require(internal::save_cvae(path, random_weights(planar8(), 1)));
    const auto first = require(internal::keep_cvae(path));
    CHECK(require(internal::keep_cvae(path)) == first);
    const auto time = std::filesystem::last_write_time(path);
    require(internal::save_cvae(path, random_weights(planar8(), 2)));
    std::filesystem::last_write_time(path, time + std::chrono::seconds(1));
    const auto second = require(internal::keep_cvae(path));
    CHECK(second->output_bias == random_weights(planar8(), 2).output_bias);
    CHECK(first->output_bias == random_weights(planar8(), 1).output_bias);
    require(internal::save_cvae(directory / "v", random_weights(planar8(), 3)));
    CHECK(require(internal::keep_cvae(directory / "v"))->output_bias != second->output_bias);
    std::filesystem::remove(path);
    CHECK(require_error(internal::keep_cvae(path)).code == ErrorCode::io);
  }

  TEST_CASE("weights whose sizes do not fit together, or without a place, are not written") {
    const TemporaryDirectory directory;
    internal::CvaeWeights weights = random_weights(planar8(), 1);
    CHECK(internal::save_cvae(directory / "none" + "/w", weights).error().code == ErrorCode::io);
    weights.ends_layer.pop_back();
    CHECK(internal::save_cvae(directory / "w", weights).error().code == ErrorCode::invalid);
  }
}

}  // namespace mneme::test

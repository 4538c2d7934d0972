// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/small_cvae.h"

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
    CHECK(read.latent_layer == written.latent_layer);
    CHECK(read.image_layer == written.image_layer);
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
    std::string newer = whole;
    newer[8] = 2;
    write_file(path, newer);
    check_refused(path, ErrorCode::unsupported);
  }

  TEST_CASE("weights whose sizes do not fit together, or without a place, are not written") {
    const TemporaryDirectory directory;
    internal::CvaeWeights weights = random_weights(planar8(), 1);
    CHECK(internal::save_cvae(directory / "none" + "/w", weights).error().code == ErrorCode::io);
    weights.output_bias.pop_back();
    CHECK(internal::save_cvae(directory / "w", weights).error().code == ErrorCode::invalid);
  }
}

}  // namespace mneme::test

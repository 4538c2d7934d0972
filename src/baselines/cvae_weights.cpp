// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/cvae_weights.h"

#include "base/fail.h"
#include "base/files.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>

static_assert(std::endian::native == std::endian::little);

namespace mneme::internal {
namespace {

constexpr std::string_view kMagic = "MNEMCVAE";
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHashSize = 16;
constexpr std::uint32_t kMostUnits = 4096;                   ///< limit on each dimension
constexpr double kLeastExtent = 1e-3, kLargestExtent = 1e6;  // metres

/// The first bytes of a file.
struct Header {
  std::array<char, 8> magic;
  std::uint32_t version, joints, latents, cells, hidden, reserved;
  double half_extent;
  std::array<char, kHashSize> robot_hash;
};
static_assert(sizeof(Header) == 56);

/// Visits the arrays in file order, each with its expected size.
template <class Weights, class Visitor>
void visit_arrays(Weights& w, Visitor&& visit) {
  const auto joints = static_cast<std::size_t>(w.joints);
  const auto latents = static_cast<std::size_t>(w.latents);
  const auto pixels = static_cast<std::size_t>(w.cells) * static_cast<std::size_t>(w.cells);
  const auto hidden = static_cast<std::size_t>(w.hidden);
  visit(w.image_layer, pixels * hidden);
  visit(w.image_bias, hidden);
  visit(w.latent_layer, hidden * latents);
  visit(w.feature_layer, hidden * hidden);
  visit(w.ends_layer, hidden * 2 * joints);
  visit(w.first_bias, hidden);
  visit(w.second_layer, hidden * hidden);
  visit(w.second_bias, hidden);
  visit(w.output_layer, joints * hidden);
  visit(w.output_bias, joints);
}

bool has_sane_sizes(const Header& header) {
  for (const std::uint32_t size : {header.joints, header.latents, header.cells, header.hidden}) {
    if (size == 0 || size > kMostUnits) return false;
  }
  return header.half_extent >= kLeastExtent && header.half_extent <= kLargestExtent;
}

bool has_finite_weights(const CvaeWeights& weights) {
  bool is_finite = true;
  visit_arrays(weights, [&](const std::vector<float>& array, std::size_t) {
    is_finite = is_finite && std::ranges::all_of(array, [](float w) { return std::isfinite(w); });
  });
  return is_finite;
}

CvaeWeights empty_weights(const Header& header) {
  CvaeWeights weights;
  weights.robot_hash.assign(header.robot_hash.data(), kHashSize);
  weights.joints = static_cast<int>(header.joints);
  weights.latents = static_cast<int>(header.latents);
  weights.cells = static_cast<int>(header.cells);
  weights.hidden = static_cast<int>(header.hidden);
  weights.half_extent = header.half_extent;
  return weights;
}

Result<CvaeWeights> parse(std::string_view bytes, const std::string& path) {
  const auto corrupt = [&](const char* what) {
    return fail(ErrorCode::corrupt, "'{}' is not a file of CVAE weights, or is damaged: {}", path,
                what);
  };
  Header header;
  if (bytes.size() < sizeof(Header) + sizeof(std::uint64_t))
    return corrupt("the file is too short");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::string_view(header.magic.data(), header.magic.size()) != kMagic) {
    return corrupt("the file does not start with MNEMCVAE");
  }
  if (header.version != kVersion) {
    return fail(ErrorCode::unsupported,
                "'{}' is of version {}, expected {}; train it anew with mneme_train_cvae", path,
                header.version, kVersion);
  }
  if (!has_sane_sizes(header)) return corrupt("the dimensions are out of range");
  CvaeWeights weights = empty_weights(header);
  std::size_t size = sizeof(Header) + sizeof(std::uint64_t);
  visit_arrays(weights, [&](auto&, std::size_t count) { size += count * sizeof(float); });
  if (bytes.size() != size) return corrupt("the file's length does not match its arrays");
  std::uint64_t checksum;
  const std::size_t end = size - sizeof checksum;
  std::memcpy(&checksum, bytes.data() + end, sizeof checksum);
  if (XXH3_64bits(bytes.data(), end) != checksum) return corrupt("the checksum is wrong");
  const char* next = bytes.data() + sizeof(Header);
  visit_arrays(weights, [&](std::vector<float>& array, std::size_t count) {
    array.resize(count);
    std::memcpy(array.data(), next, count * sizeof(float));
    next += count * sizeof(float);
  });
  if (!has_finite_weights(weights)) return corrupt("a weight is no finite number");
  return weights;
}

/// The weights of the file that was read last.
struct KeptWeights {
  std::mutex mutex;
  std::string path;
  std::filesystem::file_time_type time = {};  ///< of the last change before it was read
  std::uintmax_t size = 0;
  std::shared_ptr<const CvaeWeights> weights;
};

}  // namespace

Result<void> save_cvae(const std::string& path, const CvaeWeights& weights) {
  bool is_whole = weights.robot_hash.size() == kHashSize;
  visit_arrays(weights, [&](const auto& array, std::size_t size) {
    is_whole = is_whole && array.size() == size;
  });
  if (!is_whole)
    return fail(ErrorCode::invalid, "the arrays of the CVAE weights do not match its dimensions");
  Header header{};
  std::memcpy(header.magic.data(), kMagic.data(), kMagic.size());
  header.version = kVersion;
  header.joints = static_cast<std::uint32_t>(weights.joints);
  header.latents = static_cast<std::uint32_t>(weights.latents);
  header.cells = static_cast<std::uint32_t>(weights.cells);
  header.hidden = static_cast<std::uint32_t>(weights.hidden);
  header.half_extent = weights.half_extent;
  std::memcpy(header.robot_hash.data(), weights.robot_hash.data(), kHashSize);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  visit_arrays(weights, [&](const auto& array, std::size_t) {
    bytes.append(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(float));
  });
  const std::uint64_t checksum = XXH3_64bits(bytes.data(), bytes.size());
  bytes.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
  if (!has_sane_sizes(header) || !has_finite_weights(weights) || bytes.size() > kMaxFileBytes) {
    return fail(
        ErrorCode::invalid,
        "the CVAE could not be read again: {} bytes, expected at most {} and finite weights",
        bytes.size(), kMaxFileBytes);
  }
  auto file = MNEME_TRY(NewFile::create(path));
  MNEME_TRY(file.write(bytes));
  return file.finish();
}

Result<CvaeWeights> load_cvae(const std::string& path) {
  const auto bytes = read_text_file(path);
  if (bytes) return parse(*bytes, path);
  std::error_code failure;
  if (std::filesystem::exists(path, failure) || failure) return tl::unexpected(bytes.error());
  return fail(bytes.error().code, "{}; train it with mneme_train_cvae", bytes.error().message);
}

Result<std::shared_ptr<const CvaeWeights>> keep_cvae(const std::string& path) {
  static KeptWeights kept;
  const std::lock_guard lock(kept.mutex);
  std::error_code no_time, no_size;
  const auto time = std::filesystem::last_write_time(path, no_time);
  const auto size = std::filesystem::file_size(path, no_size);
  const bool is_same = kept.path == path && kept.time == time && kept.size == size;
  if (!no_time && !no_size && kept.weights != nullptr && is_same) return kept.weights;
  CvaeWeights weights = MNEME_TRY(load_cvae(path));
  kept.path = path;
  kept.time = time;
  kept.size = size;
  kept.weights = std::make_shared<const CvaeWeights>(std::move(weights));
  return kept.weights;
}

}  // namespace mneme::internal

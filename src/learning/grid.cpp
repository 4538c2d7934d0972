// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/learning.h"

#include "base/files.h"
#include "experience/key_index.h"
#include "store/row_check.h"
#include "input/input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mneme {
namespace {

/// Candidates per chosen primitive. More spread the primitives more evenly and take longer.
constexpr int kCandidates = 8;
/// The range is covered once this many random primitives in a row have a match.
constexpr int kCoveredInARow = 2000;

/// Nearest similarity errors to a growing set of keys.
class KeySet {
 public:
  explicit KeySet(std::size_t key_size) : index_(static_cast<int>(key_size)) {}

  void add(const PrimitiveKey& key) { index_.append({{index_.size()}, {0}, key}); }
  [[nodiscard]] double nearest_error(const PrimitiveKey& key) const {
    std::vector<PrimitiveKey> keys;
    for (KeyImage& image : memory_kinds().front()->images(key))
      keys.push_back(std::move(image.key));
    const auto matches = index_.find(keys, std::numeric_limits<double>::infinity(), 1);
    return matches.empty() ? std::numeric_limits<double>::infinity() : matches.front().error;
  }

 private:
  internal::ExperienceIndex index_;
};

bool is_base_outside(const PrimitiveKey& key) {
  return std::hypot(key[0], key[1]) > key[2] && std::hypot(key[3], key[4]) > key[5];
}

std::array<double, 2> read_range(const internal::Input& input) {
  const std::vector<double> values = input.finite_numbers(2, "a range [least, most]");
  if (!(values[0] > 0 && values[0] <= values[1] && values[1] <= internal::kMaxKeyMagnitude)) {
    input.fail(ErrorCode::parse, "expected 0 < least <= most <= 1e6 metres");
  }
  return {values[0], values[1]};
}

PrimitiveGrid read_grid(const internal::Input& input) {
  input.allow_keys({"radius", "gap", "distance", "max_similarity_error", "count"});
  PrimitiveGrid grid;
  grid.radius = read_range(input.at("radius"));
  grid.gap = read_range(input.at("gap"));
  grid.distance = read_range(input.at("distance"));
  if (const auto error = input.find("max_similarity_error")) {
    grid.max_similarity_error = error->positive_number();
  }
  if (const auto count = input.find("count")) {
    const double number = count->finite_number();
    if (number < 0 || number > 1e7 || number != static_cast<int>(number)) {
      count->fail_expecting("a whole number from 0 to 10000000");
    }
    grid.count = static_cast<int>(number);
  }
  return grid;
}

}  // namespace

Result<PrimitiveGrid> load_grid(const std::string& path) {
  return internal::without_throwing([&] {
    const std::string text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_yaml(text, path);
    return read_grid(internal::Input(value, path));
  });
}

PrimitiveKey sample_primitive(const PrimitiveGrid& grid, Rng& rng) {
  for (;;) {
    const double radius_a = rng.uniform(grid.radius[0], grid.radius[1]);
    const double radius_b = rng.uniform(grid.radius[0], grid.radius[1]);
    // Narrow gaps are harder, so they are sampled more often: the density falls linearly.
    const double gap = grid.gap[0] + (grid.gap[1] - grid.gap[0]) * (1 - std::sqrt(rng.uniform()));
    const double distance = rng.uniform(grid.distance[0], grid.distance[1]);
    const double tilt = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const double half = gap / 2;
    const double c = std::cos(tilt), s = std::sin(tilt);
    const PrimitiveKey circles = {
        distance + (half + radius_a) * c, (half + radius_a) * s,  radius_a,
        distance - (half + radius_b) * c, -(half + radius_b) * s, radius_b};
    if (is_base_outside(circles)) return make_primitive(circles).key;
  }
}

std::vector<PrimitiveKey> cover(const PrimitiveGrid& grid, std::uint64_t seed,
                                const std::atomic<bool>* cancel) {
  const auto is_cancelled = [&] { return cancel != nullptr && cancel->load(); };
  Rng rng(seed);
  std::vector<PrimitiveKey> keys = {sample_primitive(grid, rng)};
  KeySet chosen(keys.front().size());
  chosen.add(keys.front());
  while (static_cast<int>(keys.size()) < grid.count && !is_cancelled()) {
    PrimitiveKey best;
    double best_error = -1;
    for (int i = 0; i < kCandidates; ++i) {
      PrimitiveKey candidate = sample_primitive(grid, rng);
      const double error = chosen.nearest_error(candidate);
      if (error > best_error) {
        best_error = error;
        best = std::move(candidate);
      }
    }
    chosen.add(best);
    keys.push_back(std::move(best));
  }
  for (int covered = 0; covered < kCoveredInARow && !is_cancelled(); ++covered) {
    PrimitiveKey probe = sample_primitive(grid, rng);
    if (chosen.nearest_error(probe) < grid.max_similarity_error) continue;
    covered = -1;
    chosen.add(probe);
    keys.push_back(std::move(probe));
  }
  return keys;
}

Coverage measure_coverage(const PrimitiveGrid& grid, std::span<const PrimitiveKey> keys, int probes,
                          std::uint64_t seed) {
  Coverage coverage;
  coverage.probes = probes;
  if (keys.empty() || probes <= 0) return coverage;
  KeySet set(keys.front().size());
  for (const PrimitiveKey& key : keys) set.add(key);
  Rng rng(seed);
  std::vector<double> errors;
  for (int i = 0; i < probes; ++i) errors.push_back(set.nearest_error(sample_primitive(grid, rng)));
  std::sort(errors.begin(), errors.end());
  coverage.median = errors[errors.size() / 2];
  coverage.p95 = errors[errors.size() * 95 / 100];
  coverage.max = errors.back();
  return coverage;
}

}  // namespace mneme

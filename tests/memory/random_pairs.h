// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random pairs of circles and symmetries.
#pragma once

#include "support/support.h"

#include <numbers>

namespace mneme::test {

inline PrimitiveKey random_pair(Rng& rng) {
  PrimitiveKey key;
  for (int circle = 0; circle < 2; ++circle) {
    key.push_back(rng.uniform(-8, 8));
    key.push_back(rng.uniform(-8, 8));
    key.push_back(rng.uniform(0.5, 2));
  }
  return key;
}

inline PrimitiveKey swapped(const PrimitiveKey& key) {
  return {key[3], key[4], key[5], key[0], key[1], key[2]};
}

inline Symmetry random_symmetry(Rng& rng) {
  return {rng.uniform(-std::numbers::pi, std::numbers::pi), rng.index(2) == 1};
}

/// Largest difference between two keys, in any of their numbers.
inline double largest_difference(std::span<const double> a, std::span<const double> b) {
  REQUIRE(a.size() == b.size());
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
  return result;
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/primitive.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace mneme {
namespace {

double wrapped(double angle) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double result = angle - kTurn * std::floor((angle + std::numbers::pi) / kTurn);
  // The subtraction may round up to pi, which stands outside the half-open interval.
  return result < std::numbers::pi ? result : -std::numbers::pi;
}

}  // namespace

Symmetry inverse(const Symmetry& motion) {
  // A mirror image followed by a rotation is a reflection, which undoes itself.
  return motion.is_mirrored ? motion : Symmetry{wrapped(-motion.rotation), false};
}

Symmetry compose(const Symmetry& second, const Symmetry& first) {
  const double first_rotation = second.is_mirrored ? -first.rotation : first.rotation;
  return {wrapped(second.rotation + first_rotation), second.is_mirrored != first.is_mirrored};
}

Configuration moved_configuration(const Symmetry& motion, std::span<const double> q) {
  Configuration result(q.begin(), q.end());
  if (motion.is_mirrored) {
    for (double& value : result) value = -value;
  }
  if (!result.empty()) result[0] = wrapped(result[0] + motion.rotation);
  return result;
}

PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key) {
  assert(key.size() % 3 == 0);
  const double cosine = std::cos(motion.rotation);
  const double sine = std::sin(motion.rotation);
  PrimitiveKey result = key;
  for (std::size_t i = 0; i + 2 < key.size(); i += 3) {
    const double x = key[i];
    const double y = motion.is_mirrored ? -key[i + 1] : key[i + 1];
    result[i] = cosine * x - sine * y;
    result[i + 1] = sine * x + cosine * y;
  }
  return result;
}

}  // namespace mneme

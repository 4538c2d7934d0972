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
  const double rotation = motion.is_mirrored ? motion.rotation : wrapped(-motion.rotation);
  return {rotation, motion.is_mirrored, -motion.lift};
}

Symmetry compose(const Symmetry& second, const Symmetry& first) {
  const double first_rotation = second.is_mirrored ? -first.rotation : first.rotation;
  return {wrapped(second.rotation + first_rotation), second.is_mirrored != first.is_mirrored,
          second.lift + first.lift};
}

Configuration moved_configuration(const SymmetricJoints& joints, const Symmetry& motion,
                                  std::span<const double> q) {
  Configuration result(q.begin(), q.end());
  if (motion.is_mirrored) {
    for (double& value : result) value = -value;
  }
  if (joints.turn >= 0) {
    double& turn = result[static_cast<std::size_t>(joints.turn)];
    turn = wrapped(turn + motion.rotation);
  }
  if (joints.lift >= 0) result[static_cast<std::size_t>(joints.lift)] += motion.lift;
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

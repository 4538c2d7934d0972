// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Bodies of a robot: links that share a frame and a bounding ball.
#pragma once

#include "mneme/geometry.h"

#include <cstddef>
#include <vector>

namespace mneme::internal {

/// Links that share a bounding ball.
struct Body {
  int frame = 0;
  Sphere ball;
  std::vector<int> links;
};

/// Merges bodies of the same frame, always the two whose volume grows least (the first two of
/// equals), until each merger would make a ball sweep more. With more than `most` bodies, merges
/// them whatever their balls sweep. Cost: for n bodies n^2 pairs at first, then mostly some n each
/// merger. Throws Interrupted.
void merge_bodies(std::vector<Body>& bodies, std::size_t most);

}  // namespace mneme::internal

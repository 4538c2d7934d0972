// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/experience.h"

#include "training.h"

#include <cstdint>

namespace mneme::cvae {

struct LessonSettings {
  double cell = 0.1;  ///< Largest side of a pixel, metres.
  int queries = 20;   ///< Local queries per row.
  std::uint64_t seed = 1;
};

/// Examples from the rows of a database. A row and its mirror image are in the same set.
struct Lessons {
  int cells = 0;           ///< Pixels along a side of an image.
  double half_extent = 0;  ///< Metres from the middle of an image to its side: the arm's reach.
  Examples training;
  Examples held_out;     ///< Every tenth row's.
  int rows = 0;          ///< Rows with examples.
  int skipped_rows = 0;  ///< Rows without a solved query.
  int queries = 0;
  int solved_queries = 0;
};

/// Plans local queries among the circles of each row of the kind "pairs", from a mean in the gap to
/// a random configuration outside or back. Errors: a robot that is no planar arm; a database with
/// examples of fewer than two rows.
[[nodiscard]] Result<Lessons> make_lessons(const Robot& robot, const Database& database,
                                           const LessonSettings& settings);

}  // namespace mneme::cvae

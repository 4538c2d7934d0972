// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A problem of a planar arm and a memory of its scene.
#pragma once

#include "support/planar_memory.h"

namespace mneme::test {

struct LearnedScene {
  Problem problem = planar_problem("threaded_b4");
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", problem.robot);

  LearnedScene() {
    const auto primitives = require(decompose(memory_query(problem)));
    std::vector<PrimitiveKey> keys;
    for (const LocalPrimitive& primitive : primitives) keys.push_back(primitive.key);
    learn_into(database, problem.robot, keys);
  }
};

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

#include <cstdlib>
#include <sstream>

namespace mneme::test {
namespace {

std::string quoted(const std::string& text) { return "'" + text + "'"; }

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("the example of an OMPL program with memory prints a path") {
    const Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    {
      Database database = make_database(directory / "m.db", problem.robot);
      const auto primitives = require(decompose(memory_query(problem)));
      learn_into(database, problem.robot, {primitives.at(0).key});
    }
    const std::string command = quoted(MNEME_EXAMPLE) + " " +
                                quoted(source_file("scenes/planar/threaded_b4.yaml")) + " " +
                                quoted(directory / "m.db") + " > " + quoted(directory / "out");
    REQUIRE(std::system(command.c_str()) == 0);
    // OMPL's own log goes to the same place.
    std::istringstream lines(read_file(directory / "out"));
    int rows = 0;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream numbers(line);
      Configuration q;
      for (double value; numbers >> value;) q.push_back(value);
      rows += q.size() == 8 ? 1 : 0;
    }
    CHECK(rows >= 2);
  }
}

}  // namespace mneme::test

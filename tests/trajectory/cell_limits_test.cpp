// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"
#include "trajectory/cell_limits.h"

#include <cmath>
#include <vector>

namespace mneme::test {
namespace {

using internal::CellLimits;

struct Strip {
  double at_begin, at_end, bound;
};

struct Cell {
  double most_begin, most_end;
  std::vector<Strip> strips;

  [[nodiscard]] CellLimits limits() const {
    CellLimits result(most_begin, most_end);
    for (const Strip& s : strips) result.add(s.at_begin, s.at_end, s.bound);
    return result;
  }
  [[nodiscard]] bool allows(double begin, double end, double slack) const {
    if (begin < 0 || end < 0 || begin > most_begin + slack || end > most_end + slack) return false;
    return std::ranges::all_of(strips, [&](const Strip& s) {
      return std::abs(s.at_begin * begin + s.at_end * end) <= s.bound * (1 + slack) + slack;
    });
  }
};

Cell random_cell(Rng& rng) {
  Cell cell{rng.uniform(0.1, 3), rng.uniform(0.1, 3), {}};
  const auto count = 1 + rng.index(16);
  for (std::size_t i = 0; i < count; ++i) {
    // Some without one of the two, and pairs that nearly cancel, as on a short cell.
    double a = rng.uniform(-2, 2),
           b = rng.index(3) == 0 ? -a + rng.uniform(-0.1, 0.1) : rng.uniform(-2, 2);
    if (rng.index(10) == 0) a = 0;
    if (rng.index(10) == 0) b = 0;
    cell.strips.push_back({a, b, rng.uniform(0.01, 1)});
  }
  return cell;
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("no pair of a fine grid begins faster than the linear program says") {
    Rng rng(5);
    for (int i = 0; i < 400; ++i) {
      CAPTURE(i);
      const Cell cell = random_cell(rng);
      const double most_end = rng.index(4) == 0 ? 0.0 : rng.uniform(0, 3);
      const CellLimits::Pair best = cell.limits().greatest_begin(most_end);
      CHECK(cell.allows(best.begin, best.end, 1e-9));
      CHECK(best.end <= most_end);
      constexpr int kGrid = 120;
      double greatest = 0;
      for (int a = 0; a <= kGrid; ++a) {
        for (int b = 0; b <= kGrid; ++b) {
          const double begin = cell.most_begin * a / kGrid, end = most_end * b / kGrid;
          if (cell.allows(begin, end, 0)) greatest = std::max(greatest, begin);
        }
      }
      CHECK(best.begin >= greatest - 1e-9);
    }
  }

  TEST_CASE("the greatest end that goes with a begin is at the edge of what is allowed") {
    Rng rng(6);
    for (int i = 0; i < 2000; ++i) {
      CAPTURE(i);
      const Cell cell = random_cell(rng);
      const double most_end = rng.uniform(0, 3);
      const CellLimits limits = cell.limits();
      const double begin = rng.uniform() * limits.greatest_begin(most_end).begin;
      const double end = limits.greatest_end(begin, most_end);
      CHECK(cell.allows(begin, end, 1e-9));
      const double farther = end + 1e-6;
      CHECK((farther > most_end || !cell.allows(begin, farther, 0)));
    }
  }
}

}  // namespace mneme::test

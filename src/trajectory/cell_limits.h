// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Joint limits as limits of the squared path speeds at the ends of a cell.
#pragma once

#include <vector>

namespace mneme::internal {

/// A convex set of pairs (a, b), both >= 0, of squared path speeds at begin and end of a cell. It
/// contains (0, 0).
class CellLimits {
 public:
  /// Takes the greatest squared speeds at begin and end.
  CellLimits(double most_begin, double most_end) : most_begin_(most_begin), most_end_(most_end) {}
  /// Adds |at_begin a + at_end b| <= bound; `bound` is above 0.
  void add(double at_begin, double at_end, double bound);

  struct Pair {
    double begin = 0, end = 0;
  };
  /// Returns the pair with the greatest squared speed at the begin whose end is at most `most_end`:
  /// the linear program of the backward pass.
  [[nodiscard]] Pair greatest_begin(double most_end) const;
  /// Returns the greatest squared speed at the end, at most `most_end`, that is feasible with
  /// `begin`. Precondition: `begin` is feasible with some end.
  [[nodiscard]] double greatest_end(double begin, double most_end) const;

 private:
  struct Strip {
    double at_begin = 0, at_end = 0, bound = 0;
  };
  /// A bound on `begin` as a line over `end`.
  struct Line {
    double value = 0, slope = 0;
  };
  struct Range {
    Line least, most;
  };
  [[nodiscard]] Range begins(double end) const;
  [[nodiscard]] double shrink_to_feasible(double end) const;

  double most_begin_, most_end_;
  std::vector<Strip> strips_;
};

}  // namespace mneme::internal

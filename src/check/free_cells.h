// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Proofs that two links stay apart, kept per cell of the ranges of one or two joints.
#pragma once

#include "base/content_cache.h"
#include "check/round_body.h"
#include "check/solid_pair.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A part of a motion.
struct MotionShare {
  double first = 0, last = 1;
};

/// Cells of the ranges of one or two joints in which two links are proven to stay apart at all
/// values of the other joints between them. Where a cell has no proof, its halves along each joint
/// may have one. A cell is proven at its first use at the latest, by exact geometry with the
/// displacement within the cell as margin: what a cell says does not depend on its use.
/// Parallel-safe.
class FreeCells {
 public:
  /// The proofs that one or two joints allow: by exact geometry if only they are between the links;
  /// by what a link reaches that rolls at the end of the chain. Empty if more joints are between
  /// them.
  static std::vector<std::shared_ptr<const FreeCells>> make(const Robot& robot,
                                                            const LinkDistances& links, int first,
                                                            int second);

  /// `joints`: those that the chain has first. `round`: what the second link of the pair reaches
  /// while it rolls, instead of its geometry.
  FreeCells(const Robot& robot, SolidPair pair, const std::vector<int>& joints,
            std::shared_ptr<const RoundBody> round = nullptr);

  /// Returns the share of the motion around all of its cells without a proof; nothing if there are
  /// none. Within proven cells the links are at least kCellSpare metres apart.
  [[nodiscard]] std::optional<MotionShare> unproven(std::span<const float> from,
                                                    std::span<const float> delta,
                                                    MotionShare share) const;

  /// Proves all cells, or finds what was proven of the same links and joints in the cache. Throws
  /// Interrupted.
  void prove_all(const ContentCache& cache) const;

 private:
  static constexpr std::size_t kMostAxes = 2;

  struct Axis {
    int joint = 0;
    bool wraps = false;
    double lower = 0, size = 0;  ///< of the first of the smallest cells
    int bits = 0;                ///< The joint has 2^bits of them.
    double speed = 0;  ///< metres per unit that the joint moves points of one link, at most
  };
  /// Numbers of a smallest cell; of joints that wrap, in any turn.
  using Cell = std::array<std::int64_t, kMostAxes>;
  enum class Verdict : std::uint8_t { unknown, free, unproven };
  /// Values of the joints in a cell: from middle - half to middle + half.
  struct Ranges {
    std::array<double, kMostAxes> middle = {}, half = {};
  };

  void add_axis(const Robot& robot, int joint, double speed, int most_bits);
  [[nodiscard]] Cell cell_at(std::span<const float> from, std::span<const float> delta,
                             double share) const;
  [[nodiscard]] bool is_in_range(const Cell& cell) const;
  /// The share at which a motion is beyond the cell of 2^level smallest ones for each joint.
  [[nodiscard]] double end_of(const Cell& cell, int level, std::span<const float> from,
                              std::span<const float> delta) const;
  /// The level of the largest cell with a proof; -1 if there is none.
  [[nodiscard]] int free_level(const Cell& cell) const;
  [[nodiscard]] std::size_t index_of(const Cell& cell, int level) const;
  [[nodiscard]] Ranges ranges_of(const Cell& cell, int level) const;
  /// A hash of all that proofs depend on.
  [[nodiscard]] std::string key() const;
  [[nodiscard]] bool prove(const Ranges& cell) const;
  [[nodiscard]] bool prove_round(const Ranges& cell) const;

  SolidPair pair_;
  std::shared_ptr<const RoundBody> round_;
  int joint_count_;
  PointSpeeds speeds_;  ///< of the pair's first link, by the first joint
  std::vector<Axis> axes_;
  int top_ = 0;                         ///< level of the largest cells
  std::vector<std::size_t> of_levels_;  ///< index of the first cell of each level
  std::size_t count_ = 0;               ///< of cells of all levels
  std::unique_ptr<std::atomic<Verdict>[]> verdicts_;
};

/// Metres that proven cells keep links apart, at least.
inline constexpr double kCellSpare = 3e-4;

/// The cells of a robot's pairs of links, made at first use. Parallel-safe.
class FreeCellsOfPairs {
 public:
  using Cells = std::vector<std::shared_ptr<const FreeCells>>;
  const Cells& of(const Robot& robot, const LinkDistances& links, int first, int second);

 private:
  std::mutex mutex_;
  std::map<std::pair<int, int>, Cells> cells_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Proofs that two links stay apart, kept per cell of one joint's range.
#pragma once

#include "check/solid_pair.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

class RoundBody;

/// A part of a motion.
struct MotionShare {
  double first = 0, last = 1;
};

/// Cells of one joint's range in which two links are proven to stay apart at all values of the
/// other joints between them. A cell is proven at its first use, by exact geometry at its middle
/// with the displacement within the cell as margin: what a cell says does not depend on its use.
/// Parallel-safe.
class FreeCells {
 public:
  /// The proofs that one joint allows: by exact geometry if only that joint is between the links;
  /// by what a link reaches that rolls at the end of the chain. Empty if more
  /// joints are between them.
  static std::vector<std::shared_ptr<const FreeCells>> make(const Robot& robot,
                                                            const LinkDistances& links, int first,
                                                            int second);

  /// `round`: what the second link of the pair reaches while it rolls, instead of its geometry.
  FreeCells(const Robot& robot, SolidPair pair, int joint,
            std::shared_ptr<const RoundBody> round = nullptr);

  /// Returns the share of the motion around all of its cells without a proof; nothing if there are
  /// none. Within proven cells the links are at least kCellSpare metres apart.
  [[nodiscard]] std::optional<MotionShare> unproven(std::span<const float> from,
                                                    std::span<const float> delta,
                                                    MotionShare share) const;

 private:
  enum class Cell : std::uint8_t { unknown, free, unproven };

  [[nodiscard]] bool is_free(std::int64_t index) const;
  [[nodiscard]] bool prove(std::int64_t index) const;

  SolidPair pair_;
  std::shared_ptr<const RoundBody> round_;
  int joint_, joint_count_;
  bool wraps_ = false;
  double lower_ = 0, size_ = 0;
  std::int64_t count_ = 0;
  std::unique_ptr<std::atomic<Cell>[]> cells_;
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

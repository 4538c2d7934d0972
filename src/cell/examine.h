// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Examines one box of tasks: looks for paths that can be proven for all of it.
#pragma once

#include "mneme/cell.h"
#include "mneme/collision.h"
#include "mneme/goal.h"
#include "mneme/sampling.h"

#include "cell/blocked_link.h"
#include "cell/branch.h"
#include "cell/cell_data.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// A box of tasks that is not examined yet.
struct OpenBox {
  TaskBox tasks;
  double share = 1;         ///< of the region's volume
  int node = 0;             ///< of the tree
  std::vector<int> above;   ///< boxes that serve some of its tasks already
  UnprovenBox around = {};  ///< why the box that it is a half of was not proven throughout
  double priority = 1;      ///< what examining it may gain
};

/// The result of examining a box.
struct Examined {
  std::vector<CellBox> boxes;  ///< proven; an origin of -1 stands for itself
  std::vector<int> profiles;   ///< profiles that proved the boxes
  bool is_served = false;      ///< all samples of the box are served
  double gained = 0;           ///< share of the samples that the boxes serve
  double left = 1;             ///< share of the samples that are not served yet
  bool is_blocked = false;     ///< no task of the box is free: proven
  CellGap gap = CellGap::unreachable;
  std::optional<ProofFailure> failure;
  std::optional<BlockedBy> blocked_by;  ///< what the link touches in some tasks
  /// How much each parameter that varies is to blame, relative to the others.
  std::array<double, kMostParameters> blame = {};
  /// How much the shares of samples that may be served yet differ between the halves.
  std::array<double, kMostParameters> contrast = {};
};

/// Distance that checkers for describe() keep, metres.
inline constexpr double kWidestClearance = 0.03;
/// Describes a place that is too close to contact, with what is closer than kWidestClearance.
void describe(const CollisionChecker& wide, const ProofFailure& failure, UnprovenBox& box);

/// Examines boxes of one region and start. Const functions are parallel-safe.
class Examiner {
 public:
  [[nodiscard]] static Result<Examiner> make(const CellRegion& region, const CellStart& start,
                                             const CellSettings& settings);

  /// `known` are the boxes so far; `order` the profiles of bends, the best first.
  [[nodiscard]] Examined examine(const OpenBox& box, const std::vector<CellBox>& known,
                                 const std::array<int, kBendProfiles>& order) const;

  [[nodiscard]] const LinkChain& chain() const { return *chain_; }
  [[nodiscard]] const TaskFrame& frame() const { return *frame_; }
  /// Describes a place that is too close to contact.
  void describe(const ProofFailure& failure, UnprovenBox& box) const;

 private:
  friend class Examination;
  /// A checker that keeps this distance from contact, metres.
  struct Level {
    double clearance = 0;
    CollisionChecker checker;
  };
  Examiner() = default;

  std::unique_ptr<const LinkChain> chain_;
  std::unique_ptr<const TaskFrame> frame_;
  std::unique_ptr<const BranchFitter> fitter_;
  std::unique_ptr<const InverseKinematics> kinematics_;
  std::unique_ptr<const Sampler> sampler_;
  std::unique_ptr<const BlockedLink> blocked_;
  std::vector<Level> levels_;  ///< the widest first; the last has no margin
  std::string link_;
  Configuration start_;
  double margin_ = 0;
  std::uint64_t seed_ = 1;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Local queries of a robot in space, reaching through the passage between two obstacles.
#pragma once

#include "memory/body_points.h"
#include "memory/local_queries.h"
#include "primitive/passage.h"

#include <vector>

namespace mneme::internal {

class PassageQueries final : public QuerySource {
 public:
  /// Of the first two obstacles of the checker's scene; nothing if they touch, or if no shape of
  /// the robot moves. Refers to the checker.
  [[nodiscard]] static std::optional<PassageQueries> make(const CollisionChecker& checker);

  [[nodiscard]] int depth_count() const override { return static_cast<int>(strata_.size()); }
  [[nodiscard]] std::optional<Configuration> draw_start(int depth,
                                                        std::span<const Configuration> earlier,
                                                        Rng& rng) const override;
  [[nodiscard]] bool is_clear(std::span<const double> q) const override;

 private:
  PassageQueries(const CollisionChecker& checker, const Passage& passage);

  [[nodiscard]] Configuration random(Rng& rng) const;
  [[nodiscard]] Configuration shaken(Configuration q, Rng& rng) const;

  const CollisionChecker* checker_;
  Vec3 middle_;
  Vec3 inwards_ = Vec3::Zero();  ///< through the passage, away from the robot; zero if unknown
  std::vector<BodyPoint> body_;
  std::vector<std::vector<int>> strata_;  ///< per depth indices into body_
};

}  // namespace mneme::internal

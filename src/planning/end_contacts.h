// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contacts at the ends of a query.
#pragma once

#include "mneme/planning.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mneme::internal {

/// True if `q`, a valid configuration, keeps kVerificationMargin. The kernels decide, as for the
/// planner; exact distances cost a thousand times more.
[[nodiscard]] bool is_clear(const CollisionChecker& checker, const Configuration& q);

/// What the exact geometry must keep at the ends of a line, metres beyond the margin. Less than
/// kSolidClearance, because no search must find a way there: a line keeps to its tolerance and is
/// proven in short steps. The proof takes kVerificationMargin and the 5e-5 of SolidPair.
inline constexpr double kLineClearance = 2.5e-4;

/// True if `q` is clear, or if only spheres are in contact and the exact geometry keeps
/// `clearance`: then make_query_checker() checks these pairs by exact geometry.
[[nodiscard]] bool is_clear_by_exact_geometry(const CollisionChecker& checker,
                                              const Configuration& q,
                                              double clearance = kSolidClearance);

/// True if refuse_query() accepts `q`, a start or a goal. Names nothing: it takes microseconds
/// where `q` is clear.
[[nodiscard]] bool is_valid_end(const CollisionChecker& checker, const Configuration& q);

/// As mneme::drop_invalid_goals(). `goals` are those of the query from number `first` on.
[[nodiscard]] std::vector<std::string> drop_invalid_goals(const CollisionChecker& checker,
                                                          std::vector<Configuration>& goals,
                                                          bool are_ends_clear, std::size_t first);

/// As make_query_checker(). `names` are those of the start and of each goal in notes.
[[nodiscard]] Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                                      const CheckerSettings& settings,
                                                      const PlanQuery& ends,
                                                      const std::vector<std::string>& names);

/// As make_query_checker() for the one end `q`, with this clearance for kSolidClearance.
[[nodiscard]] Result<QueryChecker> make_end_checker(const CollisionChecker& plain,
                                                    const CheckerSettings& settings,
                                                    const Configuration& q, double clearance);

}  // namespace mneme::internal

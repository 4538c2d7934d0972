// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contacts by exact distances in double precision. Shares no code with the kernels.
#pragma once

#include <span>
#include <vector>

#include "mneme/check.h"

namespace mneme::internal {

/// All pairs in contact at `q`: links with obstacles, inflated by `margin`, then links with links.
[[nodiscard]] std::vector<Contact> find_contacts(const Robot& robot, const Scene& scene,
                                                 std::span<const double> q, double margin);

/// Least distance between obstacles and `shapes`; infinite without any.
[[nodiscard]] double least_distance(std::span<const Capsule> shapes, const Scene& scene);

}  // namespace mneme::internal

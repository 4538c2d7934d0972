// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values in the XML of URDF and SRDF.
#pragma once

#include "mneme/geometry.h"

#include <string>

namespace mneme::internal {

/// Returns three numbers that read back to the same bits, except for the sign of zero.
[[nodiscard]] std::string xml_vector(const Vec3& v);

/// Returns `<origin xyz rpy/>` without attributes that are zero; nothing for the identity.
[[nodiscard]] std::string xml_origin(const Transform& pose);

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values as they stand in the XML of URDF and SRDF.
#pragma once

#include "mneme/geometry.h"

#include <string>
#include <string_view>

namespace mneme::internal {

/// `text` as an attribute's value in double quotes.
[[nodiscard]] std::string xml_escaped(std::string_view text);

/// Three numbers that read back to the same bits, apart from the sign of zero.
[[nodiscard]] std::string xml_vector(const Vec3& v);

/// `<origin xyz rpy/>`, without what is zero; nothing for the identity.
[[nodiscard]] std::string xml_origin(const Transform& pose);

}  // namespace mneme::internal

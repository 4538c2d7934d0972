// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values as they stand in XML.
#pragma once

#include <string>
#include <string_view>

#include "mneme/geometry.h"

namespace mneme::internal {

/// `text` as an attribute's value in double quotes.
[[nodiscard]] std::string xml_escaped(std::string_view text);

/// Three numbers that read back to the same bits, apart from the sign of zero.
[[nodiscard]] std::string xml_vector(const Vec3& v);

/// `<origin xyz rpy/>`, without what is zero; nothing for the identity.
[[nodiscard]] std::string xml_origin(const Transform& pose);

}  // namespace mneme::internal

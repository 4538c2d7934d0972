// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The page of the viewer without a trace: viewer/dist/viewer.html, as the build puts it into the
/// library.
#pragma once

#include <string_view>

namespace mneme::internal {

[[nodiscard]] std::string_view viewer_page();

}  // namespace mneme::internal

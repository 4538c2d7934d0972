// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Points in files: PLY and PCD.
#pragma once

#include "mneme/base.h"
#include "mneme/scene.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

inline constexpr std::size_t kMaxCloudPoints = 4'000'000;

struct CloudFile {
  std::vector<CloudPoint> points;  ///< one at least, all finite
  std::size_t skipped = 0;         ///< points with a coordinate that is not finite
  std::size_t size() const { return points.size() + skipped; }
};

/// A PLY or PCD file, text or binary, by what it begins with. Errors name `source`, and the line if
/// one is wrong: no such file, or one without x, y and z of floating point, that ends early or goes
/// on, has more points than kMaxCloudPoints or none that is finite.
[[nodiscard]] Result<CloudFile> read_cloud(const std::string& path);
[[nodiscard]] Result<CloudFile> parse_cloud(std::string_view bytes, const std::string& source);

}  // namespace mneme::internal

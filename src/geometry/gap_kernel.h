// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Gaps of all cells of a grid, along one axis after the other.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mneme::internal {

/// What a CellGrid holds, and memory to work in.
struct GapRequest {
  const std::uint8_t* octants;
  const int* count;       ///< of cells along each axis
  std::uint8_t* scratch;  ///< so many bytes as scratch_size() says
  std::uint8_t* gaps;
};

[[nodiscard]] std::size_t scratch_size(const GapRequest& request);

using GapKernel = void (*)(const GapRequest& request);
[[nodiscard]] GapKernel gap_kernel();

}  // namespace mneme::internal

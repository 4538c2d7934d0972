// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Clearances of all voxels of a grid, along one axis after the other.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mneme::internal {

/// What a VoxelGrid holds, and memory to work in.
struct ClearanceRequest {
  const std::uint8_t* octants;
  const int* count;       ///< of voxels along each axis
  std::uint8_t* scratch;  ///< so many bytes as scratch_size() says
  std::uint8_t* clearances;
};

[[nodiscard]] std::size_t scratch_size(const ClearanceRequest& request);

using ClearanceKernel = void (*)(const ClearanceRequest& request);
[[nodiscard]] ClearanceKernel clearance_kernel();

}  // namespace mneme::internal

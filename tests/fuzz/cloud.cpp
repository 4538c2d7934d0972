// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"
#include "scene/compound_files.h"

#include <algorithm>
#include <cmath>

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto cloud = mneme::internal::parse_cloud(mneme::fuzz::as_text(data, size), "fuzz.ply");
  mneme::fuzz::expect_message(cloud);
  if (!cloud) return 0;
  if (cloud->size() > mneme::internal::kMaxCloudPoints) std::abort();
  for (const mneme::CloudPoint& p : cloud->points) {
    if (!std::ranges::all_of(p, [](float x) { return std::isfinite(x); })) std::abort();
  }
  return 0;
}

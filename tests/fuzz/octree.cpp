// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"
#include "scene/compound_files.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const bool is_unknown_occupied : {false, true}) {
    const auto cubes = mneme::internal::parse_octree(mneme::fuzz::as_text(data, size),
                                                     {is_unknown_occupied}, "fuzz.bt");
    mneme::fuzz::expect_message(cubes);
  }
  return 0;
}

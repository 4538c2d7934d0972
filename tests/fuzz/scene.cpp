// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scene = mneme::parse_scene(mneme::fuzz::as_text(data, size), "fuzz.yaml");
  mneme::fuzz::expect_message(scene);
  if (!scene) return 0;
  const auto again = mneme::parse_scene(mneme::to_yaml(*scene), "again.yaml");
  if (!again || again->obstacles.size() != scene->obstacles.size()) std::abort();
  return 0;
}

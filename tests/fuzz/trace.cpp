// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mneme::fuzz::expect_message(mneme::to_page(mneme::fuzz::as_text(data, size), "fuzz.json"));
  return 0;
}

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/benchmark.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = mneme::fuzz::as_text(data, size);
  const auto runs = mneme::parse_csv(text, "fuzz.csv");
  mneme::fuzz::expect_message(runs);
  if (runs && runs->complete_bytes > size) std::abort();
  mneme::fuzz::expect_message(mneme::parse_memory_csv(text, "fuzz.csv"));
  return 0;
}

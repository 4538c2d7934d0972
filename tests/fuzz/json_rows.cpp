// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"
#include "upkeep/json_rows.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto line = mneme::fuzz::as_text(data, size);
  mneme::fuzz::expect_message(mneme::internal::parse_signature(line));
  const auto row = mneme::internal::parse_row(line);
  mneme::fuzz::expect_message(row);
  // Rows that were read can be written and read back.
  if (row && !mneme::internal::parse_row(mneme::internal::json_of(*row))) std::abort();
  return 0;
}

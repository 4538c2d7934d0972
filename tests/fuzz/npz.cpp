// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"
#include "exchange/npz_rows.h"
#include "store/row_check.h"
#include "exchange/npz_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto archive = mneme::fuzz::as_text(data, size);
  const auto members = mneme::internal::read_zip("fuzz.npz", archive);
  mneme::fuzz::expect_message(members);
  if (!members) {
    // Checksums keep most inputs from getting any further.
    mneme::fuzz::expect_message(mneme::internal::parse_npy(archive));
    return 0;
  }
  std::map<std::string, mneme::internal::NpyArray> arrays;
  for (const auto& [name, bytes] : *members) {
    auto array = mneme::internal::parse_npy(bytes);
    mneme::fuzz::expect_message(array);
    if (array) arrays.emplace(name.substr(0, name.rfind('.')), *std::move(array));
  }
  const auto rows = mneme::internal::rows_of(arrays);
  mneme::fuzz::expect_message(rows);
  if (!rows) return 0;
  for (const auto& row : rows->rows) (void)mneme::internal::describe_flaw(row, rows->space);
  return 0;
}

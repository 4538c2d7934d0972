// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"

#include <memory>

/// Fails in each way that the driver must notice.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = mneme::fuzz::as_text(data, size);
  if (text == "crash") std::abort();
  if (text == "exit") std::_Exit(3);
  if (text == "hang") {
    while (true) ::pause();
  }
  if (text == "grow") {
    constexpr std::size_t kBytes = std::size_t{64} << 20;
    const auto memory = std::make_unique<volatile char[]>(kBytes);
    for (std::size_t i = 0; i < kBytes; i += 1024) memory[i] = 1;
  }
  return 0;
}

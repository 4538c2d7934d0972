// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Instruction sets for tests that compare the kernels of all.
#pragma once

#include "mneme/base.h"

#include <vector>

namespace mneme::test {

/// Those that this machine can run.
inline std::vector<Isa> available_isas() {
  std::vector<Isa> result;
  for (const Isa isa : {Isa::scalar, Isa::sse, Isa::avx2, Isa::avx512}) {
    if (is_available(isa)) result.push_back(isa);
  }
  return result;
}

}  // namespace mneme::test

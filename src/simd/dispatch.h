// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Selects the instance of a kernel that was compiled for an instruction set. No global state.
#pragma once

#include "mneme/base.h"

#include "hwy/targets.h"

#include <cstdint>
#include <iterator>

namespace mneme::internal {

/// Returns Highway's target bit of an instruction set; `automatic` stands for default_isa().
[[nodiscard]] inline std::int64_t target_of(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return HWY_AVX3;
    case Isa::avx2:
      return HWY_AVX2;
    case Isa::sse:
      return HWY_SSE4;
    case Isa::neon:
      return HWY_NEON;
    case Isa::wasm:
      return HWY_WASM;
    case Isa::scalar:
      return HWY_SCALAR;
    case Isa::automatic:
      break;
  }
  return target_of(default_isa());
}

}  // namespace mneme::internal

/// Defines `TYPE NAME(Isa isa)`, which calls the instance of FUNCTION() that was compiled for
/// `isa`. Place it at the end of a kernel's file, in the HWY_ONCE part.
#define MNEME_EXPORT(TYPE, NAME, FUNCTION)                                                    \
  namespace mneme::internal {                                                                 \
  HWY_EXPORT(FUNCTION);                                                                       \
  TYPE NAME(Isa isa) {                                                                        \
    hwy::ChosenTarget target;                                                                 \
    target.Update(target_of(isa));                                                            \
    const auto& table = HWY_DISPATCH_TABLE(FUNCTION);                                         \
    return table[std::size(table) == 1 ? 0 : target.GetIndex()](); /* 1: built for one isa */ \
  }                                                                                           \
  }  // namespace mneme::internal

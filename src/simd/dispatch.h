// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Picks the instance of a kernel that was compiled for an instruction set, without any global
/// state.
#pragma once

#include "mneme/base.h"

#include "hwy/targets.h"

#include <cstdint>

namespace mneme::internal {

/// Highway's target bit of an instruction set; `automatic` is that of default_isa().
[[nodiscard]] inline std::int64_t target_of(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return HWY_AVX3;
    case Isa::avx2:
      return HWY_AVX2;
    case Isa::sse:
      return HWY_SSE4;
    case Isa::scalar:
      return HWY_SCALAR;
    case Isa::automatic:
      break;
  }
  return target_of(default_isa());
}

}  // namespace mneme::internal

/// Ends the file of a kernel, in its HWY_ONCE part: defines `TYPE NAME(Isa isa)`, what FUNCTION,
/// one without arguments in that file, returns as it was compiled for the instruction set.
#define MNEME_EXPORT(TYPE, NAME, FUNCTION)                    \
  namespace mneme::internal {                                 \
  HWY_EXPORT(FUNCTION);                                       \
  TYPE NAME(Isa isa) {                                        \
    hwy::ChosenTarget target;                                 \
    target.Update(target_of(isa));                            \
    return HWY_DISPATCH_TABLE(FUNCTION)[target.GetIndex()](); \
  }                                                           \
  }  // namespace mneme::internal

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

/// Calls the instance of FUNCTION, which HWY_EXPORT exported in this file, for `isa`.
#define MNEME_DISPATCH(FUNCTION, isa)                              \
  ([](::mneme::Isa chosen_isa) {                                   \
    hwy::ChosenTarget target;                                      \
    target.Update(::mneme::internal::target_of(chosen_isa));       \
    return (*(HWY_DISPATCH_TABLE(FUNCTION)[target.GetIndex()]))(); \
  }(isa))

}  // namespace mneme::internal

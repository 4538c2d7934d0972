// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// cpp-httplib without the macro `_res` that it takes from <resolv.h>: Eigen has parameters of that
/// name.
#pragma once

#include <httplib.h>

#undef _res

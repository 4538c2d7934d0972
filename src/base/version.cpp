// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

namespace mneme {

std::string_view version() { return MNEME_VERSION; }

}  // namespace mneme

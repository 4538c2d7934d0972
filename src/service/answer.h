// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Answers of the service, without HTTP.
#pragma once

#include "mneme/base.h"

#include <string>
#include <string_view>

namespace mneme::internal {

struct Answer {
  int status = 200;
  std::string body;
  const char* type = "application/json";
  bool may_retry = false;  ///< the service is busy; sends Retry-After
};

/// {"error": {"code": ..., "message": ...}}
[[nodiscard]] Answer refusal(int status, std::string_view code, std::string_view message);
[[nodiscard]] Answer refusal(const Error& error);

}  // namespace mneme::internal

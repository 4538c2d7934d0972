// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/text.h"

namespace mneme {

Error::Error(ErrorCode kind, std::string text)
    : code(kind),
      message(internal::decode_utf8(text) ? std::move(text) : internal::escape_bytes(text)) {}

std::string_view to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::io:
      return "io";
    case ErrorCode::parse:
      return "parse";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::invalid:
      return "invalid";
    case ErrorCode::wrong_robot:
      return "wrong_robot";
    case ErrorCode::corrupt:
      return "corrupt";
  }
  return "invalid";
}

}  // namespace mneme

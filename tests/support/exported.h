// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Databases compared by what they export.
#pragma once

#include "support/support.h"

namespace mneme::test {

/// The lines of a database's export, without times.
inline std::string exported(const std::string& url) {
  const TemporaryDirectory directory;
  require(export_database(url, directory / "export.jsonl"));
  std::string text = read_file(directory / "export.jsonl");
  const std::string field = "\"time\":\"";
  for (std::size_t at = 0; (at = text.find(field, at)) != std::string::npos;) {
    at += field.size();
    text.erase(at, text.find('"', at) - at);
  }
  return text;
}

}  // namespace mneme::test

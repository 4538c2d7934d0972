// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Keeps results of long computations in files, under the hash of what they follow from.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mneme::internal {

/// A directory with one file per result. Several programs may use it at the same time.
class ContentCache {
 public:
  /// `kind`: begin of the names of the files. An empty `directory` is no cache: nothing is found or
  /// stored.
  ContentCache(std::string directory, std::string kind)
      : directory_(std::move(directory)), kind_(std::move(kind)) {}

  /// Returns a hash of 32 hexadecimal digits.
  [[nodiscard]] static std::string hash_of(std::string_view bytes);

  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// Returns the line stored under `key`. Nothing if there is none or the file is damaged.
  [[nodiscard]] std::optional<std::string> find(const std::string& key) const;
  /// Stores a text of one line. Returns true if the file was written.
  [[nodiscard]] bool store(const std::string& key, const std::string& text) const;

 private:
  [[nodiscard]] std::string path_of(const std::string& key) const;
  std::string directory_, kind_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Costs and savings of kinds of memory.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace mneme::internal {

/// A running account per kind of memory, in checked states. Older entries count less, so that a
/// kind is trusted again once it pays. Thread-safe.
class KindAccounts {
 public:
  void book(std::string_view kind, std::uint64_t spent, std::uint64_t saved);
  /// Returns 1 while `kind` has saved what it spent beyond kCredit, otherwise less, down to
  /// kCredit / (kCredit + kWindow).
  [[nodiscard]] double trust(std::string_view kind) const;
  /// True if `kind` has saved more than it spent.
  [[nodiscard]] bool pays(std::string_view kind) const;

 private:
  struct Account {
    double spent = 0, saved = 0;
  };

  /// States that a kind may spend without saving any: some five searches in vain.
  static constexpr double kCredit = 50'000;
  /// Largest sum of `spent` and `saved` that is remembered.
  static constexpr double kWindow = 1'000'000;

  mutable std::mutex mutex_;
  std::map<std::string, Account, std::less<>> accounts_;
};

}  // namespace mneme::internal

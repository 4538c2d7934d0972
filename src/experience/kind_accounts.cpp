// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/kind_accounts.h"

#include <algorithm>

namespace mneme::internal {

void KindAccounts::book(std::string_view kind, std::uint64_t spent, std::uint64_t saved) {
  if (spent == 0 && saved == 0) return;
  const std::lock_guard lock(mutex_);
  Account& account = accounts_[std::string(kind)];
  account.spent += static_cast<double>(spent);
  account.saved += static_cast<double>(saved);
  const double shrink = std::min(1.0, kWindow / (account.spent + account.saved));
  account.spent *= shrink;
  account.saved *= shrink;
}

double KindAccounts::trust(std::string_view kind) const {
  const std::lock_guard lock(mutex_);
  const auto known = accounts_.find(kind);
  if (known == accounts_.end()) return 1;
  const auto& [spent, saved] = known->second;
  return std::min(1.0, (kCredit + saved) / (kCredit + spent));
}

bool KindAccounts::pays(std::string_view kind) const {
  const std::lock_guard lock(mutex_);
  const auto known = accounts_.find(kind);
  return known != accounts_.end() && known->second.saved > known->second.spent;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/valid_components.h"

#include <algorithm>

namespace mneme::internal {

GaussianMixture keep_valid_components(const CollisionChecker& checker,
                                      const GaussianMixture& mixture) {
  const auto count = static_cast<std::size_t>(mixture.component_count());
  const auto joints = static_cast<std::size_t>(mixture.joint_count);
  std::vector<std::uint8_t> is_valid(count);
  checker.check_states(mixture.means, is_valid);
  if (std::find(is_valid.begin(), is_valid.end(), 1) == is_valid.end()) return mixture;
  GaussianMixture kept;
  kept.joint_count = mixture.joint_count;
  kept.factors = mixture.factors;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_valid[i] == 0) continue;
    const auto mean = mixture.means.begin() + static_cast<std::ptrdiff_t>(i * joints);
    kept.means.insert(kept.means.end(), mean, mean + static_cast<std::ptrdiff_t>(joints));
    if (!mixture.factor_rows.empty()) kept.factor_rows.push_back(mixture.factor_rows[i]);
    if (!mixture.origins.empty()) kept.origins.push_back(mixture.origins[i]);
  }
  return kept;
}

}  // namespace mneme::internal

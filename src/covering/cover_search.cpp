// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_search.h"

#include <algorithm>
#include <numeric>

namespace mneme::internal {
namespace {

using Indices = std::vector<int>;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The state of the search: which proposals are chosen, and how many of them hold each piece.
class CoverSearch {
 public:
  CoverSearch(std::vector<Sphere> proposals, std::span<const Element> elements, Rng& rng)
      : proposals_(std::move(proposals)), holders_(elements.size()), rng_(rng) {
    for (int e = 0; e < static_cast<int>(elements.size()); ++e) {
      for (int p = 0; p < static_cast<int>(proposals_.size()); ++p) {
        if (elements[at(e)].is_within(proposals_[at(p)])) holders_[at(e)].push_back(p);
      }
      if (!holders_[at(e)].empty()) continue;
      holders_[at(e)].push_back(static_cast<int>(proposals_.size()));
      proposals_.push_back(elements[at(e)].bound);
    }
    held_.resize(proposals_.size());
    for (int e = 0; e < static_cast<int>(elements.size()); ++e) {
      for (const int p : holders_[at(e)]) held_[at(p)].push_back(e);
    }
    counts_.assign(elements.size(), 0);
    gains_.assign(proposals_.size(), 0);
  }

  [[nodiscard]] std::vector<Sphere> run(std::int64_t effort) {
    cover_bare(0);
    drop_needless();
    while (steps_ < effort && chosen_.size() > 1) {
      const Indices before = chosen_;
      take_some_away();
      cover_bare(0.3);
      drop_needless();
      if (chosen_.size() > before.size()) restore(before);
    }
    std::ranges::sort(chosen_);
    std::vector<Sphere> spheres;
    for (const int p : chosen_) spheres.push_back(proposals_[at(p)]);
    return spheres;
  }

 private:
  void choose(int proposal) {
    chosen_.push_back(proposal);
    for (const int e : held_[at(proposal)]) ++counts_[at(e)];
  }
  void discard(std::size_t position) {
    for (const int e : held_[at(chosen_[position])]) --counts_[at(e)];
    chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(position));
  }
  void restore(const Indices& chosen) {
    while (!chosen_.empty()) discard(chosen_.size() - 1);
    for (const int p : chosen) choose(p);
  }

  /// A random sphere and its nearest neighbours.
  void take_some_away() {
    const Vec3 center =
        proposals_[at(chosen_[rng_.index(static_cast<std::uint32_t>(chosen_.size()))])].center;
    std::ranges::sort(chosen_, {}, [&](int p) {
      return std::pair((proposals_[at(p)].center - center).squaredNorm(), p);
    });
    const std::size_t count = std::min<std::size_t>(2 + rng_.index(4), chosen_.size());
    for (std::size_t i = count; i > 0; --i) discard(i - 1);
  }

  /// Chooses what holds most bare pieces until none is bare; gains vary by the fraction `noise`.
  void cover_bare(double noise) {
    std::ranges::fill(gains_, 0);
    std::size_t bare = 0;
    for (std::size_t e = 0; e < counts_.size(); ++e) {
      if (counts_[e] > 0) continue;
      ++bare;
      steps_ += 2 * static_cast<std::int64_t>(holders_[e].size());
      for (const int p : holders_[e]) ++gains_[at(p)];
    }
    while (bare > 0) {
      const int best = most_useful(noise);
      for (const int e : held_[at(best)]) {
        if (counts_[at(e)] > 0) continue;
        --bare;
        for (const int p : holders_[at(e)]) --gains_[at(p)];
      }
      choose(best);
    }
  }

  [[nodiscard]] int most_useful(double noise) {
    steps_ += static_cast<std::int64_t>(gains_.size());
    int best = -1;
    double best_gain = 0;
    for (std::size_t p = 0; p < gains_.size(); ++p) {
      if (gains_[p] <= best_gain) continue;
      const double gain = gains_[p] * (1 - noise * rng_.uniform());
      if (gain <= best_gain) continue;
      best = static_cast<int>(p);
      best_gain = gain;
    }
    return best;
  }

  void drop_needless() {
    for (std::size_t i = chosen_.size(); i > 0; --i) {
      const auto& held = held_[at(chosen_[i - 1])];
      if (std::ranges::all_of(held, [&](int e) { return counts_[at(e)] > 1; })) discard(i - 1);
    }
  }

  std::vector<Sphere> proposals_;
  std::vector<Indices> holders_;  ///< of each piece
  std::vector<Indices> held_;     ///< by each proposal
  Indices counts_;                ///< chosen holders of each piece
  Indices gains_;                 ///< bare pieces that each proposal would hold
  Indices chosen_;
  std::int64_t steps_ = 0;
  Rng& rng_;
};

constexpr std::size_t kMostProposals = 2500;
constexpr std::size_t kMostSurfaceProposals = 500;

/// `count` of `items`, in their order.
template <class T>
std::vector<T> thin_out(std::vector<T> items, std::size_t count, Rng& rng) {
  for (std::size_t i = 0; i < count && count < items.size(); ++i) {
    const auto rest = static_cast<std::uint32_t>(items.size() - i);
    std::swap(items[i], items[i + rng.index(rest)]);
  }
  items.resize(std::min(items.size(), count));
  return items;
}

}  // namespace

std::vector<Sphere> propose_spheres(const SolidModel& solid, std::vector<Sphere> medial_balls,
                                    std::span<const Element> elements, double excess, Rng& rng) {
  std::vector<Sphere> proposals = thin_out(std::move(medial_balls), kMostProposals, rng);
  for (Sphere& sphere : proposals) sphere.radius += excess;
  std::vector<const Element*> skin;
  for (const Element& element : elements) skin.push_back(&element);
  for (const Element* element : thin_out(std::move(skin), kMostSurfaceProposals, rng)) {
    const double radius = solid.depth(element->bound.center) + excess;
    if (radius > 0) proposals.push_back({element->bound.center, radius});
  }
  return proposals;
}

std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals, std::span<const Element> elements,
                                   std::int64_t effort, Rng& rng) {
  return CoverSearch(std::move(proposals), elements, rng).run(effort);
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/moved_means.h"
#include "memory/gap_fit.h"
#include "memory/planar_chain.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

/// The stored pair moved to the scene, with its circles in the order of the scene's pair.
PrimitiveKey stored_pair(const Match& match, const PrimitiveKey& scene_pair) {
  PrimitiveKey pair = moved_key(match.to_scene, match.experience->key);
  const auto distance = [&](std::size_t shift) {
    double sum = 0;
    for (std::size_t i = 0; i < pair.size(); ++i) {
      const double difference = pair[(i + shift) % pair.size()] - scene_pair[i];
      sum += difference * difference;
    }
    return sum;
  };
  if (distance(3) < distance(0)) std::rotate(pair.begin(), pair.begin() + 3, pair.end());
  return pair;
}

/// A match with data shared by all its means.
struct FittedMatch {
  std::shared_ptr<const Experience> experience;
  Symmetry to_scene;
  SampleSource source = 0;
  GapSegment stored;
  GapFit fit;
  int least_link = 0;  ///< means that cross with a link before this one are skipped
  bool is_crossed = false;
  std::tuple<bool, std::size_t, double> order;  ///< smaller is more relevant
};

class FittedMeans final : public ComponentSource {
 public:
  FittedMeans(const MemoryQuery& query, PlanarChain chain)
      : chain_(std::move(chain)), space_(query.robot) {}
  FittedMeans(const FittedMeans&) = delete;
  FittedMeans& operator=(const FittedMeans&) = delete;

  void add(const MemoryQuery& query, const PrimitiveRetrieval& retrieval, SampleSource source) {
    const LocalPrimitive& primitive = retrieval.primitive;
    const PrimitiveKey pair = moved_key(primitive.to_scene, primitive.key);
    const GapSegment gap = gap_segment(pair);
    const int least_link = shallowest_crossing(query, pair);
    for (std::size_t rank = 0; rank < retrieval.matches.size(); ++rank) {
      const Match& match = retrieval.matches[rank];
      const GapSegment stored = gap_segment(stored_pair(match, pair));
      const bool is_crossed = least_link >= 0;
      matches_.push_back({match.experience,
                          match.to_scene,
                          source,
                          stored,
                          GapFit(chain_, stored, gap),
                          std::max(least_link, 0),
                          is_crossed,
                          {!is_crossed, rank, match.similarity_error}});
    }
  }

  void sort() {
    std::ranges::stable_sort(matches_, {}, &FittedMatch::order);
    const auto is_best_of_crossed = [](const FittedMatch& match) {
      return match.is_crossed && std::get<1>(match.order) == 0;
    };
    first_groups_ =
        std::max(1, static_cast<int>(std::ranges::count_if(matches_, is_best_of_crossed)));
  }

  [[nodiscard]] int group_count() const override { return static_cast<int>(matches_.size()); }
  [[nodiscard]] int first_groups() const override { return first_groups_; }
  [[nodiscard]] int component_count(int group) const override {
    return match(group).experience->sampler().component_count();
  }
  [[nodiscard]] SampleSource sample_source(int group) const override { return match(group).source; }

  [[nodiscard]] bool make(int group, int component, std::span<float> mean) const override {
    const FittedMatch& from = match(group);
    const LocalSampler& sampler = from.experience->sampler();
    const float* stored = sampler.means.data() + static_cast<std::size_t>(component) * mean.size();
    const double sign = from.to_scene.is_mirrored ? -1 : 1;
    std::vector<double> q(mean.size());
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = sign * stored[j];
    q[0] = chain_.joint_value(0, chain_.direction(0, q[0] + from.to_scene.rotation, 0), 0);
    const GapCrossing crossing = find_gap_crossing(chain_, from.stored, q);
    if (crossing.link >= 0 && crossing.link < from.least_link) return false;
    if (crossing.link >= 0 && !from.fit.fit(crossing, q)) return false;
    return write(q, mean);
  }

  [[nodiscard]] std::span<const float> factor(int group, int component) const override {
    return match(group).experience->sampler().factor(component);
  }

 private:
  static constexpr double kLimitTolerance = 1e-5;

  [[nodiscard]] const FittedMatch& match(int group) const {
    return matches_[static_cast<std::size_t>(group)];
  }

  /// The least first link that the start or a goal crosses the pair with; -1 if none crosses.
  [[nodiscard]] int shallowest_crossing(const MemoryQuery& query, const PrimitiveKey& pair) const {
    std::vector<int> links;
    if (query.start != nullptr) links.push_back(first_crossing_link(chain_, pair, *query.start));
    for (const Configuration& goal : query.goals) {
      links.push_back(first_crossing_link(chain_, pair, goal));
    }
    std::erase(links, -1);
    return links.empty() ? -1 : *std::ranges::min_element(links);
  }

  [[nodiscard]] bool write(std::span<const double> q, std::span<float> mean) const {
    for (std::size_t j = 0; j < q.size(); ++j) {
      const auto value = static_cast<float>(q[j]);
      mean[j] = space_.into_limits(static_cast<int>(j), value);
      const bool is_inside =
          space_.periods()[j] > 0 || std::abs(mean[j] - value) <= kLimitTolerance;
      if (!is_inside) return false;
    }
    return true;
  }

  PlanarChain chain_;
  JointSpace space_;
  std::vector<FittedMatch> matches_;
  int first_groups_ = 1;
};

}  // namespace

std::shared_ptr<const ComponentSource> retarget_means(
    const MemoryQuery& query, std::span<const PrimitiveRetrieval> primitives,
    SampleSource first_source) {
  auto chain = PlanarChain::make(query.robot);
  if (!chain) return nullptr;
  auto fitted = std::make_shared<FittedMeans>(query, *std::move(chain));
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    fitted->add(query, primitives[i], first_source + static_cast<SampleSource>(i));
  }
  fitted->sort();
  return fitted;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/experience_index.h"

#include <nanoflann.hpp>

#include <algorithm>
#include <array>
#include <cfloat>
#include <tuple>

namespace mneme::internal {
namespace {

/// Keys in the form that nanoflann reads. It sees the first `indexed_count` of them.
struct Keys {
  std::size_t key_size = 0;
  std::size_t indexed_count = 0;
  std::vector<double> values;

  [[nodiscard]] std::size_t size() const { return values.size() / key_size; }
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return indexed_count; }
  [[nodiscard]] double kdtree_get_pt(std::size_t position, std::size_t number) const {
    return values[position * key_size + number];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Keys>, Keys,
                                                   -1, std::uint32_t>;

/// Four sums at a time, where one would wait for itself; rounded otherwise than the exact one.
double rough_squared_distance(const double* a, const double* b, std::size_t size) {
  std::array<double, 4> sums = {};
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const double difference = a[i + lane] - b[i + lane];
      sums[lane] += difference * difference;
    }
  }
  for (; i < size; ++i) sums[i % 4] += (a[i] - b[i]) * (a[i] - b[i]);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

bool is_nearer(const IndexMatch& a, const IndexMatch& b) {
  return std::tie(a.error, a.position) < std::tie(b.error, b.position);
}

/// The `max_matches` nearest keys under the threshold: nanoflann's interface for results. Its own
/// kinds either have no radius or no bound on the number, and leave ties to chance.
class NearestUnderThreshold {
 public:
  using DistanceType = double;
  using IndexType = std::uint32_t;

  NearestUnderThreshold(double threshold, std::size_t max_matches)
      : threshold_(threshold), max_matches_(max_matches) {}

  [[nodiscard]] std::size_t size() const { return matches_.size(); }
  [[nodiscard]] bool full() const { return max_matches_ > 0 && matches_.size() >= max_matches_; }

  /// A little more than what is still wanted, because the tree sums its bounds in another order
  /// than the distances and because keys as far as the worst match may come before it; addPoint()
  /// decides exactly.
  [[nodiscard]] double worstDist() const {
    const double worst = full() ? matches_.front().error : threshold_;
    return worst * (1 + 1e-12) + DBL_MIN;
  }

  bool addPoint(double error, std::uint32_t position) {
    const IndexMatch match{position, 0, error};
    if (!(error < threshold_)) return true;
    if (full()) {
      if (!is_nearer(match, matches_.front())) return true;
      std::pop_heap(matches_.begin(), matches_.end(), is_nearer);
      matches_.back() = match;
    } else {
      matches_.push_back(match);
    }
    if (max_matches_ > 0) std::push_heap(matches_.begin(), matches_.end(), is_nearer);
    return true;
  }

  [[nodiscard]] const std::vector<IndexMatch>& matches() const { return matches_; }

 private:
  double threshold_;
  std::size_t max_matches_;
  std::vector<IndexMatch>
      matches_;  // a heap, the worst in front, if there is a bound on their number
};

}  // namespace

struct ExperienceIndex::Tree {
  explicit Tree(int key_size)
      : keys{static_cast<std::size_t>(key_size), 0, {}}, kd_tree(key_size, keys) {}

  Keys keys;
  KdTree kd_tree;
};

ExperienceIndex::ExperienceIndex(int key_size) : tree_(std::make_unique<Tree>(key_size)) {}
ExperienceIndex::~ExperienceIndex() = default;

void ExperienceIndex::append(std::span<const double> key) {
  tree_->keys.values.insert(tree_->keys.values.end(), key.begin(), key.end());
}

void ExperienceIndex::refresh() {
  Keys& keys = tree_->keys;
  // A tree tells little about long keys, and jumps through memory where a scan streams.
  const std::size_t short_tail = keys.key_size > 8 ? 4096 : 256;
  const std::size_t tail = keys.size() - keys.indexed_count;
  if (tail <= std::max(short_tail, keys.indexed_count / 32)) return;
  keys.indexed_count = keys.size();
  tree_->kd_tree.buildIndex();
}

std::vector<IndexMatch> ExperienceIndex::find(std::span<const KeyImage> images, double threshold,
                                              int max_matches) const {
  const Keys& keys = tree_->keys;
  const auto bound = static_cast<std::size_t>(std::max(max_matches, 0));
  std::vector<IndexMatch> found;
  for (std::uint32_t image = 0; image < images.size(); ++image) {
    const double* query = images[image].key.data();
    NearestUnderThreshold nearest(threshold, bound);
    tree_->kd_tree.findNeighbors(nearest, query, nanoflann::SearchParams());
    for (std::size_t i = keys.indexed_count; i < keys.size(); ++i) {
      const double* key = keys.values.data() + i * keys.key_size;
      if (rough_squared_distance(query, key, keys.key_size) >= nearest.worstDist()) continue;
      const auto position = static_cast<std::uint32_t>(i);
      nearest.addPoint(tree_->kd_tree.distance.evalMetric(query, position, keys.key_size),
                       position);
    }
    for (const IndexMatch& match : nearest.matches()) {
      found.push_back({match.position, image, match.error});
    }
  }
  // A key may be near to several images: its nearest one, the first of equals, stands for it.
  std::sort(found.begin(), found.end(), [](const IndexMatch& a, const IndexMatch& b) {
    return std::tie(a.position, a.error, a.image) < std::tie(b.position, b.error, b.image);
  });
  const auto is_same = [](const IndexMatch& a, const IndexMatch& b) {
    return a.position == b.position;
  };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
  std::sort(found.begin(), found.end(), is_nearer);
  if (bound > 0 && found.size() > bound) found.resize(bound);
  return found;
}

}  // namespace mneme::internal

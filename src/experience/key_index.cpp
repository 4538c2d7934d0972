// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/key_index.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::size_t kSortedLeaves = 32;

std::size_t leaf_count(std::size_t size) {
  std::size_t leaves = 1;
  while ((size + leaves - 1) / leaves > KeyTree::kLeafSize) leaves *= 2;
  return leaves;
}

/// Sorts keys into leaves by repeated halving along the widest number.
class Splitter {
 public:
  Splitter(const std::vector<double>& keys, std::size_t key_size, std::vector<std::uint32_t>& order)
      : keys_(keys), key_size_(key_size), order_(order), column_(order.size()) {
    lower_.assign(key_size, std::numeric_limits<double>::infinity());
    upper_.assign(key_size, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      lower_[i % key_size] = std::min(lower_[i % key_size], keys[i]);
      upper_[i % key_size] = std::max(upper_[i % key_size], keys[i]);
    }
  }

  void split(std::size_t begin, std::size_t end, std::size_t leaves) {
    if (leaves == 1) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const std::size_t widest = widest_number();
    const double cut = halve(begin, middle, end, widest);
    const double upper = std::exchange(upper_[widest], cut);
    split(begin, middle, leaves / 2);
    upper_[widest] = upper;
    const double lower = std::exchange(lower_[widest], cut);
    split(middle, end, leaves / 2);
    lower_[widest] = lower;
  }

 private:
  [[nodiscard]] std::size_t widest_number() const {
    std::size_t widest = 0;
    for (std::size_t i = 1; i < key_size_; ++i) {
      if (upper_[i] - lower_[i] > upper_[widest] - lower_[widest]) widest = i;
    }
    return widest;
  }

  /// Returns the value between the halves.
  double halve(std::size_t begin, std::size_t middle, std::size_t end, std::size_t number) {
    const auto at = [&](std::size_t i) { return column_.begin() + static_cast<std::ptrdiff_t>(i); };
    for (std::size_t i = begin; i < end; ++i) {
      column_[i] = {keys_[order_[i] * key_size_ + number], order_[i]};
    }
    std::nth_element(at(begin), at(middle), at(end));
    for (std::size_t i = begin; i < end; ++i) order_[i] = column_[i].second;
    return column_[middle].first;
  }

  const std::vector<double>& keys_;
  std::size_t key_size_;
  std::vector<std::uint32_t>& order_;
  std::vector<std::pair<double, std::uint32_t>> column_;
  std::vector<double> lower_;
  std::vector<double> upper_;
};

void add_begins(std::size_t begin, std::size_t end, std::size_t leaves,
                std::vector<std::size_t>& begins) {
  if (leaves == 1) return begins.push_back(begin);
  const std::size_t middle = begin + (end - begin) / 2;
  add_begins(begin, middle, leaves / 2, begins);
  add_begins(middle, end, leaves / 2, begins);
}

std::vector<std::size_t> begins_of_leaves(std::size_t size) {
  std::vector<std::size_t> begins;
  add_begins(0, size, leaf_count(size), begins);
  begins.push_back(size);
  return begins;
}

KeyTreeData packed(std::size_t key_size, IndexRows rows) {
  KeyTreeData data{std::move(rows.ids), std::move(rows.components), {}, {}};
  data.order.resize(data.ids.size());
  std::iota(data.order.begin(), data.order.end(), 0U);
  const std::size_t size = data.ids.size();
  Splitter(rows.keys, key_size, data.order).split(0, size, leaf_count(size));
  data.keys.reserve(rows.keys.size());
  const std::vector<std::size_t> begins = begins_of_leaves(size);
  for (std::size_t leaf = 0; leaf + 1 < begins.size(); ++leaf) {
    for (std::size_t number = 0; number < key_size; ++number) {
      for (std::size_t i = begins[leaf]; i < begins[leaf + 1]; ++i) {
        data.keys.push_back(rows.keys[data.order[i] * key_size + number]);
      }
    }
  }
  return data;
}

}  // namespace

KeyTree::KeyTree(int key_size, IndexRows rows)
    : KeyTree(key_size, packed(static_cast<std::size_t>(key_size), std::move(rows))) {}

KeyTree::KeyTree(int key_size, KeyTreeData data)
    : key_size_(static_cast<std::size_t>(key_size)),
      data_(std::move(data)),
      components_(
          std::accumulate(data_.components.begin(), data_.components.end(), std::int64_t{0})),
      begins_(begins_of_leaves(data_.ids.size())),
      coarse_(key_size_, data_.keys, begins_) {}

IndexRows KeyTree::rows() const {
  IndexRows rows{data_.ids, data_.components, std::vector<double>(data_.keys.size())};
  const double* key = data_.keys.data();
  for (std::size_t leaf = 0; leaf + 1 < begins_.size(); ++leaf) {
    for (std::size_t number = 0; number < key_size_; ++number) {
      for (std::size_t i = begins_[leaf]; i < begins_[leaf + 1]; ++i) {
        rows.keys[data_.order[i] * key_size_ + number] = *key++;
      }
    }
  }
  return rows;
}

void KeyTree::search(const double* query, NearestMatches& nearest) const {
  if (size() == 0) return;
  const std::vector<std::int16_t> cells = coarse_.query(query);
  double wanted = nearest.bound();
  CoarseBound bound = coarse_.bound(wanted);
  auto leaves = coarse_.near_leaves(cells, bound.boxes);
  // Nearest leaves first, because their keys exclude others. Sorting all would cost more than
  // scanning.
  if (leaves.size() > kSortedLeaves) {
    std::ranges::nth_element(leaves, leaves.begin() + kSortedLeaves, {},
                             &CoarseKeys::NearLeaf::first);
  }
  std::sort(leaves.begin(),
            leaves.begin() + static_cast<std::ptrdiff_t>(std::min(leaves.size(), kSortedLeaves)));
  for (const auto& [least, leaf] : leaves) {
    if (least > bound.boxes) continue;
    offer(leaf, coarse_.near_keys(leaf, cells, bound.keys), query, nearest);
    if (std::exchange(wanted, nearest.bound()) != wanted) bound = coarse_.bound(wanted);
  }
}

double KeyTree::distance(std::size_t leaf, std::size_t i, const double* query) const {
  const std::size_t count = begins_[leaf + 1] - begins_[leaf];
  const double* number = data_.keys.data() + begins_[leaf] * key_size_ + i;
  double sum = 0;
  for (std::size_t k = 0; k < key_size_; ++k, number += count) {
    sum += (*number - query[k]) * (*number - query[k]);
  }
  return sum;
}

void KeyTree::offer(std::size_t leaf, std::uint64_t near, const double* query,
                    NearestMatches& nearest) const {
  static_assert(kLeafSize == 64);
  const std::size_t count = begins_[leaf + 1] - begins_[leaf];
  nearest.count_inspected(count);
  if (count < kLeafSize) near &= (std::uint64_t{1} << count) - 1;
  for (; near != 0; near &= near - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(near));
    nearest.offer(distance(leaf, i, query), data_.ids[data_.order[begins_[leaf] + i]]);
  }
}

namespace {

/// Trees up to this size are rebuilt in microseconds, so a new row always joins one.
constexpr std::size_t kSmallTree = 64;

template <class Value>
void append_to(std::vector<Value>& values, const std::vector<Value>& more) {
  values.insert(values.end(), more.begin(), more.end());
}

bool has_any(const KeyTree& tree, const std::function<bool(std::int64_t)>& is_removed) {
  return std::ranges::any_of(tree.data().ids, is_removed);
}

IndexRows rows_without(const KeyTree& tree, int key_size,
                       const std::function<bool(std::int64_t)>& is_removed) {
  const IndexRows all = tree.rows();
  IndexRows kept;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (is_removed(all.ids[i])) continue;
    kept.ids.push_back(all.ids[i]);
    kept.components.push_back(all.components[i]);
    const auto key = all.keys.begin() + static_cast<std::ptrdiff_t>(i) * key_size;
    kept.keys.insert(kept.keys.end(), key, key + key_size);
  }
  return kept;
}

}  // namespace

ExperienceIndex::ExperienceIndex(int key_size, std::vector<std::shared_ptr<const KeyTree>> trees)
    : key_size_(key_size), trees_(std::move(trees)) {
  count();
}

void ExperienceIndex::append(IndexRows rows) {
  if (rows.ids.empty()) return;
  std::size_t total = rows.ids.size();
  auto first = trees_.end();
  while (first != trees_.begin() && (*std::prev(first))->size() <= std::max(total, kSmallTree)) {
    --first;
    total += (*first)->size();
  }
  IndexRows joined;
  for (auto tree = first; tree != trees_.end(); ++tree) {
    const IndexRows old = (*tree)->rows();
    append_to(joined.ids, old.ids);
    append_to(joined.components, old.components);
    append_to(joined.keys, old.keys);
  }
  append_to(joined.ids, rows.ids);
  append_to(joined.components, rows.components);
  append_to(joined.keys, rows.keys);
  trees_.erase(first, trees_.end());
  trees_.push_back(std::make_shared<const KeyTree>(key_size_, std::move(joined)));
  count();
}

void ExperienceIndex::remove(const std::function<bool(std::int64_t)>& is_removed) {
  for (auto& tree : trees_) {
    if (!has_any(*tree, is_removed)) continue;
    tree = std::make_shared<const KeyTree>(key_size_, rows_without(*tree, key_size_, is_removed));
  }
  count();
}

std::vector<IndexMatch> ExperienceIndex::find(std::span<const std::vector<double>> images,
                                              double threshold, int max_matches,
                                              std::int64_t* keys_left) const {
  const auto bound = static_cast<std::size_t>(std::max(max_matches, 0));
  std::vector<IndexMatch> found;
  for (std::uint32_t image = 0; image < images.size(); ++image) {
    NearestMatches nearest(threshold, bound, image, keys_left);
    for (const auto& tree : trees_) tree->search(images[image].data(), nearest);
    found.insert(found.end(), nearest.matches().begin(), nearest.matches().end());
    threshold = nearest.limit();
  }
  // A key near several images is reported once, with its nearest image, the first of equals.
  std::sort(found.begin(), found.end(), [](const IndexMatch& a, const IndexMatch& b) {
    return std::tie(a.id, a.error, a.image) < std::tie(b.id, b.error, b.image);
  });
  const auto is_same = [](const IndexMatch& a, const IndexMatch& b) { return a.id == b.id; };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
  std::sort(found.begin(), found.end(), is_nearer);
  if (bound > 0 && found.size() > bound) found.resize(bound);
  return found;
}

std::int64_t ExperienceIndex::id(std::int64_t position) const {
  auto tree = trees_.begin();
  auto place = static_cast<std::size_t>(position);
  for (; place >= (*tree)->size(); ++tree) place -= (*tree)->size();
  return (*tree)->data().ids[place];
}

void ExperienceIndex::count() {
  size_ = 0;
  components_ = 0;
  for (const auto& tree : trees_) {
    size_ += static_cast<std::int64_t>(tree->size());
    components_ += tree->components();
  }
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/experience_index.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Trees up to this size are built anew in some microseconds, so that a new row always joins one.
constexpr std::size_t kSmallTree = 64;

template <class Value>
void append_to(std::vector<Value>& values, const std::vector<Value>& more) {
  values.insert(values.end(), more.begin(), more.end());
}

bool has_any(const KeyTree& tree, const std::function<bool(std::int64_t)>& is_gone) {
  return std::ranges::any_of(tree.data().ids, is_gone);
}

IndexRows rows_without(const KeyTree& tree, int key_size,
                       const std::function<bool(std::int64_t)>& is_gone) {
  const IndexRows all = tree.rows();
  IndexRows kept;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (is_gone(all.ids[i])) continue;
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

void ExperienceIndex::remove(const std::function<bool(std::int64_t)>& is_gone) {
  for (auto& tree : trees_) {
    if (!has_any(*tree, is_gone)) continue;
    tree = std::make_shared<const KeyTree>(key_size_, rows_without(*tree, key_size_, is_gone));
  }
  count();
}

std::vector<IndexMatch> ExperienceIndex::find(std::span<const std::vector<double>> images,
                                              double threshold, int max_matches) const {
  const auto bound = static_cast<std::size_t>(std::max(max_matches, 0));
  std::vector<IndexMatch> found;
  for (std::uint32_t image = 0; image < images.size(); ++image) {
    NearestMatches nearest(threshold, bound, image);
    for (const auto& tree : trees_) tree->search(images[image].data(), nearest);
    found.insert(found.end(), nearest.matches().begin(), nearest.matches().end());
    threshold = nearest.limit();
  }
  // A key may be near to several images: its nearest one, the first of equals, stands for it.
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

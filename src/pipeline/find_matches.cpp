// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include <utility>

namespace mneme {

Result<std::vector<Match>> find_matches(const Database& database, std::string_view kind,
                                        const LocalPrimitive& primitive, double threshold,
                                        int max_matches) {
  const std::vector<KeyImage> ways = images(primitive.key);
  std::vector<PrimitiveKey> keys;
  for (const KeyImage& way : ways) keys.push_back(way.key);
  return database.find(kind, keys, threshold, max_matches).map([&](std::vector<KeyMatch> found) {
    std::vector<Match> matches;
    for (KeyMatch& match : found) {
      const Symmetry to_canonical{0, ways[match.image].is_mirrored};
      matches.push_back({std::move(match.experience), match.similarity_error,
                         compose(primitive.to_scene, to_canonical)});
    }
    return matches;
  });
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sources of inputs: seeds, words of a dictionary, and simple changes.
#pragma once

#include "mneme/base.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::fuzz {

struct Material {
  std::vector<std::string> seeds;  ///< at least one
  std::vector<std::string> words;
  std::size_t max_length = 16384;  ///< bytes of an input
};

/// The empty input, and the files that `paths` name or that stand in the directories that they
/// name, in order of name.
Result<std::vector<std::string>> read_seeds(const std::vector<std::string>& paths);

/// The words of a dictionary of libFuzzer: lines NAME="WORD" or "WORD" with \\, \" and \xNN.
Result<std::vector<std::string>> read_dictionary(const std::string& path);

/// A seed after one to four changes: bits flipped, bytes set, removed, repeated or cut off, a word
/// put in, or the end of another seed put on.
std::string mutated(const Material& material, Rng& rng);

}  // namespace mneme::fuzz

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/driver/material.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

namespace mneme::fuzz {
namespace {

Result<std::string> read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) {
    return fail(ErrorCode::io, path.string() + ": cannot be read");
  }
  return text;
}

/// Returns the text between the first and the last quote; nothing if it is no word.
std::optional<std::string> read_word(std::string_view line) {
  const std::size_t first = line.find('"');
  const std::size_t last = line.rfind('"');
  if (first == last) return std::nullopt;
  std::string word;
  for (std::size_t i = first + 1; i < last; ++i) {
    if (line[i] != '\\') {
      word += line[i];
    } else if (line[i + 1] == 'x' && i + 3 < last) {
      unsigned char byte = 0;
      std::from_chars(&line[i + 2], &line[i + 4], byte, 16);
      word += static_cast<char>(byte);
      i += 3;
    } else {
      word += line[++i];
    }
  }
  return word;
}

std::size_t position(const std::string& text, Rng& rng) {
  return rng.index(static_cast<std::uint32_t>(text.size() + 1));
}

const std::string& one_of(const std::vector<std::string>& texts, Rng& rng) {
  return texts[rng.index(static_cast<std::uint32_t>(texts.size()))];
}

/// Up to 64 bytes from `from` on.
std::size_t stretch(const std::string& text, std::size_t from, Rng& rng) {
  constexpr std::size_t kLongest = 64;
  const std::size_t most = std::min(kLongest, text.size() - from);
  return most == 0 ? 0 : 1 + rng.index(static_cast<std::uint32_t>(most));
}

void change(const Material& material, std::string& text, Rng& rng) {
  enum { flip, set, remove, repeat, cut, splice, insert_word, overwrite_word, kind_count };
  const auto kind = rng.index(material.words.empty() ? insert_word : kind_count);
  const std::size_t at = position(text, rng);
  switch (kind) {
    case flip:
      if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << rng.index(8)));
      break;
    case set:
      if (at < text.size()) text[at] = static_cast<char>(rng.index(256));
      break;
    case remove:
      text.erase(at, stretch(text, at, rng));
      break;
    case repeat: {
      const std::string piece = text.substr(at, stretch(text, at, rng));
      for (std::uint32_t left = 1 + rng.index(16); left > 0; --left) text.insert(at, piece);
      break;
    }
    case cut:
      text.resize(at);
      break;
    case splice: {
      const std::string& other = one_of(material.seeds, rng);
      text = text.substr(0, at) + other.substr(position(other, rng));
      break;
    }
    case insert_word:
      text.insert(at, one_of(material.words, rng));
      break;
    default: {
      const std::string& word = one_of(material.words, rng);
      text.replace(at, word.size(), word);
      break;
    }
  }
}

}  // namespace

Result<std::vector<std::string>> read_seeds(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (const fs::path path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : fs::directory_iterator(path, error)) files.push_back(entry.path());
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  std::vector<std::string> seeds = {""};
  for (const fs::path& file : files) {
    auto seed = read_file(file);
    if (!seed) return tl::unexpected(seed.error());
    seeds.push_back(*std::move(seed));
  }
  return seeds;
}

Result<std::vector<std::string>> read_dictionary(const std::string& path) {
  std::ifstream file(path);
  if (!file) return fail(ErrorCode::io, path + ": cannot be read");
  std::vector<std::string> words;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    auto word = read_word(line);
    if (!word) return fail(ErrorCode::parse, path + ": expected \"WORD\", got " + line);
    words.push_back(*std::move(word));
  }
  return words;
}

std::string mutated(const Material& material, Rng& rng) {
  std::string text = one_of(material.seeds, rng);
  for (std::uint32_t left = 1 + rng.index(4); left > 0; --left) change(material, text, rng);
  text.resize(std::min(text.size(), material.max_length));
  return text;
}

}  // namespace mneme::fuzz

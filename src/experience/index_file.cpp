// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/index_file.h"

#include "base/files.h"
#include "engines/open_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace mneme::internal {
namespace {

/// Big-endian machines do not use the file.
constexpr bool kIsLittleEndian = std::endian::native == std::endian::little;

/// "mneme ix" and the version of the layout.
constexpr std::int64_t kMagic = 0x6d6e656d65206978;
constexpr std::int64_t kVersion = 3;
constexpr std::int64_t kLeaf = KeyTree::kLeafSize;
/// Magic, version, keys in a leaf, signature, groups; then the store's state.
constexpr std::size_t kOwnNumbers = 5;
using Header = std::array<std::int64_t, kOwnNumbers + kHeadSize>;

template <class Value>
std::string_view bytes_of(const Value* values, std::size_t count) {
  return {reinterpret_cast<const char*>(values), count * sizeof(Value)};
}

/// Reads numbers from bytes.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : rest_(bytes) {}

  template <class Value>
  bool take(Value* values, std::size_t count) {
    if (rest_.size() / sizeof(Value) < count) return false;
    std::memcpy(values, rest_.data(), count * sizeof(Value));
    rest_.remove_prefix(count * sizeof(Value));
    return true;
  }
  template <class Value>
  bool take(std::vector<Value>& values, std::size_t count) {
    if (rest_.size() / sizeof(Value) < count) return false;
    values.resize(count);
    return take(values.data(), count);
  }
  [[nodiscard]] bool is_empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// Header of a group: length of its kind's name, constraints, key size, number of trees.
using GroupHeader = std::array<std::int64_t, 4>;

std::optional<KeyTreeData> take_tree(Taker& taker, std::size_t key_size) {
  std::int64_t count = 0;
  KeyTreeData data;
  if (!taker.take(&count, 1) || count < 0) return std::nullopt;
  const auto size = static_cast<std::size_t>(count);
  if (!taker.take(data.ids, size) || !taker.take(data.components, size) ||
      !taker.take(data.order, size) || size > data.ids.max_size() / key_size ||
      !taker.take(data.keys, size * key_size)) {
    return std::nullopt;
  }
  const bool is_inside = std::ranges::all_of(data.order, [&](auto place) { return place < size; });
  return is_inside ? std::optional(std::move(data)) : std::nullopt;
}

/// Reads the next group into `groups`.
bool take_group(Taker& taker, GroupIndexes& groups) {
  GroupHeader header{};
  std::vector<char> name;
  constexpr int kMostNumbers = 1 << 20;
  if (!taker.take(header.data(), header.size()) || header[0] < 0 || header[2] < 1 ||
      header[2] > kMostNumbers || !taker.take(name, static_cast<std::size_t>(header[0]))) {
    return false;
  }
  const int key_size = static_cast<int>(header[2]);
  std::vector<std::shared_ptr<const KeyTree>> trees;
  for (std::int64_t i = 0; i < header[3]; ++i) {
    auto data = take_tree(taker, static_cast<std::size_t>(key_size));
    if (!data) return false;
    trees.push_back(std::make_shared<const KeyTree>(key_size, std::move(*data)));
  }
  groups.emplace(
      RowGroup{std::string(name.begin(), name.end()), std::bit_cast<std::uint64_t>(header[1])},
      ExperienceIndex(key_size, std::move(trees)));
  return true;
}

void append_group(std::string& bytes, const RowGroup& group, const ExperienceIndex& index) {
  const GroupHeader header = {static_cast<std::int64_t>(group.kind.size()),
                              std::bit_cast<std::int64_t>(group.constraints), index.key_size(),
                              static_cast<std::int64_t>(index.trees().size())};
  bytes += bytes_of(header.data(), header.size());
  bytes += group.kind;
  for (const auto& tree : index.trees()) {
    const KeyTreeData& data = tree->data();
    const auto count = static_cast<std::int64_t>(tree->size());
    bytes += bytes_of(&count, 1);
    bytes += bytes_of(data.ids.data(), data.ids.size());
    bytes += bytes_of(data.components.data(), data.components.size());
    bytes += bytes_of(data.order.data(), data.order.size());
    bytes += bytes_of(data.keys.data(), data.keys.size());
  }
}

bool is_of(const Header& header, const RobotSignature& signature) {
  return header[0] == kMagic && header[1] == kVersion && header[2] == kLeaf &&
         header[3] == checksum_of(signature);
}

/// Reads the file if its header fits `signature`; otherwise it may be any large file.
std::string read_index_of(const RobotSignature& signature, const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};  // opening a pipe would wait
  const auto size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  Header header{};
  if (error || size < sizeof header ||
      !file.read(reinterpret_cast<char*>(header.data()), sizeof header) ||
      !is_of(header, signature)) {
    return {};
  }
  std::string bytes(size, '\0');
  file.seekg(0).read(bytes.data(), static_cast<std::streamsize>(size));
  return file ? bytes : std::string();
}

/// The content without its checksum; empty if that does not match.
std::string_view checked(std::string_view bytes) {
  std::int64_t checksum = 0;
  if (bytes.size() < sizeof checksum) return {};
  const std::string_view content = bytes.substr(0, bytes.size() - sizeof checksum);
  std::memcpy(&checksum, content.data() + content.size(), sizeof checksum);
  return hash_bytes(std::as_bytes(std::span(content))) == checksum ? content : std::string_view();
}

}  // namespace

std::string index_file_of(const std::string& url) {
  if (engine_of(url) == Engine::sqlite) return url + ".index";
  const std::string cache = cache_directory();
  if (cache.empty()) return "";
  const std::string name = without_password(url);
  return fmt::format("{}/index-{:016x}", cache,
                     static_cast<std::uint64_t>(hash_bytes(std::as_bytes(std::span(name)))));
}

bool save_index(const std::string& file, const RobotSignature& signature, const StoreState& state,
                const GroupIndexes& groups) {
  if (!kIsLittleEndian) return false;
  Header header = {kMagic, kVersion, kLeaf, checksum_of(signature),
                   static_cast<std::int64_t>(groups.size())};
  std::ranges::copy(to_numbers(state), header.begin() + kOwnNumbers);
  std::string bytes(bytes_of(header.data(), header.size()));
  for (const auto& [group, index] : groups) append_group(bytes, group, index);
  const std::int64_t checksum = hash_bytes(std::as_bytes(std::span(bytes)));
  bytes += bytes_of(&checksum, 1);
  std::error_code ignored;
  const auto directory = std::filesystem::path(file).parent_path();
  if (!directory.empty()) std::filesystem::create_directories(directory, ignored);
  auto written = NewFile::create(file);
  return written && written->write(bytes) && written->finish();
}

std::optional<SavedIndex> load_index(const std::string& file, const RobotSignature& signature) {
  if (!kIsLittleEndian) return std::nullopt;
  const std::string bytes = read_index_of(signature, file);
  Taker taker(checked(bytes));
  Header header{};
  if (!taker.take(header.data(), header.size())) return std::nullopt;
  SavedIndex saved;
  for (std::int64_t i = 0; i < header[4]; ++i) {
    if (!take_group(taker, saved.groups)) return std::nullopt;
  }
  if (!taker.is_empty()) return std::nullopt;
  saved.state = to_state(std::span(header).subspan<kOwnNumbers, kHeadSize>());
  return saved;
}

}  // namespace mneme::internal

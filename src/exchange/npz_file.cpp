// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "exchange/npz_file.h"

#include "base/utf8.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

namespace mneme::internal {
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";

template <class Number>
void swap_to_little_endian([[maybe_unused]] std::string& bytes) {
  if constexpr (std::endian::native == std::endian::big) {
    for (std::size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(Number)));
    }
  }
}

template <class Number>
std::string little_endian(std::span<const Number> numbers) {
  std::string bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
  swap_to_little_endian<Number>(bytes);
  return bytes;
}

template <class Number>
std::vector<Number> numbers_of(std::string bytes) {
  swap_to_little_endian<Number>(bytes);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

/// What follows `key` in the header's dictionary.
std::string_view value_of(std::string_view dictionary, std::string_view key) {
  const std::size_t at = dictionary.find(fmt::format("'{}':", key));
  if (at == std::string_view::npos) return {};
  std::string_view value = dictionary.substr(at + key.size() + 3);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

std::optional<std::vector<std::size_t>> parse_shape(std::string_view text) {
  if (!text.starts_with('(')) return std::nullopt;
  text = text.substr(1, text.find(')') - 1);
  std::vector<std::size_t> shape;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(", "), text.size()));
    if (text.empty()) return shape;
    std::size_t size = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (error != std::errc()) return std::nullopt;
    shape.push_back(size);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

/// Bytes of one element, or 0 of a type that is none of ours.
std::size_t element_size(std::string_view type) {
  if (type.size() < 3 || type[0] != '<') return 0;
  std::size_t size = 0;
  const auto [end, error] = std::from_chars(type.data() + 2, type.data() + type.size(), size);
  if (error != std::errc() || end != type.data() + type.size() || size > 1'000'000) return 0;
  if (type[1] == 'U') return 4 * size;
  return size <= 8 ? size : 0;
}

/// Bytes of an array of `shape`, or nothing if they are too many to count.
std::optional<std::size_t> byte_count(std::size_t element, const std::vector<std::size_t>& shape) {
  std::size_t bytes = element;
  for (const std::size_t size : shape) {
    if (__builtin_mul_overflow(bytes, size, &bytes)) return std::nullopt;
  }
  return bytes;
}

/// The dictionary of a header and what follows it.
std::optional<std::pair<std::string_view, std::string_view>> split(std::string_view file) {
  if (!file.starts_with(kNpyMagic) || file.size() < 12) return std::nullopt;
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(file[i])}; };
  const bool is_first_version = byte(6) == 1;
  const std::size_t begin = is_first_version ? 10 : 12;
  std::size_t size = byte(8) | (byte(9) << 8);
  if (!is_first_version) size |= (byte(10) << 16) | (byte(11) << 24);
  if (byte(6) > 3 || size > file.size() - begin) return std::nullopt;
  return std::pair(file.substr(begin, size), file.substr(begin + size));
}

}  // namespace

std::string npy_header(const NpyArray& array) {
  // The parentheses of a tuple with one element have a comma, those of one with none are empty.
  const std::string shape =
      fmt::format("({}{})", fmt::join(array.shape, ", "), array.shape.size() == 1 ? "," : "");
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", array.type, shape);
  constexpr std::size_t kPrefix = 10;
  constexpr std::size_t kAlignment = 64;
  const std::size_t used = (kPrefix + text.size() + 1) % kAlignment;
  text.append((kAlignment - used) % kAlignment, ' ');
  text += '\n';
  return fmt::format("{}{}{}{}{}{}", kNpyMagic, '\x01', '\0', static_cast<char>(text.size() & 0xff),
                     static_cast<char>(text.size() >> 8), text);
}

Result<NpyArray> parse_npy(std::string_view file) {
  const auto parts = split(file);
  if (!parts) return fail(ErrorCode::parse, "is no NumPy array");
  const auto& [dictionary, bytes] = *parts;
  NpyArray array;
  std::string_view type = value_of(dictionary, "descr");
  if (type.starts_with('\'')) array.type = type.substr(1, type.find('\'', 1) - 1);
  const auto shape = parse_shape(value_of(dictionary, "shape"));
  const std::size_t element = element_size(array.type);
  if (!shape || element == 0) {
    return fail(ErrorCode::parse, fmt::format("has a header that says '{}'; expected a "
                                              "little-endian array of numbers or texts",
                                              storable_text(dictionary)));
  }
  array.shape = *shape;
  if (array.shape.size() > 1 && !value_of(dictionary, "fortran_order").starts_with("False")) {
    return fail(ErrorCode::parse, "is in Fortran order; expected C order");
  }
  if (byte_count(element, array.shape) != bytes.size()) {
    return fail(ErrorCode::parse,
                fmt::format("holds {} bytes, which is not what its shape says", bytes.size()));
  }
  array.bytes = bytes;
  return array;
}

template <class Number>
NpyArray to_npy(std::span<const Number> numbers, std::vector<std::size_t> shape) {
  return {kNpyType<Number>, std::move(shape), little_endian(numbers)};
}

template <class Number>
std::vector<Number> from_npy(const NpyArray& array) {
  if (array.type != kNpyType<Number>) return {};
  return numbers_of<Number>(array.bytes);
}

template NpyArray to_npy(std::span<const double>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const float>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::int32_t>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::int64_t>, std::vector<std::size_t>);
template NpyArray to_npy(std::span<const std::uint64_t>, std::vector<std::size_t>);
template std::vector<double> from_npy(const NpyArray&);
template std::vector<float> from_npy(const NpyArray&);
template std::vector<std::int32_t> from_npy(const NpyArray&);
template std::vector<std::int64_t> from_npy(const NpyArray&);
template std::vector<std::uint64_t> from_npy(const NpyArray&);

NpyArray to_npy(std::span<const std::string> texts) {
  std::vector<std::u32string> decoded;
  std::size_t width = 1;
  for (const std::string& text : texts) {
    decoded.push_back(decode_utf8(text).value_or(U""));
    width = std::max(width, decoded.back().size());
  }
  std::vector<std::uint32_t> points;
  points.reserve(width * texts.size());
  for (const std::u32string& text : decoded) {
    points.insert(points.end(), text.begin(), text.end());
    points.resize(points.size() + width - text.size());
  }
  return {fmt::format("<U{}", width),
          {texts.size()},
          little_endian(std::span<const std::uint32_t>(points))};
}

Result<std::vector<std::string>> texts_of(const NpyArray& array) {
  std::vector<std::string> texts;
  if (!array.type.starts_with("<U")) return texts;
  const auto points = numbers_of<std::uint32_t>(array.bytes);
  const std::size_t width = element_size(array.type) / 4;
  for (std::size_t begin = 0; width > 0 && begin < points.size(); begin += width) {
    std::u32string text(points.begin() + static_cast<std::ptrdiff_t>(begin),
                        points.begin() + static_cast<std::ptrdiff_t>(begin + width));
    text.resize(text.find_last_not_of(U'\0') + 1);
    auto encoded = encode_utf8(text);
    if (!encoded) {
      return fail(ErrorCode::parse, fmt::format("has a text {} that is no Unicode", begin / width));
    }
    texts.push_back(std::move(*encoded));
  }
  return texts;
}

namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50;
constexpr std::uint32_t kDirectoryEntry = 0x02014b50;
constexpr std::uint32_t kEnd = 0x06054b50;
constexpr std::uint32_t kEnd64 = 0x06064b50;
constexpr std::uint32_t kEnd64Locator = 0x07064b50;
constexpr std::uint16_t kVersion64 = 45;
constexpr std::uint16_t kZip64Field = 1;
constexpr std::uint16_t kFirstOf1980 = 0x21;
constexpr std::uint32_t kIn64 = 0xffffffff;  ///< the number stands in the field for zip64

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) * 0xedb88320U);
    table[i] = value;
  }
  return table;
}

/// Little-endian numbers one after the other.
class Record {
 public:
  template <class... Numbers>
  explicit Record(Numbers... numbers) {
    (append(numbers), ...);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class Number>
  void append(Number number) {
    for (std::size_t i = 0; i < sizeof number; ++i) {
      text_ += static_cast<char>((number >> (8 * i)) & 0xff);
    }
  }
  std::string text_;
};

/// Reads little-endian numbers; beyond the end there are only zeros, and `is_sound` is false.
class Cursor {
 public:
  Cursor(std::string_view bytes, std::uint64_t offset) : bytes_(bytes), offset_(offset) {}

  template <class Number>
  Number next() {
    const std::string_view piece = skip(sizeof(Number));
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      number |= std::uint64_t{static_cast<unsigned char>(piece[i])} << (8 * i);
    }
    return static_cast<Number>(number);
  }
  std::string_view skip(std::uint64_t size) {
    if (!is_sound_ || offset_ > bytes_.size() || size > bytes_.size() - offset_) {
      is_sound_ = false;
      return {};
    }
    const std::string_view piece = bytes_.substr(offset_, size);
    offset_ += size;
    return piece;
  }
  [[nodiscard]] bool is_sound() const { return is_sound_; }

 private:
  std::string_view bytes_;
  std::uint64_t offset_;
  bool is_sound_ = true;
};

struct Member {
  std::string name;
  std::uint16_t method = 0;
  std::uint32_t crc = 0;
  std::uint64_t stored_size = 0;
  std::uint64_t size = 0;
  std::uint64_t offset = 0;
};

struct Directory {
  std::uint64_t count = 0;
  std::uint64_t offset = 0;
};

std::optional<Directory> find_directory(std::string_view archive) {
  constexpr std::size_t kEndSize = 22;
  constexpr std::size_t kLocatorSize = 20;
  const std::size_t at = archive.rfind(Record(kEnd).text());
  if (at == std::string_view::npos || archive.size() - at < kEndSize) return std::nullopt;
  Cursor end(archive, at + 10);
  Directory directory;
  directory.count = end.next<std::uint16_t>();
  end.skip(4);
  directory.offset = end.next<std::uint32_t>();
  if (directory.count != 0xffff && directory.offset != kIn64) return directory;
  if (at < kLocatorSize) return std::nullopt;
  Cursor locator(archive, at - kLocatorSize);
  if (locator.next<std::uint32_t>() != kEnd64Locator) return std::nullopt;
  locator.skip(4);
  Cursor end64(archive, locator.next<std::uint64_t>());
  if (end64.next<std::uint32_t>() != kEnd64) return std::nullopt;
  end64.skip(28);
  directory.count = end64.next<std::uint64_t>();
  end64.skip(8);
  directory.offset = end64.next<std::uint64_t>();
  return end64.is_sound() ? std::optional(directory) : std::nullopt;
}

/// Fills in the numbers that stand in the field for zip64.
void read_extra(std::string_view extra, Member& member) {
  Cursor cursor(extra, 0);
  while (true) {
    const auto id = cursor.next<std::uint16_t>();
    const std::string_view field = cursor.skip(cursor.next<std::uint16_t>());
    if (!cursor.is_sound()) return;
    if (id != kZip64Field) continue;
    Cursor numbers(field, 0);
    for (std::uint64_t* number : {&member.size, &member.stored_size, &member.offset}) {
      if (*number == kIn64) *number = numbers.next<std::uint64_t>();
    }
  }
}

std::optional<Member> read_entry(Cursor& cursor) {
  if (cursor.next<std::uint32_t>() != kDirectoryEntry) return std::nullopt;
  cursor.skip(6);
  Member member;
  member.method = cursor.next<std::uint16_t>();
  cursor.skip(4);
  member.crc = cursor.next<std::uint32_t>();
  member.stored_size = cursor.next<std::uint32_t>();
  member.size = cursor.next<std::uint32_t>();
  const auto name_size = cursor.next<std::uint16_t>();
  const auto extra_size = cursor.next<std::uint16_t>();
  const auto comment_size = cursor.next<std::uint16_t>();
  cursor.skip(8);
  member.offset = cursor.next<std::uint32_t>();
  member.name = cursor.skip(name_size);
  read_extra(cursor.skip(extra_size), member);
  cursor.skip(comment_size);
  return cursor.is_sound() ? std::optional(member) : std::nullopt;
}

/// The bytes of a member, or nothing if they are not where and what the directory says.
std::optional<std::string_view> read_member(std::string_view archive, const Member& member) {
  Cursor cursor(archive, member.offset);
  if (cursor.next<std::uint32_t>() != kLocalHeader) return std::nullopt;
  cursor.skip(22);
  const auto name_size = cursor.next<std::uint16_t>();
  const auto extra_size = cursor.next<std::uint16_t>();
  cursor.skip(std::uint64_t{name_size} + extra_size);
  const std::string_view bytes = cursor.skip(member.size);
  if (!cursor.is_sound() || crc32(bytes) != member.crc) return std::nullopt;
  return bytes;
}

}  // namespace

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
  static constexpr auto kTable = make_crc_table();
  std::uint32_t crc = ~before;
  for (const char c : bytes)
    crc = (crc >> 8) ^ kTable[(crc ^ static_cast<unsigned char>(c)) & 0xff];
  return ~crc;
}

Result<void> ZipWriter::add(const std::string& name, std::string_view head, std::string_view body) {
  constexpr std::uint16_t kStored = 0;
  const std::uint32_t crc = crc32(body, crc32(head));
  const std::uint64_t size = head.size() + body.size();
  const auto name_size = static_cast<std::uint16_t>(name.size());
  const std::string header =
      Record(kLocalHeader, kVersion64, std::uint16_t{0}, kStored, std::uint16_t{0}, kFirstOf1980,
             crc, kIn64, kIn64, name_size, std::uint16_t{20})
          .text() +
      name + Record(kZip64Field, std::uint16_t{16}, size, size).text();
  directory_ +=
      Record(kDirectoryEntry, kVersion64, kVersion64, std::uint16_t{0}, kStored, std::uint16_t{0},
             kFirstOf1980, crc, kIn64, kIn64, name_size, std::uint16_t{28}, std::uint16_t{0},
             std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0}, kIn64)
          .text() +
      name + Record(kZip64Field, std::uint16_t{24}, size, size, offset_).text();
  offset_ += header.size() + size;
  ++count_;
  return file_.write(header).and_then([&] { return file_.write(head); }).and_then([&] {
    return file_.write(body);
  });
}

Result<void> ZipWriter::finish() {
  const std::uint64_t size = directory_.size();
  const std::string end =
      Record(kEnd64, std::uint64_t{44}, kVersion64, kVersion64, std::uint32_t{0}, std::uint32_t{0},
             count_, count_, size, offset_, kEnd64Locator, std::uint32_t{0}, offset_ + size,
             std::uint32_t{1}, kEnd, std::uint16_t{0xffff}, std::uint16_t{0xffff},
             std::uint16_t{0xffff}, std::uint16_t{0xffff}, kIn64, kIn64, std::uint16_t{0})
          .text();
  return file_.write(directory_).and_then([&] { return file_.write(end); });
}

Result<std::map<std::string, std::string_view>> read_zip(const std::string& path,
                                                         std::string_view archive) {
  const auto directory = find_directory(archive);
  if (!directory) return fail(ErrorCode::parse, fmt::format("{}: is no zip archive", path));
  std::map<std::string, std::string_view> members;
  Cursor cursor(archive, directory->offset);
  std::uint64_t unclaimed = archive.size();
  for (std::uint64_t i = 0; i < directory->count; ++i) {
    const auto member = read_entry(cursor);
    if (!member) {
      return fail(ErrorCode::parse, fmt::format("{}: its directory is damaged", path));
    }
    if (member->method != 0 || member->size != member->stored_size) {
      return fail(ErrorCode::unsupported,
                  fmt::format("{}: '{}' is compressed; expected what numpy.savez() writes, not "
                              "numpy.savez_compressed()",
                              path, member->name));
    }
    // Members that share their bytes could make a small archive a huge one.
    if (member->size > unclaimed) {
      return fail(ErrorCode::parse, fmt::format("{}: its members hold more than it has", path));
    }
    unclaimed -= member->size;
    const auto bytes = read_member(archive, *member);
    if (!bytes)
      return fail(ErrorCode::parse, fmt::format("{}: '{}' is damaged", path, member->name));
    members.emplace(member->name, *bytes);
  }
  return members;
}

}  // namespace mneme::internal

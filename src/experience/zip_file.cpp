// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/zip_file.h"

#include <fmt/format.h>

#include <array>
#include <optional>

// Names and layouts are those of PKWARE's APPNOTE.TXT 6.3.
namespace mneme::internal {
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

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "upkeep/page_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <optional>
#include <system_error>

namespace mneme::internal {
namespace {

using Bytes = std::span<const std::byte>;

constexpr auto kTableLeaf = std::byte{0x0d};
constexpr std::size_t kLeafHeader = 8;

tl::unexpected<Error> refuse(const std::string& path) {
  return fail(ErrorCode::io,
              fmt::format("{}: cannot be read: {}", path, std::generic_category().message(errno)));
}

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8 | std::to_integer<std::uint64_t>(byte);
  return value;
}

std::int64_t signed_big_endian(Bytes bytes) {
  if (bytes.empty()) return 0;
  const unsigned unused = 64 - 8 * static_cast<unsigned>(bytes.size());
  return std::bit_cast<std::int64_t>(big_endian(bytes) << unused) >> unused;
}

/// Takes a number of one to nine bytes off the front of `bytes`.
std::optional<std::uint64_t> take_varint(Bytes& bytes) {
  constexpr std::size_t kLongest = 9;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < std::min(kLongest, bytes.size()); ++i) {
    const auto byte = std::to_integer<std::uint64_t>(bytes[i]);
    const bool is_ninth = i + 1 == kLongest;
    value = is_ninth ? value << 8 | byte : value << 7 | (byte & 0x7f);
    if (is_ninth || byte < 0x80) {
      bytes = bytes.subspan(i + 1);
      return value;
    }
  }
  return std::nullopt;
}

/// Takes the value of a serial type off the front of `body`.
std::optional<Field> take_field(std::uint64_t type, Bytes& body) {
  constexpr std::array<std::size_t, 8> kNumberSizes = {0, 1, 2, 3, 4, 6, 8, 8};
  constexpr std::uint64_t kReal = 7;
  constexpr std::uint64_t kZero = 8;
  constexpr std::uint64_t kFirstBytes = 12;
  Field field;
  if (type == kZero || type == kZero + 1) {
    field.kind = Field::Kind::integer;
    field.integer = static_cast<std::int64_t>(type - kZero);
    return field;
  }
  if (type > kZero && type < kFirstBytes) return std::nullopt;
  const std::uint64_t size = type < kZero ? kNumberSizes[type] : (type - kFirstBytes) / 2;
  if (size > body.size()) return std::nullopt;
  field.bytes = body.first(static_cast<std::size_t>(size));
  body = body.subspan(static_cast<std::size_t>(size));
  if (type >= kFirstBytes) {
    field.kind = type % 2 == 0 ? Field::Kind::blob : Field::Kind::text;
  } else if (type == kReal) {
    field.kind = Field::Kind::real;
  } else if (type != 0) {
    field.kind = Field::Kind::integer;
    field.integer = signed_big_endian(field.bytes);
  }
  return field;
}

bool split_payload(LeafRecord& record) {
  record.fields.clear();
  Bytes types = record.payload;
  const auto header_size = take_varint(types);
  if (!header_size || *header_size > record.payload.size()) return false;
  const std::size_t length_size = record.payload.size() - types.size();
  if (*header_size < length_size) return false;
  Bytes body = Bytes(record.payload).subspan(static_cast<std::size_t>(*header_size));
  types = types.first(static_cast<std::size_t>(*header_size) - length_size);
  while (!types.empty()) {
    const auto type = take_varint(types);
    if (!type) return false;
    const auto field = take_field(*type, body);
    if (!field) return false;
    record.fields.push_back(*field);
  }
  return true;
}

/// How much of a record of `size` bytes stands in the leaf itself.
std::size_t size_in_leaf(std::size_t size, std::size_t page_size) {
  const std::size_t most = page_size - 35;
  if (size <= most) return size;
  const std::size_t least = (page_size - 12) * 32 / 255 - 23;
  const std::size_t rest = least + (size - least) % (page_size - 4);
  return rest <= most ? rest : least;
}

}  // namespace

void PageFile::Close::operator()(const int* file) const {
  (void)::close(*file);
  delete file;
}

Result<PageFile> PageFile::open(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return refuse(path);
  PageFile pages;
  pages.path_ = path;
  pages.file_.reset(new int(file));
  struct stat status {};
  if (::fstat(file, &status) != 0) return refuse(path);
  pages.bytes_ = status.st_size;
  const auto has_first = pages.read_page(1, pages.leaf_);
  if (!has_first) return tl::unexpected(has_first.error());
  if (*has_first) {
    const auto named = static_cast<std::size_t>(big_endian(Bytes(pages.leaf_).subspan(16, 2)));
    // One is SQLite's way of writing 65536.
    const std::size_t size = named == 1 ? 65536 : named;
    if (size >= 512 && std::has_single_bit(size)) pages.page_size_ = size;
  }
  return pages;
}

Result<bool> PageFile::read_page(std::int64_t page, std::vector<std::byte>& bytes) {
  const auto size = static_cast<std::int64_t>(page_size_);
  if (page < 1 || page > (bytes_ + size - 1) / size) return false;
  bytes.assign(page_size_, std::byte{0});
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = ::pread(*file_, bytes.data() + filled, bytes.size() - filled,
                                  (page - 1) * size + static_cast<std::int64_t>(filled));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return refuse(path_);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  return true;
}

int PageFile::cell_count() const {
  const Bytes header = Bytes(leaf_).subspan(header_at(), kLeafHeader);
  if (header[0] != kTableLeaf) return -1;
  const std::size_t room = (leaf_.size() - header_at() - kLeafHeader) / 2;
  return static_cast<int>(
      std::min(static_cast<std::size_t>(big_endian(header.subspan(3, 2))), room));
}

Result<bool> PageFile::read_overflow(std::int64_t page, std::size_t size, LeafRecord& record) {
  constexpr std::size_t kLink = 4;
  while (record.payload.size() < size) {
    // Many records that share a chain, or chains that bite their tails, must not take for ever.
    overflow_budget_ -= static_cast<std::int64_t>(page_size_);
    if (overflow_budget_ < 0) return false;
    const auto has_page = read_page(page, overflow_);
    if (!has_page) return has_page;
    if (!*has_page) return false;
    const std::size_t missing = size - record.payload.size();
    const Bytes content = Bytes(overflow_).subspan(kLink, std::min(missing, page_size_ - kLink));
    record.payload.insert(record.payload.end(), content.begin(), content.end());
    page = static_cast<std::int64_t>(big_endian(Bytes(overflow_).first(kLink)));
  }
  return true;
}

Result<bool> PageFile::read_cell(int cell, LeafRecord& record) {
  const std::size_t pointer = header_at() + kLeafHeader + 2 * static_cast<std::size_t>(cell);
  const auto at = static_cast<std::size_t>(big_endian(Bytes(leaf_).subspan(pointer, 2)));
  if (at >= leaf_.size()) return false;
  Bytes rest = Bytes(leaf_).subspan(at);
  const auto size = take_varint(rest);
  if (!size) return false;
  const auto id = take_varint(rest);
  // No record is longer than the file, whatever it claims.
  if (!id || *size > static_cast<std::uint64_t>(bytes_)) return false;
  record.id = std::bit_cast<std::int64_t>(*id);
  const auto total = static_cast<std::size_t>(*size);
  const std::size_t local = size_in_leaf(total, page_size_);
  const std::size_t link = local < total ? 4 : 0;
  if (rest.size() < local + link) return false;
  record.payload.assign(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(local));
  const auto next = static_cast<std::int64_t>(big_endian(rest.subspan(local, link)));
  const auto is_whole = read_overflow(next, total, record);
  if (!is_whole || !*is_whole) return is_whole;
  return split_payload(record);
}

Result<void> PageFile::visit_records(const Visitor& visit) {
  constexpr std::int64_t kPatience = 16;
  overflow_budget_ = kPatience * bytes_;
  LeafRecord record;
  for (leaf_page_ = 1;; ++leaf_page_) {
    const auto has_page = read_page(leaf_page_, leaf_);
    if (!has_page) return tl::unexpected(has_page.error());
    if (!*has_page) return {};
    const int count = cell_count();
    for (int cell = 0; cell < count; ++cell) {
      const auto is_record = read_cell(cell, record);
      if (!is_record) return tl::unexpected(is_record.error());
      if (*is_record) visit(record, {leaf_page_, cell});
    }
  }
}

Result<void> PageFile::read_record(RecordPlace place, LeafRecord& record) {
  if (leaf_page_ != place.page) {
    leaf_page_ = place.page;
    const auto has_page = read_page(place.page, leaf_);
    if (!has_page) return tl::unexpected(has_page.error());
    if (!*has_page) leaf_.assign(page_size_, std::byte{0});
  }
  // What was visited is not refused the second time.
  overflow_budget_ = 2 * (bytes_ + static_cast<std::int64_t>(page_size_));
  const auto is_record = place.cell < cell_count() ? read_cell(place.cell, record) : false;
  if (!is_record) return tl::unexpected(is_record.error());
  if (*is_record) return {};
  return fail(ErrorCode::corrupt,
              fmt::format("{}: page {} has no record {}", path_, place.page, place.cell));
}

}  // namespace mneme::internal

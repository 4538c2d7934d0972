// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/lost_rows.h"

#include "base/text.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/xattr.h>
#endif
#include <array>
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

namespace mneme::internal {
namespace {

using Bytes = std::span<const std::byte>;

/// "mneme ta" and the version of the layout; then the state, the time, 1 if settled, a checksum.
constexpr std::int64_t kRecordMagic = 0x6d6e656d65207461, kRecordVersion = 2;
constexpr std::size_t kRecordSize = 2 + kHeadSize + 3;
using Record = std::array<std::int64_t, kRecordSize>;

Record to_record(const StateRecord& content) {
  Record record{kRecordMagic, kRecordVersion};
  std::ranges::copy(to_numbers(content.state), record.begin() + 2);
  record[kRecordSize - 3] = content.time;
  record[kRecordSize - 2] = content.is_settled ? 1 : 0;
  record.back() = hash_numbers(std::span(record).first<kRecordSize - 1>());
  return record;
}

/// Nothing if the record is damaged.
std::optional<StateRecord> to_content(const Record& record) {
  StateRecord content;
  content.state = to_state(std::span(record).subspan<2, kHeadSize>());
  content.time = record[kRecordSize - 3];
  content.is_settled = record[kRecordSize - 2] == 1;
  return record == to_record(content) ? std::optional(content) : std::nullopt;
}

/// Closes a file descriptor.
struct Descriptor {
  int fd = -1;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

/// True if a record cannot be an earlier state of a file with the head `head`. The epoch of a file
/// begins with the time of its creation in microseconds and counts up by one.
bool is_of_another(const StoreState& record, const StoreState& head) {
  constexpr std::uint64_t kMostSteps = 100;
  const auto first = static_cast<std::uint64_t>(std::min(record.epoch, head.epoch));
  const auto last = static_cast<std::uint64_t>(std::max(record.epoch, head.epoch));
  if (last - first > kMostSteps) return true;
  if (record.epoch != head.epoch || record.generation > head.generation) return false;
  return record.generation == head.generation
             ? record != head
             : record.last_row > head.last_row || record.last_tombstone > head.last_tombstone;
}

}  // namespace

std::string real_path(const std::string& path) {
  std::error_code error;
  const auto file = std::filesystem::canonical(path, error);
  return error ? path : file.string();
}

std::string record_path(const std::string& path) { return real_path(path) + ".tally"; }

std::string log_path(const std::string& path) { return real_path(path) + "-wal"; }

namespace {

#ifdef __linux__

constexpr const char* kAttribute = "user.mneme.tally";

/// By path: opening and closing the file would drop this process's locks on it.
void write_attribute(const std::string& file, const Record& record) {
  std::string value(reinterpret_cast<const char*>(record.data()), sizeof record);
  value += file;
  (void)::setxattr(file.c_str(), kAttribute, value.data(), value.size(), 0);
}

/// The record in the attribute of a file that was renamed since; nothing if it was not.
std::optional<StateRecord> read_former_record(const std::string& file) {
  constexpr std::size_t kMostBytes = 65536;  // Linux allows no more
  std::string value(kMostBytes, '\0');
  Record record{};
  const ssize_t size = ::getxattr(file.c_str(), kAttribute, value.data(), value.size());
  if (size <= ssize_t{sizeof record}) return std::nullopt;
  value.resize(static_cast<std::size_t>(size));
  std::memcpy(record.data(), value.data(), sizeof record);
  auto content = to_content(record);
  if (content) content->former_path = value.substr(sizeof record);
  return content && content->former_path != file ? content : std::nullopt;
}

#else

void write_attribute(const std::string&, const Record&) {}
std::optional<StateRecord> read_former_record(const std::string&) { return std::nullopt; }

#endif

void write_record(const std::string& path, const StateRecord& content) {
  const Record record = to_record(content);
  write_attribute(real_path(path), record);
  const Descriptor file(
      ::open(record_path(path).c_str(), O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644));
  if (file.fd >= 0) (void)!::pwrite(file.fd, record.data(), sizeof record, 0);
}

}  // namespace

void record_state(const std::string& path, const StoreState& state) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  write_record(path, {state, now / std::chrono::seconds(1)});
}

void settle_record(const std::string& path) {
  std::error_code error;
  auto record = read_record(path);
  if (!record || record->is_settled || std::filesystem::exists(log_path(path), error)) return;
  record->is_settled = true;
  write_record(path, *record);
}

std::optional<StateRecord> read_record(const std::string& path) {
  if (auto former = read_former_record(real_path(path))) return former;
  const Descriptor file(::open(record_path(path).c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  Record record{};
  if (file.fd < 0 || ::pread(file.fd, record.data(), sizeof record, 0) != ssize_t{sizeof record}) {
    return std::nullopt;
  }
  return to_content(record);
}

std::optional<std::string> describe_unusable_record(const std::string& path,
                                                    const std::optional<StateRecord>& record,
                                                    const StoreState* head) {
  const std::string file = record_path(path);
  if (record) {
    const bool is_foreign = head != nullptr && is_of_another(record->state, *head);
    const std::string place = record->former_path.empty() ? file : "the attribute of " + path;
    return is_foreign ? std::optional(place + " is of another database") : std::nullopt;
  }
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return std::nullopt;
  if (size == 0) return file + " is empty";
  if (size == sizeof(Record)) return file + " is damaged";
  return fmt::format("{} is damaged: it has {} bytes, expected {}", file, size, sizeof(Record));
}

namespace {

/// Where the rows of a file that was renamed or copied may be, and the way out.
std::string describe_former_log(const std::string& path, const std::string& former_path) {
  const std::string log = former_path + "-wal";
  std::error_code error;
  const auto size = std::filesystem::file_size(log, error);
  if (error || size == 0) {
    return fmt::format("when the file was {}, whose log {} is gone", former_path, log);
  }
  const std::string way_out =
      std::filesystem::exists(former_path, error)
          ? fmt::format("copy both {} and the log while no program uses them", former_path)
          : fmt::format("rename {} to {}, too, or rename the file back", log, log_path(path));
  return fmt::format("when the file was {}: its log may hold them; {}", former_path, way_out);
}

}  // namespace

std::optional<std::string> describe_missing_rows(const std::string& path,
                                                 const std::optional<StateRecord>& record,
                                                 const StoreState& head) {
  if (!record || head.generation >= record->state.generation) return std::nullopt;
  const std::string where = record->former_path.empty()
                                ? fmt::format("(according to {})", record_path(path))
                                : describe_former_log(path, record->former_path);
  return fmt::format(
      "{} rows that were stored are missing: the file holds {} changes, but {} were stored until "
      "{} {}",
      std::max(std::int64_t{0}, record->state.row_count - head.row_count), head.generation,
      record->state.generation, utc_text(record->time), where);
}

namespace {

std::uint32_t big_endian(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  }
  return value;
}

/// Reads the numbers of a record in SQLite's file format (www.sqlite.org/fileformat2.html, 2.1).
class RecordReader {
 public:
  explicit RecordReader(Bytes bytes) : rest_(bytes) {}

  /// A varint; 0 at the end.
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int i = 0; i < 9 && !rest_.empty(); ++i) {
      const auto byte = std::to_integer<std::uint64_t>(take(1)[0]);
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if (byte < 0x80) return value;
    }
    return value;
  }
  /// An integer of a serial type; nothing for another type, or beyond the end.
  std::optional<std::int64_t> integer(std::uint64_t serial_type) {
    if (serial_type == 8 || serial_type == 9) return static_cast<std::int64_t>(serial_type - 8);
    constexpr std::array<std::size_t, 7> kSizes = {0, 1, 2, 3, 4, 6, 8};
    if (serial_type >= kSizes.size() || rest_.size() < kSizes[serial_type]) return std::nullopt;
    const Bytes bytes = take(kSizes[serial_type]);
    const bool is_negative = !bytes.empty() && (bytes[0] & std::byte{0x80}) != std::byte{0};
    std::uint64_t value = is_negative ? ~std::uint64_t{0} : 0;
    for (const std::byte byte : bytes) value = value << 8 | std::to_integer<std::uint64_t>(byte);
    return std::bit_cast<std::int64_t>(value);
  }

 private:
  Bytes take(std::size_t count) {
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  Bytes rest_;
};

/// The state in a page of the table `head`; nothing for any other page, which its checksum tells.
std::optional<StoreState> head_in(Bytes page) {
  constexpr std::byte kLeaf{0x0d};
  constexpr std::size_t kHeader = 8;
  const std::uint32_t cells = big_endian(page, 1) & 0xffff;  // bytes 3 and 4
  if (page[0] != kLeaf || cells != 1) return std::nullopt;
  const std::size_t begin = big_endian(page, kHeader) >> 16;
  if (begin >= page.size()) return std::nullopt;
  RecordReader cell(page.subspan(begin));
  (void)cell.varint();  // payload size
  (void)cell.varint();  // rowid
  (void)cell.varint();  // header size
  std::array<std::uint64_t, 1 + kHeadSize + 1> types{};
  for (std::uint64_t& type : types) type = cell.varint();
  std::array<std::int64_t, types.size()> values{};
  for (std::size_t i = 0; i < types.size(); ++i) {
    const auto value = cell.integer(types[i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  const auto numbers = std::span(values).subspan<1, kHeadSize>();
  if (hash_numbers(numbers) != values.back()) return std::nullopt;
  return to_state(numbers);
}

/// The checksum of a write-ahead log (www.sqlite.org/fileformat2.html, 4.2), chained over frames.
class LogChecksum {
 public:
  explicit LogChecksum(bool is_big_endian) : is_big_endian_(is_big_endian) {}
  void add(Bytes bytes) {
    for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
      s0_ += word(bytes, i) + s1_;
      s1_ += word(bytes, i + 4) + s0_;
    }
  }
  [[nodiscard]] bool is_stored_in(Bytes bytes, std::size_t at) const {
    return big_endian(bytes, at) == s0_ && big_endian(bytes, at + 4) == s1_;
  }

 private:
  [[nodiscard]] std::uint32_t word(Bytes bytes, std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    const bool is_native = is_big_endian_ == (std::endian::native == std::endian::big);
    return is_native ? value : __builtin_bswap32(value);
  }
  bool is_big_endian_;
  std::uint32_t s0_ = 0, s1_ = 0;
};

/// Transactions in a log: up to its first damaged part, and behind that.
struct LogScan {
  std::optional<std::size_t> damage;     ///< offset of the damaged part
  std::int64_t lost_transactions = 0;    ///< behind the damage
  std::optional<StoreState> kept, lost;  ///< last states before and behind the damage
};

class LogScanner {
 public:
  /// `page_size` is the database's.
  LogScanner(std::istream& log, std::size_t page_size) : log_(log), frame_(kFrame + page_size) {}

  LogScan scan() {
    std::array<std::byte, kHeader> header{};
    if (!read(header)) return {};
    const std::uint32_t magic = big_endian(header, 0);
    constexpr std::uint32_t kMagic = 0x377f0682;
    LogChecksum checksum((magic & 1) != 0);
    checksum.add(Bytes(header).first(24));
    LogScan scan;
    if ((magic & ~1U) != kMagic || !checksum.is_stored_in(header, 24)) scan.damage = 0;
    std::copy_n(header.begin() + 16, kSalts, salts_.begin());
    for (std::size_t offset = kHeader; read(frame_); offset += frame_.size()) {
      if (!scan.damage && !is_next(checksum)) scan.damage = offset;
      // Without a sound header, the first frame tells which frames belong together.
      if (scan.damage == 0 && offset == kHeader) std::copy_n(salts(), kSalts, salts_.begin());
      if (std::equal(salts_.begin(), salts_.end(), salts())) count(scan);
    }
    return scan;
  }

 private:
  static constexpr std::size_t kHeader = 32, kFrame = 24, kSalts = 8;

  template <class Buffer>
  bool read(Buffer& buffer) {
    return static_cast<bool>(log_.read(reinterpret_cast<char*>(buffer.data()),
                                       static_cast<std::streamsize>(buffer.size())));
  }
  [[nodiscard]] const std::byte* salts() const { return frame_.data() + 8; }

  bool is_next(LogChecksum& checksum) const {
    checksum.add(Bytes(frame_).first(8));
    checksum.add(Bytes(frame_).subspan(kFrame));
    return std::equal(salts_.begin(), salts_.end(), salts()) && checksum.is_stored_in(frame_, 16);
  }

  void count(LogScan& scan) {
    const auto head = head_in(Bytes(frame_).subspan(kFrame));
    if (head) (scan.damage ? scan.lost : uncommitted_) = head;
    const bool is_commit = big_endian(frame_, 4) != 0;
    if (!is_commit) return;
    if (scan.damage) {
      ++scan.lost_transactions;
    } else if (uncommitted_) {
      scan.kept = uncommitted_;
    }
  }

  std::istream& log_;
  std::vector<std::byte> frame_;
  std::array<std::byte, kSalts> salts_{};
  std::optional<StoreState> uncommitted_;
};

/// The page size of a database file, and the state in its head where its log has none.
struct FileHead {
  std::size_t page_size = 0;  ///< 0: not readable
  std::optional<StoreState> state;
};

FileHead read_file_head(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<std::byte, 20> header{};
  if (!file.read(reinterpret_cast<char*>(header.data()), header.size())) return {};
  const std::uint32_t stored = big_endian(header, 16) >> 16;
  FileHead head{stored == 1 ? std::size_t{65536} : std::size_t{stored}, {}};
  if (head.page_size < 512) return {};
  // The table is among the first that were created.
  constexpr int kPages = 32;
  std::vector<std::byte> page(head.page_size);
  file.seekg(0);
  for (int i = 0; i < kPages && !head.state; ++i) {
    if (!file.read(reinterpret_cast<char*>(page.data()), std::ssize(page))) break;
    head.state = head_in(page);
  }
  return head;
}

std::string read_prefix(const std::string& path) {
  std::string prefix(32, '\0');
  std::ifstream(path, std::ios::binary).read(prefix.data(), std::ssize(prefix));
  return prefix;
}

/// A scan that shows damage with lost transactions twice. A writer's work looks like damage while
/// it is under way, but not for long.
LogScan confirmed_scan(const std::string& log, std::size_t page_size) {
  constexpr int kTries = 5;
  LogScan last;
  std::string last_prefix;
  for (int i = 0; i < kTries; ++i) {
    const std::string prefix = read_prefix(log);
    std::ifstream stream(log, std::ios::binary);
    const LogScan scan = LogScanner(stream, page_size).scan();
    if (scan.lost_transactions < 2) return {};
    if (i > 0 && scan.damage == last.damage && prefix == last_prefix) return scan;
    last = scan;
    last_prefix = prefix;
  }
  return {};
}

}  // namespace

std::optional<std::string> describe_damaged_log(const std::string& path,
                                                const std::optional<StateRecord>& record) {
  const std::string log = log_path(path);
  const FileHead file = read_file_head(path);
  if (file.page_size == 0) return std::nullopt;
  const LogScan scan = confirmed_scan(log, file.page_size);
  const bool is_accepted = record && scan.lost && record->state.epoch > scan.lost->epoch;
  if (scan.lost_transactions == 0 || is_accepted) return std::nullopt;
  const auto& kept = scan.kept ? scan.kept : file.state;
  const std::string rows = scan.lost && kept
                               ? fmt::format("{} rows", scan.lost->row_count - kept->row_count)
                               : "an unknown number of rows";
  return fmt::format(
      "{} that were stored in {} transactions are lost: the log {} is damaged at byte {}", rows,
      scan.lost_transactions, log, *scan.damage);
}

}  // namespace mneme::internal

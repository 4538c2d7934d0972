// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "exchange/npz_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

namespace mneme::internal {
namespace {

constexpr std::int64_t kNpzFormat = 2;

template <class Number>
NpyArray list_of(const std::vector<Number>& numbers) {
  return to_npy(std::span<const Number>(numbers), {numbers.size()});
}

template <class Number>
NpyArray table_of(const std::vector<Number>& numbers, std::size_t width) {
  return to_npy(std::span<const Number>(numbers), {numbers.size() / width, width});
}

NpyArray number_of(std::int64_t number) {
  return to_npy(std::span<const std::int64_t>(&number, 1), {});
}

NpyArray text_of(const std::string& text) {
  NpyArray array = to_npy(std::span(&text, 1));
  array.shape.clear();
  return array;
}

/// Takes arrays by name; the first thing that is wrong stays as `error`.
class Arrays {
 public:
  explicit Arrays(const std::map<std::string, NpyArray>& arrays) : arrays_(arrays) {
    for (const auto& entry : arrays) text_allowance_ += kTextPerByte * entry.second.bytes.size();
  }

  /// Numbers of an array with `dimensions` dimensions, the first of `size` unless that is
  /// kAnySize; `width` receives the second.
  template <class Number>
  std::vector<Number> numbers(const char* name, std::size_t dimensions, std::size_t size,
                              std::size_t* width = nullptr) {
    const auto found = arrays_.find(name);
    if (found == arrays_.end()) return fail_with<Number>(name, "is missing");
    const NpyArray& array = found->second;
    if (array.type != kNpyType<Number> || array.shape.size() != dimensions) {
      return fail_with<Number>(
          name, fmt::format("is of type '{}' with {} dimensions; expected "
                            "'{}' with {}",
                            array.type, array.shape.size(), kNpyType<Number>, dimensions));
    }
    if (dimensions > 0 && size != kAnySize && array.shape[0] != size) {
      return fail_with<Number>(name,
                               fmt::format("has {} elements; expected {}", array.shape[0], size));
    }
    if (width != nullptr) *width = array.shape[1];
    return from_npy<Number>(array);
  }

  std::vector<std::string> texts(const char* name) {
    const auto found = arrays_.find(name);
    if (found == arrays_.end() || !found->second.type.starts_with("<U")) {
      return fail_with<std::string>(name, "is missing or not of texts ('<U...')");
    }
    auto texts = texts_of(found->second);
    if (!texts) return fail_with<std::string>(name, texts.error().message);
    return std::move(*texts);
  }

  std::int64_t number(const char* name) {
    const auto list = numbers<std::int64_t>(name, 0, kAnySize);
    return list.empty() ? 0 : list[0];
  }
  std::string text(const char* name) {
    const auto list = texts(name);
    return list.size() == 1 ? list[0] : std::string();
  }
  /// A text per row, of an array of texts and one of places in it.
  std::vector<std::string> shared_texts(const char* name, const char* rows, std::size_t size) {
    const auto unique = texts(name);
    std::vector<std::string> result;
    for (const std::int32_t place : numbers<std::int32_t>(rows, 1, size)) {
      if (place < 0 || static_cast<std::size_t>(place) >= unique.size()) {
        return fail_with<std::string>(rows,
                                      fmt::format("refers to text {} of {}", place, unique.size()));
      }
      const std::string& text = unique[static_cast<std::size_t>(place)];
      if (text.size() > text_allowance_) {
        return fail_with<std::string>(name, "has long texts that too many rows share");
      }
      text_allowance_ -= text.size();
      result.push_back(text);
    }
    return result;
  }
  /// Where the part of each row ends in an array of `total` elements.
  std::vector<std::int64_t> ends(const char* name, std::size_t size, std::size_t total) {
    auto ends = numbers<std::int64_t>(name, 1, size);
    std::int64_t last = 0;
    for (const std::int64_t end : ends) {
      if (end < last) return fail_with<std::int64_t>(name, "does not ascend");
      last = end;
    }
    if (!error_ && last != static_cast<std::int64_t>(total)) {
      return fail_with<std::int64_t>(name, fmt::format("ends at {}; expected {}", last, total));
    }
    return ends;
  }

  template <class T>
  std::vector<T> fail_with(const char* name, const std::string& what) {
    if (!error_) error_ = fmt::format("array '{}' {}", name, what);
    return {};
  }
  [[nodiscard]] const std::optional<std::string>& error() const { return error_; }

  static constexpr std::size_t kAnySize = static_cast<std::size_t>(-1);

 private:
  /// Each row gets a copy of the texts that it shares: a small file could ask for any number of
  /// bytes. A few hundred beside the numbers of each row stay far below this.
  static constexpr std::size_t kTextPerByte = 32;

  const std::map<std::string, NpyArray>& arrays_;
  std::size_t text_allowance_ = 0;
  std::optional<std::string> error_;
};

/// Elements of row `row`, each of `width` numbers.
template <class To, class From>
std::vector<To> part(const std::vector<From>& numbers, const std::vector<std::int64_t>& ends,
                     std::size_t row, std::size_t width) {
  const auto stride = static_cast<std::ptrdiff_t>(width);
  const auto begin = (row == 0 ? 0 : static_cast<std::ptrdiff_t>(ends[row - 1])) * stride;
  const auto end = static_cast<std::ptrdiff_t>(ends[row]) * stride;
  return {numbers.begin() + begin, numbers.begin() + end};
}

ExperienceSpace space_of(Arrays& arrays) {
  ExperienceSpace space;
  if (arrays.number("format") != kNpzFormat) {
    arrays.fail_with<int>("format", fmt::format("is not {}", kNpzFormat));
  }
  space.robot_name = arrays.text("robot_name");
  space.robot_hash = arrays.text("robot_hash");
  const std::int64_t joints = arrays.number("joint_count");
  constexpr std::int64_t kMost = 10000;
  if (joints < 1 || joints > kMost) {
    arrays.fail_with<int>("joint_count", "is out of range");
    return space;
  }
  space.joint_count = static_cast<int>(joints);
  return space;
}

}  // namespace

void NpzColumns::Texts::add(const std::string& text) {
  const auto [place, is_new] = places.emplace(text, static_cast<std::int32_t>(unique.size()));
  if (is_new) unique.push_back(text);
  rows.push_back(place->second);
}

void NpzColumns::add(const Experience& row) {
  const LocalSampler& sampler = row.sampler;
  const auto joints = static_cast<std::size_t>(space_.joint_count);
  const auto append = [](auto& all, const auto& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all.size();
  };
  kinds_.add(row.kind);
  key_ends_.push_back(static_cast<std::int64_t>(append(keys_, row.key)));
  mean_ends_.push_back(static_cast<std::int64_t>(append(means_, sampler.means) / joints));
  factor_ends_.push_back(
      static_cast<std::int64_t>(append(factors_, sampler.factors) / triangle_size(joints)));
  factor_row_ends_.push_back(static_cast<std::int64_t>(append(factor_rows_, sampler.factor_rows)));
  origin_ends_.push_back(static_cast<std::int64_t>(append(origins_, sampler.origins)));
  seeds_.push_back(row.provenance.seed);
  settings_.add(row.provenance.settings);
  tools_.add(row.provenance.tool);
  times_.add(row.provenance.time);
}

std::vector<std::pair<std::string, NpyArray>> NpzColumns::arrays() const {
  const auto joints = static_cast<std::size_t>(space_.joint_count);
  return {{"format", number_of(kNpzFormat)},
          {"robot_name", text_of(space_.robot_name)},
          {"robot_hash", text_of(space_.robot_hash)},
          {"joint_count", number_of(space_.joint_count)},
          {"kinds", to_npy(kinds_.unique)},
          {"kind_rows", list_of(kinds_.rows)},
          {"keys", list_of(keys_)},
          {"key_ends", list_of(key_ends_)},
          {"means", table_of(means_, joints)},
          {"mean_ends", list_of(mean_ends_)},
          {"factors", table_of(factors_, triangle_size(joints))},
          {"factor_ends", list_of(factor_ends_)},
          {"factor_rows", list_of(factor_rows_)},
          {"factor_row_ends", list_of(factor_row_ends_)},
          {"origins", list_of(origins_)},
          {"origin_ends", list_of(origin_ends_)},
          {"seeds", list_of(seeds_)},
          {"settings", to_npy(settings_.unique)},
          {"settings_rows", list_of(settings_.rows)},
          {"tools", to_npy(tools_.unique)},
          {"tool_rows", list_of(tools_.rows)},
          {"times", to_npy(times_.unique)},
          {"time_rows", list_of(times_.rows)}};
}

Result<NpzRows> rows_of(const std::map<std::string, NpyArray>& files) {
  Arrays arrays(files);
  NpzRows result;
  result.space = space_of(arrays);
  const auto joints = static_cast<std::size_t>(result.space.joint_count);
  constexpr std::size_t kAny = Arrays::kAnySize;
  const auto seeds = arrays.numbers<std::uint64_t>("seeds", 1, kAny);
  const std::size_t count = seeds.size();
  const auto keys = arrays.numbers<double>("keys", 1, kAny);
  std::size_t width = joints;
  const auto means = arrays.numbers<float>("means", 2, kAny, &width);
  if (width != joints) arrays.fail_with<int>("means", "has rows of another size than joint_count");
  width = triangle_size(joints);
  const auto factors = arrays.numbers<float>("factors", 2, kAny, &width);
  if (width != triangle_size(joints)) arrays.fail_with<int>("factors", "has rows of a wrong size");
  const auto factor_rows = arrays.numbers<std::int32_t>("factor_rows", 1, kAny);
  const auto origins = arrays.numbers<std::int32_t>("origins", 1, kAny);
  if (arrays.error()) return fail(ErrorCode::parse, *arrays.error());
  const auto key_ends = arrays.ends("key_ends", count, keys.size());
  const auto mean_ends = arrays.ends("mean_ends", count, means.size() / joints);
  const auto factor_ends =
      arrays.ends("factor_ends", count, factors.size() / triangle_size(joints));
  const auto factor_row_ends = arrays.ends("factor_row_ends", count, factor_rows.size());
  const auto origin_ends = arrays.ends("origin_ends", count, origins.size());
  const auto kinds = arrays.shared_texts("kinds", "kind_rows", count);
  const auto settings = arrays.shared_texts("settings", "settings_rows", count);
  const auto tools = arrays.shared_texts("tools", "tool_rows", count);
  const auto times = arrays.shared_texts("times", "time_rows", count);
  if (arrays.error()) return fail(ErrorCode::parse, *arrays.error());
  for (std::size_t i = 0; i < count; ++i) {
    Experience& row = result.rows.emplace_back();
    row.kind = kinds[i];
    row.key = part<double>(keys, key_ends, i, 1);
    row.sampler = {result.space.joint_count, part<float>(means, mean_ends, i, joints),
                   part<int>(factor_rows, factor_row_ends, i, 1),
                   part<float>(factors, factor_ends, i, triangle_size(joints)),
                   part<int>(origins, origin_ends, i, 1)};
    row.provenance = {tools[i], settings[i], seeds[i], times[i]};
  }
  return result;
}

}  // namespace mneme::internal

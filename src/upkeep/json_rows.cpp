// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "upkeep/json_rows.h"

#include "base/fail.h"
#include "store/row_check.h"
#include "store/store.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <limits>
#include <optional>

namespace mneme::internal {
namespace {

using Json = nlohmann::json;

constexpr const char* kFormat = "mneme experience 3";

/// The shortest digits; "-0.0" instead of "-0", which JSON readers take for the integer 0.
template <class Number>
std::string digits_of(Number number) {
  return number == 0 && std::signbit(number) ? "-0.0" : fmt::format("{}", number);
}

void append_number(std::string& text, double number) { text += digits_of(number); }

/// The shortest digits that a reader of double precision turns into the same float.
void append_number(std::string& text, float number) {
  const std::string digits = digits_of(number);
  double read = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), read);
  const bool is_exact = static_cast<float>(read) == number;
  text += is_exact ? digits : fmt::format("{}", static_cast<double>(number));
}

void append_number(std::string& text, int number) { text += std::to_string(number); }

template <class Number>
std::string list_of(std::span<const Number> numbers) {
  std::string text = "[";
  for (const Number number : numbers) {
    if (text.size() > 1) text += ',';
    append_number(text, number);
  }
  return text + ']';
}

/// Rows of `width` numbers as lists of lists.
std::string table_of(std::span<const float> numbers, std::size_t width) {
  std::string text = "[";
  for (std::size_t begin = 0; width > 0 && begin + width <= numbers.size(); begin += width) {
    if (begin > 0) text += ',';
    text += list_of(numbers.subspan(begin, width));
  }
  return text + ']';
}

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Reads the fields of one line. error() is the first flaw found.
class Fields {
 public:
  explicit Fields(std::string_view line)
      : json_(Json::parse(line.begin(), line.end(), nullptr, false)) {
    if (json_.is_discarded() || !json_.is_object()) error_ = "is not a JSON object";
  }

  std::string text(const char* name) {
    const Json* field = find(name);
    if (field != nullptr && field->is_string()) return field->get<std::string>();
    return wrong<std::string>(name, "a text");
  }
  std::uint64_t whole_number(const char* name) {
    const Json* field = find(name);
    if (field != nullptr && field->is_number_unsigned()) return field->get<std::uint64_t>();
    return wrong<std::uint64_t>(name, "a whole number from 0");
  }
  bool truth(const char* name) {
    const Json* field = find(name);
    return field != nullptr && field->is_boolean() ? field->get<bool>()
                                                   : wrong<bool>(name, "true or false");
  }
  int count(const char* name) {
    const std::uint64_t number = whole_number(name);
    if (number <= static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
      return static_cast<int>(number);
    }
    return wrong<int>(name, "a smaller number");
  }
  template <class Number>
  std::vector<Number> list(const char* name) {
    std::vector<Number> numbers;
    const Json* field = find(name);
    if (field == nullptr || !append(*field, numbers)) wrong<int>(name, "a list of numbers");
    return numbers;
  }
  /// The rows of a list of lists, concatenated; `width` is their common size.
  std::vector<float> table(const char* name, std::size_t& width) {
    std::vector<float> numbers;
    const Json* field = find(name);
    bool is_table = field != nullptr && field->is_array();
    if (is_table && !field->empty()) width = field->front().size();
    for (std::size_t i = 0; is_table && i < field->size(); ++i) {
      const Json& row = (*field)[i];
      is_table = row.is_array() && row.size() == width && append(row, numbers);
    }
    if (!is_table) wrong<int>(name, "a list of lists of equally many numbers");
    return numbers;
  }
  void refuse(std::string flaw) {
    if (!error_) error_ = std::move(flaw);
  }
  [[nodiscard]] bool has(const char* name) const { return find(name) != nullptr; }
  [[nodiscard]] const std::optional<std::string>& error() const { return error_; }

 private:
  [[nodiscard]] const Json* find(const char* name) const {
    if (!json_.is_object()) return nullptr;
    const auto field = json_.find(name);
    return field == json_.end() ? nullptr : &*field;
  }
  template <class Number>
  static bool append(const Json& list, std::vector<Number>& numbers) {
    if (!list.is_array()) return false;
    for (const Json& number : list) {
      if constexpr (std::integral<Number>) {
        if (!number.is_number_integer()) return false;
        constexpr auto kMost = std::uint64_t{std::numeric_limits<std::int64_t>::max()};
        if (number.is_number_unsigned() && number.get<std::uint64_t>() > kMost) return false;
        const auto value = number.get<std::int64_t>();
        if (value < std::numeric_limits<Number>::min() ||
            value > std::numeric_limits<Number>::max()) {
          return false;
        }
        numbers.push_back(static_cast<Number>(value));
      } else {
        if (!number.is_number()) return false;
        numbers.push_back(static_cast<Number>(number.get<double>()));
      }
    }
    return true;
  }
  template <class T>
  T wrong(const char* name, const char* expected) {
    refuse(fmt::format("'{}' is missing or not {}", name, expected));
    return {};
  }

  Json json_;
  std::optional<std::string> error_;
};

}  // namespace

std::string json_of(const RobotSignature& robot) {
  return fmt::format(
      R"({{"format":{},"robot_name":{},"kinematics_hash":{},"model_hash":{},"joint_count":{}}})",
      quoted(kFormat), quoted(robot.robot_name), quoted(robot.kinematics_hash),
      quoted(robot.model_hash), robot.joint_count);
}

namespace {

std::string json_of(const LocalSampler& sampler) {
  const auto joints = static_cast<std::size_t>(sampler.joint_count);
  return fmt::format(R"("means":{},"factor_rows":{},"factors":{},"sources":{},"is_complete":{})",
                     table_of(sampler.means, joints), list_of<int>(sampler.factor_rows),
                     table_of(sampler.factors, sampler.factor_size()),
                     list_of<int>(sampler.sources), sampler.is_complete);
}

std::string json_of(const RememberedPath& path) {
  std::string text = fmt::format(
      R"("waypoints":{},"constraints":{})",
      table_of(path.waypoints, static_cast<std::size_t>(path.joint_count)), path.constraints);
  if (path.planning_states) text += fmt::format(R"(,"planning_states":{})", *path.planning_states);
  if (path.clearances.empty() && path.near_misses.empty()) return text;
  return text + fmt::format(R"(,"clearances":{},"near_misses":{})", list_of<float>(path.clearances),
                            table_of(path.near_misses, static_cast<std::size_t>(path.joint_count)));
}

LocalSampler parse_sampler(Fields& fields) {
  LocalSampler sampler;
  std::size_t joints = 0, triangle = 0;
  sampler.means = fields.table("means", joints);
  sampler.factor_rows = fields.list<int>("factor_rows");
  sampler.factors = fields.table("factors", triangle);
  sampler.sources = fields.list<int>("sources");
  sampler.is_complete = fields.truth("is_complete");
  // Without means, the joint count follows from the factors.
  while (triangle_size(joints) < triangle && sampler.means.empty()) ++joints;
  sampler.joint_count = static_cast<int>(joints);
  if (triangle != 0 && triangle != triangle_size(joints)) {
    fields.refuse(fmt::format("a row of 'factors' has {} numbers; expected {}", triangle,
                              triangle_size(joints)));
  }
  return sampler;
}

RememberedPath parse_path(Fields& fields) {
  RememberedPath path;
  std::size_t joints = 0;
  path.waypoints = fields.table("waypoints", joints);
  path.joint_count = static_cast<int>(joints);
  path.constraints = fields.whole_number("constraints");
  if (fields.has("planning_states")) path.planning_states = fields.whole_number("planning_states");
  if (fields.has("clearances")) path.clearances = fields.list<float>("clearances");
  if (fields.has("near_misses")) {
    path.near_misses = fields.table("near_misses", joints);
    if (joints != static_cast<std::size_t>(path.joint_count) && !path.near_misses.empty()) {
      fields.refuse(fmt::format("a row of 'near_misses' has {} numbers; expected {}", joints,
                                path.joint_count));
    }
  }
  return path;
}

}  // namespace

std::string json_of(const Experience& row) {
  const Provenance& provenance = row.provenance;
  const std::string content =
      std::visit([](const auto& held) { return json_of(held); }, row.content);
  return fmt::format(
      R"({{"content":"{}","kind":{},"key":{},{},"settings":{},"seed":{},"tool":{},"time":{}}})",
      to_hex(EncodedRow(row).content()), quoted(row.kind), list_of<double>(row.key), content,
      quoted(provenance.settings), provenance.seed, quoted(provenance.tool),
      quoted(provenance.time));
}

Result<RobotSignature> parse_signature(std::string_view line) {
  Fields fields(line);
  const std::string format = fields.text("format");
  if (!fields.error() && format != kFormat) {
    return fail(ErrorCode::parse, "its format is '{}'; expected '{}'", format, kFormat);
  }
  RobotSignature robot;
  robot.robot_name = fields.text("robot_name");
  robot.kinematics_hash = fields.text("kinematics_hash");
  robot.model_hash = fields.text("model_hash");
  robot.joint_count = fields.count("joint_count");
  if (fields.error()) return fail(ErrorCode::parse, *fields.error());
  return robot;
}

Result<Experience> parse_row(std::string_view line) {
  Fields fields(line);
  Experience row;
  row.kind = fields.text("kind");
  row.key = fields.list<double>("key");
  if (fields.has("waypoints")) {
    row.content = parse_path(fields);
  } else {
    row.content = parse_sampler(fields);
  }
  row.provenance.settings = fields.text("settings");
  row.provenance.seed = fields.whole_number("seed");
  row.provenance.tool = fields.text("tool");
  row.provenance.time = fields.text("time");
  if (fields.error()) return fail(ErrorCode::parse, *fields.error());
  if (const auto flaw = describe_key_flaw(row.kind, row.key)) {
    return fail(ErrorCode::parse, *flaw);
  }
  if (fields.has("content") && fields.text("content") != to_hex(EncodedRow(row).content())) {
    return fail(
        ErrorCode::parse,
        "its content does not match the hash 'content'; remove that field after editing a row");
  }
  return row;
}

}  // namespace mneme::internal

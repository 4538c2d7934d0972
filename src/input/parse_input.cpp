// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "base/threads.h"
#include "input/elided.h"
#include "input/input.h"
#include "input/tree_builder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <span>
#include <sstream>

namespace mneme::internal {

void TreeBuilder::refuse(int line, const std::string& what) const {
  throw InputFailure{{ErrorCode::parse, fmt::format("{}:{}: {}", source_, line, elided(what))}};
}

bool TreeBuilder::is_key_next() const {
  return !levels_.empty() && !levels_.back().key &&
         std::holds_alternative<InputValue::Map>(levels_.back().value.content);
}

std::optional<int> TreeBuilder::key_line() const {
  return levels_.empty() || !levels_.back().key ? std::nullopt
                                                : std::optional(levels_.back().key_line);
}

void TreeBuilder::set_key(int line, const std::string& key) {
  Level& level = levels_.back();
  if (!level.keys.insert(key).second) {
    refuse(line,
           fmt::format("key {}: expected once, got a second time", elided(key, kLongestName)));
  }
  level.key = key;
  level.key_line = line;
}

void TreeBuilder::open(int line, Content content) {
  constexpr std::size_t kMaxDepth = 64;
  if (is_key_next()) refuse(line, "expected text as the key of a map");
  if (levels_.size() >= kMaxDepth) {
    refuse(line, fmt::format("expected values nested at most {} deep", kMaxDepth));
  }
  count(line, 1);
  levels_.push_back({{std::move(content), line}, {}, {}, 0});
}

void TreeBuilder::merge() {
  constexpr const char* kMergeKey = "<<";
  Level& level = levels_.back();
  auto* map = std::get_if<InputValue::Map>(&level.value.content);
  if (map == nullptr || !level.keys.contains(kMergeKey)) return;
  const auto merged = std::ranges::find(*map, kMergeKey, &InputEntry::key);
  InputValue base = std::move(merged->value);
  map->erase(merged);
  auto* list = std::get_if<InputValue::List>(&base.content);
  for (InputValue& each : list != nullptr ? std::span(*list) : std::span(&base, 1)) {
    auto* entries = std::get_if<InputValue::Map>(&each.content);
    if (entries == nullptr) refuse(base.line, "key <<: expected a map or a list of maps");
    for (InputEntry& entry : *entries) {
      if (level.keys.insert(entry.key).second) map->push_back(std::move(entry));
    }
  }
}

const InputValue& TreeBuilder::close() {
  InputValue value = std::move(levels_.back().value);
  levels_.pop_back();
  if (levels_.empty()) return root_ = std::move(value);
  Level& parent = levels_.back();
  if (auto* map = std::get_if<InputValue::Map>(&parent.value.content)) {
    map->push_back({std::move(*parent.key), std::move(value)});
    parent.key.reset();
    return map->back().value;
  }
  auto& list = std::get<InputValue::List>(parent.value.content);
  list.push_back(std::move(value));
  return list.back();
}

void TreeBuilder::count(int line, int values, std::string_view what) {
  constexpr int kPollInterval = 4096;
  if (values > max_values_ - values_) {
    refuse(line, fmt::format("expected at most {} values{}", max_values_, what));
  }
  const int polls = values_ / kPollInterval;
  values_ += values;
  if (values_ / kPollInterval != polls) poll_interrupt();
}

namespace {

int line_of(const YAML::Mark& mark) { return mark.line + 1; }

/// In values: one for each 64 bytes.
int cost_of(const std::string& text) {
  constexpr std::size_t kBytes = 64;
  return static_cast<int>(text.size() / kBytes);
}

/// The cost of a copy in values. A key is one, too, and a long text is several.
int cost_of_copy(const InputValue& value) {
  int cost = 1;
  if (const auto* list = std::get_if<InputValue::List>(&value.content)) {
    for (const InputValue& item : *list) cost += cost_of_copy(item);
  } else if (const auto* map = std::get_if<InputValue::Map>(&value.content)) {
    for (const InputEntry& entry : *map) {
      cost += 1 + cost_of(entry.key) + cost_of_copy(entry.value);
    }
  } else if (const auto* text = std::get_if<InputValue::Text>(&value.content)) {
    cost += cost_of(text->text);
  }
  return cost;
}

/// Computes a text of numbers, pi, parentheses and + - * /, such as "2*pi/3".
class Expression {
 public:
  explicit Expression(std::string_view text) : rest_(text) {}

  /// Returns nothing for other text and for results that are not finite.
  std::optional<double> value() {
    constexpr std::size_t kMostLength = 100;  // bounds the recursion
    if (rest_.size() > kMostLength) return std::nullopt;
    const double value = sum();
    skip_spaces();
    return is_good_ && rest_.empty() && std::isfinite(value) ? std::optional(value) : std::nullopt;
  }

 private:
  void skip_spaces() {
    while (rest_.starts_with(' ')) rest_.remove_prefix(1);
  }
  bool skip(std::string_view symbol) {
    skip_spaces();
    const bool is_next = rest_.starts_with(symbol);
    if (is_next) rest_.remove_prefix(symbol.size());
    return is_next;
  }
  double sum() {
    double value = product();
    for (;;) {
      if (skip("+")) {
        value += product();
      } else if (skip("-")) {
        value -= product();
      } else {
        return value;
      }
    }
  }
  double product() {
    double value = factor();
    for (;;) {
      if (skip("*")) {
        value *= factor();
      } else if (skip("/")) {
        value /= factor();
      } else {
        return value;
      }
    }
  }
  double factor() {
    if (skip("-")) return -factor();
    if (skip("+")) return factor();
    if (skip("pi")) return std::numbers::pi;
    if (skip("(")) {
      const double inner = sum();
      is_good_ = skip(")") && is_good_;
      return inner;
    }
    double value = 0;
    const bool is_number =
        !rest_.empty() && (rest_[0] == '.' || (rest_[0] >= '0' && rest_[0] <= '9'));
    const char* const end = rest_.data() + rest_.size();
    const auto [stop, error] = number_from(rest_.data(), end, value);
    is_good_ = is_good_ && is_number && error == std::errc();
    if (is_good_) rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
    return value;
  }

  std::string_view rest_;
  bool is_good_ = true;
};

/// A number, or an expression as rosparam and MoveIt compute them after tags of angles.
std::optional<double> parse_angle(std::string_view text) {
  const auto number = parse_yaml_number(text);
  return number ? number : Expression(text).value();
}

constexpr double kDegree = std::numbers::pi / 180;

/// Reads deg(ANGLE) or rad(ANGLE), as rosparam has them.
std::optional<InputValue::Angle> parse_rosparam_angle(std::string_view text) {
  const bool is_degrees = text.starts_with("deg(");
  if ((!is_degrees && !text.starts_with("rad(")) || !text.ends_with(')')) return std::nullopt;
  const auto angle = parse_angle(text.substr(4, text.size() - 5));
  if (!angle) return std::nullopt;
  return InputValue::Angle{is_degrees ? *angle * kDegree : *angle};
}

/// Uses the events of the parser: yaml-cpp's tree keeps repeated keys, and its reader of several
/// documents does not return from some malformed texts.
class YamlListener : public YAML::EventHandler {
 public:
  explicit YamlListener(TreeBuilder& tree) : tree_(tree) {}

  void OnDocumentStart(const YAML::Mark&) override { ++documents_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (documents_ > 1) return;
    // The parser notices that a value is missing only where the next thing begins.
    open(tree_.key_line().value_or(line_of(mark)), {}, anchor);
    close();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    refuse_second_document(mark);
    if (tree_.is_key_next()) {
      tree_.set_key(line_of(mark), text);
      return;
    }
    open(line_of(mark), content_of(line_of(mark), tag, text), anchor);
    close();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    refuse_second_document(mark);
    refuse_tag(line_of(mark), tag, "seq");
    open(line_of(mark), InputValue::List{}, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    refuse_second_document(mark);
    refuse_tag(line_of(mark), tag, "map");
    open(line_of(mark), InputValue::Map{}, anchor);
  }
  void OnMapEnd() override { close(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_second_document(mark);
    const auto anchored = anchored_.find(anchor);
    if (anchored == anchored_.end()) {
      tree_.refuse(line_of(mark), "expected an alias outside of the value that it names");
    }
    const auto& [value, cost] = anchored->second;
    tree_.count(line_of(mark), cost - 1, kCopies);
    open(line_of(mark), value.content, 0);
    close();
  }

 private:
  static constexpr std::string_view kCore = "tag:yaml.org,2002:";
  static constexpr std::string_view kCopies =
      ", with a copy for each anchor and alias, in which keys and each 64 bytes of a text count; "
      "use fewer anchors and aliases, or put less into the anchored values";

  struct Anchored {
    InputValue value;
    int cost = 0;  ///< of a copy, in values
  };

  /// `ros2 topic echo` ends each message with ---, which begins an empty document.
  void refuse_second_document(const YAML::Mark& mark) const {
    if (documents_ > 1) {
      tree_.refuse(line_of(mark),
                   "expected the end of the text after one YAML document (ros2 topic echo --once "
                   "prints one)");
    }
  }

  /// Refuses all but no tag and the core tag `kind`.
  void refuse_tag(int line, const std::string& tag, std::string_view kind) const {
    if (tag.empty() || tag == "?" || tag == "!" || tag == std::string(kCore).append(kind)) return;
    if (tag == "!degrees" || tag == "!radians") {
      tree_.refuse(line, fmt::format("expected one number after {}, got a {}", tag,
                                     kind == "seq" ? "list" : kind));
    }
    tree_.refuse(line, fmt::format("unknown tag {}; expected !degrees or !radians before a number, "
                                   "or no tag",
                                   elided(tag, kLongestName)));
  }

  /// The value of a scalar. yaml-cpp gives quoted text the tag "!".
  TreeBuilder::Content content_of(int line, const std::string& tag, const std::string& text) const {
    if (tag == "!" || tag == std::string(kCore) + "str") return InputValue::Text{text, true};
    if (tag == "!degrees" || tag == "!radians") {
      const auto angle = parse_angle(text);
      if (!angle) {
        tree_.refuse(line, fmt::format("expected a number or an expression such as pi/6 after {}, "
                                       "got \"{}\"",
                                       tag, elided(text, kLongestName)));
      }
      return InputValue::Angle{tag == "!radians" ? *angle : *angle * kDegree};
    }
    if (std::ranges::find(kScalars, tag) == kScalars.end()) refuse_tag(line, tag, "str");
    if (const auto angle = parse_rosparam_angle(text)) return *angle;
    return InputValue::Text{text, false};
  }
  static constexpr std::array<std::string_view, 4> kScalars = {
      "tag:yaml.org,2002:int", "tag:yaml.org,2002:float", "tag:yaml.org,2002:bool",
      "tag:yaml.org,2002:null"};

  void open(int line, TreeBuilder::Content content, YAML::anchor_t anchor) {
    tree_.open(line, std::move(content));
    anchors_.push_back(anchor);
  }
  void close() {
    tree_.merge();
    const InputValue& value = tree_.close();
    if (anchors_.back() != 0) {
      const int cost = cost_of_copy(value);
      tree_.count(value.line, cost, kCopies);
      anchored_[anchors_.back()] = {value, cost};
    }
    anchors_.pop_back();
  }

  TreeBuilder& tree_;
  std::vector<YAML::anchor_t> anchors_;  ///< of the values that are open, 0 for none
  std::map<YAML::anchor_t, Anchored> anchored_;
  int documents_ = 0;
};

/// The number of the first line with a tab before its first word.
std::optional<int> find_tab(std::string_view yaml) {
  for (int line = 1; !yaml.empty(); ++line) {
    const std::string_view text = yaml.substr(0, yaml.find('\n'));
    const std::size_t word = std::min(text.find_first_not_of(" \t\r"), text.size());
    if (word < text.size() && text.substr(0, word).find('\t') != text.npos) return line;
    yaml.remove_prefix(std::min(yaml.size(), text.size() + 1));
  }
  return std::nullopt;
}

}  // namespace

InputValue parse_yaml(std::string_view yaml, const std::string& source) {
  // Aliases and anchors can make a small text a huge tree.
  constexpr int kMaxValues = 4'000'000;
  // UTF-16, which yaml-cpp reads, has such bytes and begins with a byte order mark.
  const std::size_t null = yaml.find('\0');
  if (null != std::string_view::npos && !yaml.starts_with("\xff\xfe") &&
      !yaml.starts_with("\xfe\xff")) {
    const auto line = 1 + std::count(yaml.begin(), yaml.begin() + static_cast<long>(null), '\n');
    TreeBuilder(source, kMaxValues).refuse(static_cast<int>(line), "a null byte is no YAML");
  }
  if (auto simple = parse_simple_yaml(yaml, source, kMaxValues)) return *std::move(simple);
  TreeBuilder tree(source, kMaxValues);
  YamlListener listener(tree);
  try {
    std::istringstream stream{std::string(yaml)};
    YAML::Parser parser(stream);
    // Bounded, since the parser finds documents without end in some malformed texts.
    constexpr int kMostDocuments = 100;
    int documents = 0;
    while (parser.HandleNextDocument(listener)) {
      if (++documents > kMostDocuments) tree.refuse(1, "expected one YAML document");
    }
    return tree.take();
  } catch (const YAML::Exception& error) {
    if (const auto line = find_tab(yaml)) {
      tree.refuse(*line, "expected spaces before the first word, as YAML does; got a tab");
    }
    tree.refuse(line_of(error.mark),
                fmt::format("expected YAML: {} (column {})", error.msg, error.mark.column + 1));
  }
}

namespace {

/// Tracks the position of the parser, which reports lines for errors only.
class TrackedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedIterator(const char* here, const char** reached) : here_(here), reached_(reached) {}
  reference operator*() const { return *here_; }
  TrackedIterator& operator++() {
    *reached_ = ++here_;
    return *this;
  }
  bool operator==(const TrackedIterator& other) const { return here_ == other.here_; }

 private:
  const char* here_;
  const char** reached_;
};

class JsonListener : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonListener(std::string_view text, TreeBuilder& tree)
      : text_(text), tree_(tree), reached_(text.data()), counted_(text.data()) {}

  bool parse() {
    return nlohmann::json::sax_parse(TrackedIterator(text_.data(), &reached_),
                                     TrackedIterator(text_.data() + text_.size(), &reached_), this);
  }

  bool null() override { return add({}); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& text) override { return add(InputValue::Text{text, true}); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override {
    tree_.open(line(), InputValue::Map{});
    return true;
  }
  bool key(string_t& key) override {
    tree_.set_key(line(), key);
    return true;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override {
    tree_.open(line(), InputValue::List{});
    return true;
  }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::json::exception& error) override {
    constexpr std::size_t kLongestJsonError = 400;  // it quotes the number or text
    // "[json.exception.parse_error.101] parse error at line 1, column 2: TEXT"
    std::string_view what = error.what();
    what.remove_prefix(std::min(what.size(), what.find("] ") + 2));
    if (what.starts_with("parse error at ")) {
      what.remove_prefix(std::min(what.size(), what.find(": ") + 2));
    }
    tree_.refuse(line(), fmt::format("expected JSON: {}", elided(what, kLongestJsonError)));
  }

 private:
  bool add(TreeBuilder::Content content) {
    tree_.open(line(), std::move(content));
    return close();
  }
  bool close() {
    tree_.close();
    return true;
  }

  /// The line of the character before the last one read: a number ends at the next character.
  int line() {
    const char* end = std::max(counted_, reached_ - (reached_ == text_.data() ? 0 : 1));
    line_ += static_cast<int>(std::count(counted_, end, '\n'));
    counted_ = end;
    return line_;
  }

  std::string_view text_;
  TreeBuilder& tree_;
  const char* reached_;
  const char* counted_;
  int line_ = 1;
};

}  // namespace

InputValue parse_json(std::string_view json, const std::string& source) {
  constexpr int kMaxValues = 16'000'000;
  TreeBuilder tree(source, kMaxValues);
  if (!JsonListener(json, tree).parse()) tree.refuse(1, "expected JSON");
  return tree.take();
}

}  // namespace mneme::internal

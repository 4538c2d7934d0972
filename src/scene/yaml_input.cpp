// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml_input.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <set>
#include <sstream>

namespace mneme::internal {
namespace {

/// Builds the tree from the parser's events: yaml-cpp's own tree keeps doubled keys, and its reader
/// of several documents does not return from some malformed texts.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& source) : source_(source) {}

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw InputFailure{{ErrorCode::parse, fmt::format("{}:{}: {}", source_, mark.line + 1, what)}};
  }
  InputValue take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) {
      refuse(mark, "expected the end of the text after one YAML document");
    }
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    // The parser notices what is missing only where the next thing begins.
    const bool is_left_out = !levels_.empty() && levels_.back().key;
    open(is_left_out ? levels_.back().key_mark : mark, {}, anchor);
    close();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    if (!levels_.empty() && levels_.back().is_key_next()) {
      set_key(mark, text);
      return;
    }
    open(mark, InputValue::Text{text, tag == "!"}, anchor);
    close();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, InputValue::List{}, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, InputValue::Map{}, anchor);
  }
  void OnMapEnd() override { close(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchored_.find(anchor);
    if (found == anchored_.end()) {
      refuse(mark, "expected an alias of a value that has ended");
    }
    open(mark, found->second.value.content, 0);
    count(mark, found->second.size);
    close();
  }

 private:
  struct Level {
    InputValue value;
    YAML::anchor_t anchor = 0;
    int values_before = 0;
    std::set<std::string> keys;      ///< of a map, so far
    std::optional<std::string> key;  ///< of the next value of a map
    YAML::Mark key_mark;

    [[nodiscard]] bool is_map() const {
      return std::holds_alternative<InputValue::Map>(value.content);
    }
    [[nodiscard]] bool is_key_next() const { return is_map() && !key; }
  };
  struct Anchored {
    InputValue value;
    int size = 0;
  };

  // Aliases can make a small text a huge tree.
  static constexpr int kMaxValues = 4'000'000;
  static constexpr std::size_t kMaxDepth = 64;

  void count(const YAML::Mark& mark, int values) {
    if (values > kMaxValues - values_) {
      refuse(mark, fmt::format("expected at most {} values", kMaxValues));
    }
    values_ += values;
  }

  void set_key(const YAML::Mark& mark, const std::string& key) {
    Level& level = levels_.back();
    if (!level.keys.insert(key).second) {
      refuse(mark, fmt::format("key {}: expected once, got a second time", key));
    }
    level.key = key;
    level.key_mark = mark;
  }

  void open(const YAML::Mark& mark, decltype(InputValue::content) content, YAML::anchor_t anchor) {
    if (!levels_.empty() && levels_.back().is_key_next()) {
      refuse(mark, "expected a key that is a text");
    }
    if (levels_.size() >= kMaxDepth) {
      refuse(mark, fmt::format("expected values nested at most {} deep", kMaxDepth));
    }
    count(mark, 1);
    levels_.push_back({{std::move(content), mark.line + 1}, anchor, values_ - 1, {}, {}, {}});
  }

  void close() {
    Level level = std::move(levels_.back());
    levels_.pop_back();
    if (level.anchor != 0) {
      anchored_[level.anchor] = {level.value, values_ - level.values_before};
    }
    if (levels_.empty()) {
      root_ = std::move(level.value);
      return;
    }
    Level& parent = levels_.back();
    if (parent.is_map()) {
      std::get<InputValue::Map>(parent.value.content)
          .push_back({std::move(*parent.key), std::move(level.value)});
      parent.key.reset();
    } else {
      std::get<InputValue::List>(parent.value.content).push_back(std::move(level.value));
    }
  }

  const std::string& source_;
  InputValue root_{{}, 1};
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, Anchored> anchored_;
  int documents_ = 0;
  int values_ = 0;
};

}  // namespace

InputValue parse_yaml(std::string_view yaml, const std::string& source) {
  TreeBuilder builder(source);
  try {
    std::istringstream stream{std::string(yaml)};
    YAML::Parser parser(stream);
    if (parser.HandleNextDocument(builder)) {
      parser.HandleNextDocument(builder);
    }
    return builder.take();
  } catch (const YAML::Exception& error) {
    builder.refuse(error.mark,
                   fmt::format("expected YAML: {} (column {})", error.msg, error.mark.column + 1));
  }
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml.h"

#include "scene/tree_builder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

namespace mneme::internal {
namespace {

int line_of(const YAML::Mark& mark) { return mark.line + 1; }

int count_values(const InputValue& value) {
  int count = 1;
  if (const auto* list = std::get_if<InputValue::List>(&value.content)) {
    for (const InputValue& item : *list) count += count_values(item);
  } else if (const auto* map = std::get_if<InputValue::Map>(&value.content)) {
    for (const InputEntry& entry : *map) count += count_values(entry.value);
  }
  return count;
}

/// Listens to the parser itself: yaml-cpp's tree keeps doubled keys, and its reader of several
/// documents does not return from some malformed texts.
class YamlListener : public YAML::EventHandler {
 public:
  explicit YamlListener(TreeBuilder& tree) : tree_(tree) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) {
      tree_.refuse(line_of(mark), "expected the end of the text after one YAML document");
    }
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    // The parser notices that a value is missing only where the next thing begins.
    open(tree_.key_line().value_or(line_of(mark)), {}, anchor);
    close();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    if (tree_.is_key_next()) {
      tree_.set_key(line_of(mark), text);
      return;
    }
    open(line_of(mark), InputValue::Text{text, tag == "!"}, anchor);
    close();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(line_of(mark), InputValue::List{}, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(line_of(mark), InputValue::Map{}, anchor);
  }
  void OnMapEnd() override { close(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto anchored = anchored_.find(anchor);
    if (anchored == anchored_.end()) {
      tree_.refuse(line_of(mark), "expected an alias of a value that has ended");
    }
    tree_.count(line_of(mark), count_values(anchored->second) - 1);
    open(line_of(mark), anchored->second.content, 0);
    close();
  }

 private:
  void open(int line, TreeBuilder::Content content, YAML::anchor_t anchor) {
    tree_.open(line, std::move(content));
    anchors_.push_back(anchor);
  }
  void close() {
    const InputValue& value = tree_.close();
    if (anchors_.back() != 0) anchored_[anchors_.back()] = value;
    anchors_.pop_back();
  }

  TreeBuilder& tree_;
  std::vector<YAML::anchor_t> anchors_;  ///< of the values that are open, 0 for none
  std::map<YAML::anchor_t, InputValue> anchored_;
  int documents_ = 0;
};

}  // namespace

InputValue parse_yaml(std::string_view yaml, const std::string& source) {
  // Aliases can make a small text a huge tree.
  constexpr int kMaxValues = 4'000'000;
  TreeBuilder tree(source, kMaxValues);
  YamlListener listener(tree);
  try {
    std::istringstream stream{std::string(yaml)};
    YAML::Parser parser(stream);
    if (parser.HandleNextDocument(listener)) parser.HandleNextDocument(listener);
    return tree.take();
  } catch (const YAML::Exception& error) {
    tree.refuse(line_of(error.mark),
                fmt::format("expected YAML: {} (column {})", error.msg, error.mark.column + 1));
  }
}

namespace {

bool is_plain(std::string_view text) {
  constexpr std::array<std::string_view, 3> kNulls = {"null", "Null", "NULL"};
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto is_plain_character = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '/';
  };
  return !text.empty() && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(), is_plain_character) &&
         std::find(kNulls.begin(), kNulls.end(), text) == kNulls.end();
}

}  // namespace

std::string yaml_number(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return fmt::format("{}", value);
}

std::string yaml_numbers(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() == 1 ? "" : ", ") + yaml_number(value);
  return text + "]";
}

std::string yaml_string(std::string_view text) {
  if (is_plain(text)) return std::string(text);
  // A string of JSON is one of YAML too.
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "input/tree_builder.h"

#include <algorithm>
#include <array>

namespace mneme::internal {
namespace {

/// The text is beyond the subset.
struct NotSimple {};

bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '.' || c == '+' || c == '-' || c == '/';
}

/// Reads a subset of YAML some ten times faster than yaml-cpp: blocks and flow collections of plain
/// words and of quoted text without escapes, on lines of ASCII. Throws NotSimple beyond it.
class SimpleYaml {
 public:
  SimpleYaml(std::string_view text, TreeBuilder& tree) : text_(text), tree_(tree) {}

  void read() {
    next_line();
    if (is_over()) throw NotSimple();
    read_node();
    if (!is_over()) throw NotSimple();
  }

 private:
  [[nodiscard]] bool is_over() const { return at_ == text_.size(); }
  [[nodiscard]] char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\n';
  }
  void expect(char c) {
    if (is_over() || text_[at_] != c) throw NotSimple();
    ++at_;
  }
  void skip_spaces() {
    while (peek() == ' ') ++at_;
  }
  [[nodiscard]] bool is_dash() const {
    return peek() == '-' && (peek(1) == ' ' || peek(1) == '\n');
  }

  /// Moves from the start of a line to the next contents, and sets their column.
  void next_line() {
    while (!is_over()) {
      const std::size_t begin = at_;
      skip_spaces();
      column_ = static_cast<int>(at_ - begin);
      if (is_over()) return;
      if (peek() != '#' && peek() != '\n') return;
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      at_ = std::min(end + 1, text_.size());
      if (end < text_.size()) ++line_;
    }
  }

  /// Ends a line whose contents are read.
  void end_line() {
    const bool is_spaced = peek() == ' ';
    skip_spaces();
    if (peek() == '#' && is_spaced) at_ = std::min(text_.find('\n', at_), text_.size());
    if (is_over()) return;
    expect('\n');
    ++line_;
    next_line();
  }

  std::string_view read_word() {
    const std::size_t begin = at_;
    while (!is_over() && is_word_character(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    static constexpr std::array<std::string_view, 3> kNulls = {"null", "Null", "NULL"};
    const bool is_marker = word.starts_with("--") || word.starts_with("..") || word == "-";
    if (word.empty() || is_marker || std::ranges::find(kNulls, word) != kNulls.end()) {
      throw NotSimple();
    }
    return word;
  }

  std::string_view read_quoted() {
    const char quote = text_[at_++];
    const std::size_t end = text_.find(quote, at_);
    if (end == text_.npos || (quote == '\'' && end + 1 < text_.size() && text_[end + 1] == quote)) {
      throw NotSimple();
    }
    const std::string_view text = text_.substr(at_, end - at_);
    if (text.find_first_of("\\\n") != text.npos) throw NotSimple();
    at_ = end + 1;
    return text;
  }

  void add_text(std::string_view text, bool is_quoted) {
    tree_.open(line_, InputValue::Text{std::string(text), is_quoted});
    tree_.close();
  }

  void read_inline() {
    const char c = peek();
    if (c == '[') return read_flow_list();
    if (c == '{') return read_flow_map();
    if (c == '"' || c == '\'') return add_text(read_quoted(), true);
    add_text(read_word(), false);
  }

  /// Blanks and line breaks within a flow collection.
  void skip_blanks() {
    for (; !is_over() && (peek() == ' ' || peek() == '\n'); ++at_) line_ += peek() == '\n' ? 1 : 0;
  }

  /// Reads `read_item` between brackets, separated by commas.
  template <class ReadItem>
  void read_flow(char last, TreeBuilder::Content content, const ReadItem& read_item) {
    tree_.open(line_, std::move(content));
    ++at_;
    skip_blanks();
    bool is_first = true;
    for (; peek() != last; skip_blanks()) {
      if (!is_first) {
        expect(',');
        skip_blanks();
      }
      is_first = false;
      read_item();
    }
    expect(last);
    tree_.close();
  }

  void read_flow_list() {
    read_flow(']', InputValue::List{}, [&] { read_inline(); });
  }

  void read_flow_map() {
    read_flow('}', InputValue::Map{}, [&] {
      const bool is_quoted = peek() == '"' || peek() == '\'';
      const std::string key(is_quoted ? read_quoted() : read_word());
      tree_.set_key(line_, key);
      expect(':');
      if (peek() != ' ' && !is_quoted) throw NotSimple();
      skip_blanks();
      read_inline();
    });
  }

  [[nodiscard]] bool is_key() const {
    std::size_t end = at_;
    while (end < text_.size() && is_word_character(text_[end])) ++end;
    const char after = end + 1 < text_.size() ? text_[end + 1] : '\n';
    return end > at_ && end < text_.size() && text_[end] == ':' && (after == ' ' || after == '\n');
  }

  void read_node() {
    if (is_dash()) return read_list(column_);
    if (is_key()) return read_map(column_);
    const int column = column_;
    read_inline();
    end_line();
    if (!is_over() && column_ > column) throw NotSimple();
  }

  /// The value after "- " or "key:", on the same line or below.
  void read_value(int column, bool may_begin_block) {
    const std::size_t begin = at_;
    skip_spaces();
    if (peek() == '\n' || peek() == '#') {
      at_ = begin;
      end_line();
      const bool is_list_of_key = !may_begin_block && column_ == column && is_dash();
      if (is_over() || (column_ <= column && !is_list_of_key)) throw NotSimple();
      return read_node();
    }
    if (may_begin_block && (is_dash() || is_key())) {
      column_ = column + 1 + static_cast<int>(at_ - begin);
      return read_node();
    }
    read_inline();
    end_line();
    if (!is_over() && column_ > column) throw NotSimple();  // text of several lines
  }

  void read_list(int column) {
    tree_.open(line_, InputValue::List{});
    while (!is_over() && column_ == column && is_dash()) {
      ++at_;
      read_value(column, true);
    }
    if (!is_over() && column_ > column) throw NotSimple();
    tree_.close();
  }

  void read_map(int column) {
    tree_.open(line_, InputValue::Map{});
    while (!is_over() && column_ == column && is_key()) {
      tree_.set_key(line_, std::string(read_word()));
      expect(':');
      read_value(column, false);
    }
    if (!is_over() && column_ >= column) throw NotSimple();
    tree_.close();
  }

  std::string_view text_;
  TreeBuilder& tree_;
  std::size_t at_ = 0;
  int line_ = 1;
  int column_ = 0;  ///< of the contents at the start of a line or of a block
};

}  // namespace

std::optional<InputValue> parse_simple_yaml(std::string_view yaml, const std::string& source,
                                            int max_values) {
  const auto is_plain = [](char c) { return (c >= ' ' && c <= '~') || c == '\n'; };
  if (!std::ranges::all_of(yaml, is_plain)) return std::nullopt;
  TreeBuilder tree(source, max_values);
  try {
    SimpleYaml(yaml, tree).read();
    return tree.take();
  } catch (const NotSimple&) {
    return std::nullopt;
  }
}

}  // namespace mneme::internal

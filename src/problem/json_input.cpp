// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/json_input.h"

#include "scene/tree_builder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>

namespace mneme::internal {
namespace {

/// Reads characters and leaves word of how far it has got: the parser tells lines of errors only.
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
  bool operator!=(const TrackedIterator& other) const { return here_ != other.here_; }

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
  bool number_unsigned(number_unsigned_t value) override { return add(static_cast<double>(value)); }
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
    // "[json.exception.parse_error.101] parse error at line 1, column 2: what matters"
    std::string_view what = error.what();
    what.remove_prefix(std::min(what.size(), what.find("] ") + 2));
    if (what.starts_with("parse error at ")) {
      what.remove_prefix(std::min(what.size(), what.find(": ") + 2));
    }
    tree_.refuse(line(), fmt::format("expected JSON: {}", what));
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

  /// Of the character before the last one read, because a number ends where the next character is
  /// seen.
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
  if (!JsonListener(json, tree).parse()) {
    tree.refuse(1, "expected JSON");
  }
  return tree.take();
}

}  // namespace mneme::internal

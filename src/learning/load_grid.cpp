// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/row_check.h"
#include "mneme/learning.h"
#include "scene/input.h"
#include "base/text_file.h"
#include "scene/yaml_input.h"

namespace mneme {
namespace {

std::array<double, 2> read_range(const internal::Input& input) {
  const std::vector<double> values = input.finite_numbers(2, "a range [least, most]");
  if (!(values[0] > 0 && values[0] <= values[1] && values[1] <= internal::kMaxKeyMagnitude)) {
    input.fail(ErrorCode::parse, "expected 0 < least <= most <= 1e6 metres");
  }
  return {values[0], values[1]};
}

PrimitiveGrid read_grid(const internal::Input& input) {
  input.allow_keys({"radius", "gap", "distance", "max_similarity_error", "count"});
  PrimitiveGrid grid;
  grid.radius = read_range(input.at("radius"));
  grid.gap = read_range(input.at("gap"));
  grid.distance = read_range(input.at("distance"));
  if (const auto error = input.find("max_similarity_error")) {
    grid.max_similarity_error = error->positive_number();
  }
  if (const auto count = input.find("count")) {
    const double number = count->finite_number();
    if (number < 0 || number > 1e7 || number != static_cast<int>(number)) {
      count->fail_expecting("a whole number from 0 to 10000000");
    }
    grid.count = static_cast<int>(number);
  }
  return grid;
}

}  // namespace

Result<PrimitiveGrid> load_grid(const std::string& path) {
  return internal::without_throwing([&] {
    const std::string text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_yaml(text, path);
    return read_grid(internal::Input(value, path));
  });
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "base/text_file.h"
#include "scene/input.h"
#include "scene/scene_input.h"
#include "scene/yaml.h"

namespace mneme {
namespace {

using internal::Input;

/// `{uniform: NUMBERS}` or `{gaussian: NUMBERS}`; a single number may stand for a list of one.
Spread read_spread(const Input& input) {
  input.allow_keys({"uniform", "gaussian"});
  const auto uniform = input.find("uniform");
  const auto gaussian = input.find("gaussian");
  if (uniform.has_value() == gaussian.has_value()) input.fail_expecting("uniform or gaussian");
  const Input& numbers = uniform ? *uniform : *gaussian;
  Spread spread;
  spread.is_gaussian = gaussian.has_value();
  if (!numbers.is_list()) {
    spread.values = {numbers.finite_number()};
  } else {
    for (const Input& item : numbers.items()) spread.values.push_back(item.finite_number());
  }
  for (const double value : spread.values) {
    if (value < 0) numbers.fail_expecting("numbers of at least 0");
  }
  return spread;
}

void read_into(const Input& input, std::string_view key, std::size_t least, std::size_t most,
               Spread& spread) {
  const auto found = input.find(key);
  if (!found) return;
  spread = read_spread(*found);
  if (spread.values.size() >= least && spread.values.size() <= most) return;
  found->fail_expecting(least == most
                            ? std::to_string(least) + (least == 1 ? " number" : " numbers")
                            : std::to_string(least) + " to " + std::to_string(most) + " numbers");
}

void read_motion(const Input& input, Variation& variation) {
  read_into(input, "position", 3, 3, variation.position);
  read_into(input, "rpy", 3, 3, variation.rpy);
  read_into(input, "scale", 1, 1, variation.scale);
}

Variation read_scene_variation(const Input& input) {
  input.allow_keys({"position", "rpy", "scale", "center"});
  Variation variation;
  read_motion(input, variation);
  if (const auto center = input.find("center")) variation.center = internal::read_point(*center);
  return variation;
}

Variation read_obstacle_variation(const std::string& name, const Input& input) {
  input.allow_keys({"position", "rpy", "scale", "size"});
  Variation variation;
  variation.name = name;
  read_motion(input, variation);
  read_into(input, "size", 1, 3, variation.size);
  return variation;
}

Variations read_variations(const Input& input) {
  input.allow_keys({"scene", "obstacles"});
  Variations variations;
  if (const auto scene = input.find("scene")) variations.scene = read_scene_variation(*scene);
  if (const auto obstacles = input.find("obstacles")) {
    for (const auto& [name, obstacle] : obstacles->entries()) {
      variations.obstacles.push_back(read_obstacle_variation(name, obstacle));
    }
  }
  return variations;
}

}  // namespace

Result<Variations> load_variations(const std::string& path) {
  return internal::without_throwing([&] {
    const std::string text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_yaml(text, path);
    return read_variations(Input(value, path));
  });
}

}  // namespace mneme

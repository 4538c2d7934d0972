// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "scene/scene_input.h"
#include "scene/text_file.h"
#include "scene/yaml_input.h"

#include <filesystem>

namespace mneme {

Result<Scene> load_scene(const std::string& path) {
  const auto text = internal::read_text_file(path);
  if (!text) {
    return tl::unexpected<Error>(text.error());
  }
  return parse_scene(*text, path);
}

Result<Scene> parse_scene(std::string_view yaml, const std::string& source) {
  return internal::without_throwing([&] {
    const internal::InputValue value = internal::parse_yaml(yaml, source);
    return internal::read_scene(internal::Input(value, source),
                                std::filesystem::path(source).stem().string());
  });
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"
#include "mneme/scene.h"

#include "fuzz/fuzz_input.h"

namespace {

/// Separates the planning scene from the request.
constexpr std::string_view kMark = "\n---\n";

std::string as_file(std::string_view text, const std::string& name) {
  return mneme::fuzz::as_file(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(),
                              name);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = mneme::fuzz::as_text(data, size);
  const std::size_t end = text.find(kMark);
  const bool has_request = end != std::string_view::npos;
  const std::string scene = as_file(text.substr(0, end), "scene.yaml");
  const std::string request =
      as_file(has_request ? text.substr(end + kMark.size()) : std::string_view(), "request.yaml");
  static const auto robots = mneme::make_problem_cache();
  mneme::ProblemOptions options;
  options.robot_path = "planar8";
  options.cache = robots;
  mneme::fuzz::expect_message(mneme::load_problem(scene + "," + request, options));
  mneme::fuzz::expect_message(mneme::extract_scene(request));
  return 0;
}

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Bodies of requests: problems with attached objects and allowed contacts, tasks, scenes.
#include "mneme/robot.h"

#include "fuzz/fuzz_input.h"
#include "input/input.h"
#include "service/requests.h"

#include <string_view>

namespace {

mneme::ServiceSettings one_thread() {
  mneme::ServiceSettings settings;
  settings.threads = 1;
  return settings;
}

bool is_json(std::string_view body) {
  try {
    static_cast<void>(mneme::internal::parse_json(body, "body"));
    return true;
  } catch (const mneme::internal::InputFailure&) {
    return false;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mneme;
  static const Result<Robot> robot =
      find_robot("planar8").and_then([](const std::string& path) { return load_robot(path); });
  static const ServiceSettings limits = one_thread();
  static const internal::SceneStore scenes(1);
  if (!robot) std::abort();
  const internal::RequestContext context{*robot, scenes, limits};
  const std::string_view body = fuzz::as_text(data, size);
  fuzz::expect_message(internal::read_plan_request(body, "trajectory=true", context));
  if (!is_json(body)) return 0;  // the other readers fail as this one did
  fuzz::expect_message(internal::read_task_request(body, "", context));
  fuzz::expect_message(internal::read_check_request(body, context));
  fuzz::expect_message(internal::read_ik_request(body, context));
  const auto scene = internal::read_scene_request(body, "a", context);
  fuzz::expect_message(scene);
  fuzz::expect_message(internal::edit_scene(body, scene ? *scene : Scene(), context));
  return 0;
}

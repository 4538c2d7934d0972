// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The C interface of the WebAssembly module: the endpoints of the service, without HTTP. One
/// problem is open at a time. Texts are UTF-8 and end with NUL.
#include "mneme/live.h"
#include "mneme/problem.h"
#include "mneme/report.h"

#include "base/files.h"
#include "service/endpoints.h"

#include <emscripten/emscripten.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace mneme::internal {
namespace {

/// The open problem, and the text of the last answer.
struct Planner {
  std::unique_ptr<Endpoints> endpoints;
  std::string answer;
};

Planner& planner() {
  static Planner instance;
  return instance;
}

int tell(Answer answer) {
  planner().answer = std::move(answer.body);
  return answer.status;
}

Result<void> write_text(const std::string& path, std::string_view text) {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  NewFile file = MNEME_TRY(NewFile::create(path));
  MNEME_TRY(file.write(text));
  return file.finish();
}

Result<nlohmann::json> open_problem(const std::string& where) {
  const Problem problem = MNEME_TRY(load_problem(where));
  ServiceSettings settings;
  settings.threads = 1;
  settings.shown = std::make_shared<const Problem>(problem);
  LivePage page = MNEME_TRY(make_live_page(problem, false));
  auto endpoints = std::make_unique<Endpoints>(problem.robot, nullptr, settings, std::move(page));
  MNEME_TRY(endpoints->keep_scene_of_page());
  planner().endpoints = std::move(endpoints);
  return nlohmann::json{{"robot", problem.robot.name()},
                        {"joints", problem.robot.joint_names()},
                        {"isa", to_string(default_isa())},
                        {"start", problem.start},
                        {"goals", problem.goals}};
}

struct Route {
  std::string_view path;
  Answer (Endpoints::*answer)(const Call&);
};

constexpr Route kRoutes[] = {{"/v1/plan", &Endpoints::plan},
                             {"/v1/ik", &Endpoints::inverse_kinematics},
                             {"/v1/check", &Endpoints::check}};

Answer call(std::string_view path, const std::string& body) {
  constexpr std::string_view kPlans = "/v1/plans/", kTrace = "/trace";
  const std::atomic<bool> is_cancelled = false;
  Endpoints* const endpoints = planner().endpoints.get();
  if (endpoints == nullptr) return refusal(409, "invalid", "no problem is open");
  if (path.starts_with(kPlans) && path.ends_with(kTrace)) {
    path.remove_prefix(kPlans.size());
    path.remove_suffix(kTrace.size());
    return endpoints->trace({std::string(path), body, is_cancelled});
  }
  for (const Route& route : kRoutes) {
    if (route.path == path) return (endpoints->*route.answer)({"", body, is_cancelled});
  }
  return refusal(404, "not_found", "there is no " + std::string(path));
}

}  // namespace
}  // namespace mneme::internal

extern "C" {

/// Writes a file of the module's memory, such as a robot's URDF. Returns 200, or 500 with an error
/// as the answer.
EMSCRIPTEN_KEEPALIVE int mneme_add_file(const char* path, const char* text) {
  using namespace mneme::internal;
  const auto written = write_text(path, text);
  return tell(written ? Answer{200, "{}"} : refusal(written.error()));
}

/// Opens a problem, as load_problem() does. The answer has robot, joints, instruction set, start
/// and goals.
EMSCRIPTEN_KEEPALIVE int mneme_open(const char* where) {
  using namespace mneme::internal;
  const auto opened = open_problem(where);
  return tell(opened ? Answer{200, opened->dump()} : refusal(opened.error()));
}

/// Answers a request as the service does (docs/service.md). `path`: /v1/plan, /v1/ik, /v1/check or
/// /v1/plans/ID/trace. Returns the status of HTTP.
EMSCRIPTEN_KEEPALIVE int mneme_call(const char* path, const char* body) {
  return mneme::internal::tell(mneme::internal::call(path, body));
}

/// Returns the JSON text of the last answer; valid until the next call.
EMSCRIPTEN_KEEPALIVE const char* mneme_answer() {
  return mneme::internal::planner().answer.c_str();
}

}  // extern "C"

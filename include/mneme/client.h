// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Plans of a service that `mneme serve` runs (docs/service.md). A library of its own,
/// mneme::client.
#pragma once

#include "mneme/base.h"
#include "mneme/goal.h"
#include "mneme/path.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"
#include "mneme/scene.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme {

struct ClientSettings {
  std::string address = "http://127.0.0.1:7890";  ///< http://HOST:PORT or unix:PATH
  std::string token;                              ///< of a service with --token-file; empty: none
  double timeout_s = 120;                         ///< until an answer must have come
  double patience_s = 30;  ///< of waiting while the service is busy, which it says at once
};

/// A plan that came over HTTP: what of a SolveResult travels.
struct RemotePlan {
  PlanStatus status = PlanStatus::timeout;
  std::string message;  ///< why there is no path; empty if solved
  Path path;
  double path_length = 0;
  double total_time_s = 0;  ///< of the service
  std::uint64_t iterations = 0;
  int remembered = 0;
  std::string json;  ///< all of the answer, with the keys of `mneme plan --json`

  [[nodiscard]] bool is_solved() const { return status == PlanStatus::solved; }
};

/// One connection to a service, which is kept. One per thread. Errors of all requests: io, if the
/// service cannot be reached, does not answer in time or stays busy; what it refuses, in its words
/// and with its code.
class Client {
 public:
  /// Nothing is sent yet. Errors: an address of another form.
  [[nodiscard]] static Result<Client> make(const ClientSettings& settings = {});
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  /// Plans with the service's robot, which must have the problem's joints; what the problem's robot
  /// carries goes along. Of the settings those travel that differ from the defaults; the ones that
  /// are not numbers of visit_settings stay here, but for planner, sampler and kind of memory.
  [[nodiscard]] Result<RemotePlan> plan(const Problem& problem, const SolveSettings& settings = {});
  /// The same in a scene that put_scene() uploaded, instead of the problem's.
  [[nodiscard]] Result<RemotePlan> plan(const Problem& problem, const std::string& scene_id,
                                        const SolveSettings& settings = {});
  /// Free configurations in regions of poses, nearest to `near` first; none is no error.
  [[nodiscard]] Result<std::vector<Configuration>> inverse_kinematics(
      std::span<const PoseGoal> goals, const Configuration& near, const Scene& scene = {},
      const IkSettings& settings = {});

  /// Keeps a scene under an id of letters, digits, '_', '.' and '-'.
  [[nodiscard]] Result<void> put_scene(const std::string& id, const Scene& scene);
  [[nodiscard]] Result<void> delete_scene(const std::string& id);

  /// The body of the answer to any request that docs/schema/service.openapi.json describes, such as
  /// ("GET", "/healthz", "").
  [[nodiscard]] Result<std::string> ask(const std::string& method, const std::string& path,
                                        const std::string& json_body);

 private:
  class State;
  explicit Client(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mneme

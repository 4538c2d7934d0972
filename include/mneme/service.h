// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planning over HTTP: one warm process that serves many clients (docs/service.md). The library is
/// mneme::service.
#pragma once

#include "mneme/base.h"
#include "mneme/cell.h"
#include "mneme/experience.h"
#include "mneme/problem.h"
#include "mneme/robot.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace mneme {

struct ServiceSettings {
  /// HOST:PORT or unix:PATH. Port 0 takes any free port.
  std::string listen = "127.0.0.1:7890";
  /// Clients must send `Authorization: Bearer TOKEN`. Empty: no token; then `listen` must be an
  /// address that other machines cannot reach.
  std::string token = {};
  int threads = 0;
  int queue = 64;
  int connections = 256;
  double longest_plan_s = 60;
  double request_timeout_s = 10;
  double idle_timeout_s = 60;
  std::size_t body_bytes = std::size_t{16} << 20;  ///< largest body of a request
  int obstacles = 10000;
  int points = 1000000;
  int attached = 256;
  int scenes = 100;
  int traces = 32;
  std::uint64_t nodes = 1000000;
  std::optional<int> remember_after = {};  ///< SolveSettings::remember_after of all plans
  bool learn_idle = false;
  double refresh_s = 1;
  /// A problem of the service's robot. The page at `/` begins with this problem. Requests without a
  /// scene and obstacles use its scene. Null: no obstacles, and the robot at rest.
  std::shared_ptr<const Problem> shown = {};
  /// Cells that answer their tasks before anything is planned, the first that can.
  std::vector<std::shared_ptr<const Cell>> cells = {};
  /// The robot's URDF, for visual meshes on the page at `/`; may be empty.
  std::string robot_path = {};
  /// As RobotOptions::package_paths, for visual meshes.
  std::vector<std::string> package_paths = {};
};

/// Declares the numeric settings: name, range and meaning.
template <class Settings, class Visitor>
requires std::is_same_v<std::remove_const_t<Settings>, ServiceSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("threads", s.threads, 0, 4096, "plans that run at a time. 0: one per hardware thread");
  visit("queue", s.queue, 0, 100000,
        "requests that may wait for a thread. More are refused with 503 and Retry-After");
  visit("connections", s.connections, 1, 10000, "connections at a time");
  visit("longest-plan", s.longest_plan_s, 1e-3, 1e6, "largest time limit of a request, seconds");
  visit("request-timeout", s.request_timeout_s, 1e-3, 1e6,
        "seconds to receive a whole request, and to send its answer");
  visit("idle-timeout", s.idle_timeout_s, 1e-3, 1e6, "seconds until an idle connection is closed");
  visit("most-obstacles", s.obstacles, 0, 10000000, "obstacles of a scene");
  visit("most-points", s.points, 0, 1000000000, "points, triangles and cubes of a scene");
  visit("most-attached", s.attached, 0, 100000, "shapes of the attached objects of a request");
  visit("most-scenes", s.scenes, 0, 1000000, "uploaded scenes that are kept");
  visit("traces", s.traces, 1, 100000, "traces of the last plans that are kept");
  visit("most-nodes", s.nodes, std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max(),
        "nodes of a plan, which bound its memory");
  visit("remember-after", s.remember_after, 0, 1000000000,
        "insert the experience of solved problems once this many iterations have accumulated since "
        "the last insertion");
  visit("learn-idle", s.learn_idle, false, true,
        "study problems whose search was long while no request is at work, so that the next ones "
        "of the cell are faster; needs remember-after");
  visit("refresh", s.refresh_s, 1e-3, 1e6,
        "seconds between two searches for new rows of other processes");
}

/// Error: invalid if `listen` is neither HOST:PORT nor unix:PATH. Does not open the address.
[[nodiscard]] Result<void> check_listen(const std::string& listen);

/// An HTTP server with its own threads.
class Service {
 public:
  /// Starts to listen and to answer. `database`: null plans without memory. Errors: the address
  /// cannot be opened, or other machines reach it and there is no token; a setting is out of range;
  /// no threads or file descriptors are left.
  [[nodiscard]] static Result<Service> start(const Robot& robot, std::shared_ptr<Database> database,
                                             const ServiceSettings& settings = {});
  Service(Service&&) noexcept;
  Service& operator=(Service&&) noexcept;
  ~Service();  ///< calls stop()

  /// Returns the address for clients: "http://127.0.0.1:7890" or "unix:/run/mneme.sock".
  [[nodiscard]] const std::string& address() const;
  /// Accepts no more requests, cancels running ones after 0.4 s and returns when all are
  /// answered, mostly within a second.
  void stop();

 private:
  class State;
  explicit Service(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planning over HTTP: one warm process that many clients plan with (docs/service.md). A library of
/// its own, mneme::service.
#pragma once

#include "mneme/base.h"
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
  /// HOST:PORT, where port 0 takes any that is free, or unix:PATH.
  std::string listen = "127.0.0.1:7890";
  /// What clients must send as `Authorization: Bearer TOKEN`; empty for none, which only addresses
  /// of this machine allow.
  std::string token;
  int threads = 0;
  int queue = 64;
  int connections = 256;
  double longest_plan_s = 60;
  double request_timeout_s = 10;
  double idle_timeout_s = 60;
  std::size_t body_bytes = std::size_t{16} << 20;  ///< longest body of a request
  int obstacles = 10000;
  int points = 1000000;
  int scenes = 100;
  int traces = 32;
  std::uint64_t nodes = 1000000;
  std::optional<int> remember_after;  ///< SolveSettings::remember_after of all plans
  double refresh_s = 1;
  /// A problem of the service's robot: requests that say nothing of obstacles are in its scene, and
  /// the page at `/` begins with it. Null: no obstacles, and the robot at rest.
  std::shared_ptr<const Problem> shown;
  std::string robot_path;  ///< the robot's URDF, for its looks on that page; may be empty
  std::vector<std::string> package_paths;  ///< where meshes of its looks are searched
};

/// Declares the settings that are numbers: name, least and greatest value, meaning.
template <class Settings, class Visitor>
requires std::is_same_v<std::remove_const_t<Settings>, ServiceSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("threads", s.threads, 0, 4096, "plans at a time; 0: one per hardware thread");
  visit("queue", s.queue, 0, 100000,
        "requests that may wait for a thread; more are told to try again");
  visit("connections", s.connections, 1, 10000, "clients at a time");
  visit("longest-plan", s.longest_plan_s, 1e-3, 1e6,
        "most seconds that a request may set as its time limit");
  visit("request-timeout", s.request_timeout_s, 1e-3, 1e6,
        "seconds until all of a request must have come, and as long for its answer");
  visit("idle-timeout", s.idle_timeout_s, 1e-3, 1e6,
        "seconds until a connection without requests is closed");
  visit("most-obstacles", s.obstacles, 0, 10000000, "obstacles in a scene");
  visit("most-points", s.points, 0, 1000000000, "points, triangles and cubes of a scene");
  visit("most-scenes", s.scenes, 0, 1000000, "scenes that are kept for clients");
  visit("traces", s.traces, 1, 100000, "last plans whose traces are kept");
  visit("most-nodes", s.nodes, std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max(),
        "nodes of a plan, which bounds memory");
  visit("remember-after", s.remember_after, 0, 1000000000,
        "insert what a solved problem teaches, once this many iterations accumulated since the "
        "last insertion");
  visit("refresh", s.refresh_s, 1e-3, 1e6,
        "seconds between two searches for rows of other processes");
}

/// Error: invalid, if `listen` is neither HOST:PORT nor unix:PATH; whether there is such an address
/// shows when it is listened at.
[[nodiscard]] Result<void> check_listen(const std::string& listen);

/// A server, from start() to stop(). Its threads are its own.
class Service {
 public:
  /// Listens and answers. `database` may be null: then there is no memory. Errors: an address that
  /// cannot be listened at, or that other machines reach while there is no token; settings out of
  /// range; a machine without threads or descriptors.
  [[nodiscard]] static Result<Service> start(const Robot& robot, std::shared_ptr<Database> database,
                                             const ServiceSettings& settings = {});
  Service(Service&&) noexcept;
  Service& operator=(Service&&) noexcept;
  ~Service();  ///< stops

  /// As clients name it: "http://127.0.0.1:7890" or "unix:/run/mneme.sock".
  [[nodiscard]] const std::string& address() const;
  /// Takes no more requests, gives those that run half a second, cancels them then, and returns
  /// once all are answered: within a second, but for what is measured of a path, and traces, which
  /// are finished.
  void stop();

 private:
  class State;
  explicit Service(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mneme

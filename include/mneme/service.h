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
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mneme {

struct ServiceSettings {
  /// HOST:PORT, where port 0 takes any that is free, or unix:PATH.
  std::string listen = "127.0.0.1:7890";
  /// What clients must send as `Authorization: Bearer TOKEN`; empty for none, which only addresses
  /// of this machine allow.
  std::string token;
  int threads = 0;                ///< plans at a time; 0: one per hardware thread
  int queue = 64;                 ///< requests that may wait for a thread; others are refused
  int connections = 256;          ///< at a time, each with a thread that mostly waits
  double longest_plan_s = 60;     ///< most that a request may set as time limit
  double request_timeout_s = 10;  ///< until all of a request must have come
  double idle_timeout_s = 60;     ///< until a connection without requests is closed
  std::size_t body_bytes = std::size_t{16} << 20;  ///< longest body of a request
  int obstacles = 10000;                           ///< most in a scene
  int points = 1000000;                            ///< most points, triangles and cubes of a scene
  int scenes = 100;                                ///< most that are kept
  int traces = 32;                ///< the last plans whose traces are kept, at least one
  std::uint64_t nodes = 1000000;  ///< most of a plan, which bounds memory
  /// SolveSettings::remember_after of all plans; needs a database that may be written.
  std::optional<int> remember_after;
  /// A problem of the service's robot: requests that say nothing of obstacles are in its scene, and
  /// the page at `/` begins with it. Null: no obstacles, and the robot at rest.
  std::shared_ptr<const Problem> shown;
  std::string robot_path;  ///< the robot's URDF, for what it looks like on that page; may be empty
  std::vector<std::string> package_paths;  ///< where meshes of its looks are searched
  double refresh_s = 1;                    ///< how often rows of other processes are looked for
};

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

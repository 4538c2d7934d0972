// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Notices clients that go away while they are planned for.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace mneme::internal {

/// Looks every few milliseconds whether watched clients are still there. All of it is safe from any
/// thread.
class ClientWatch {
 public:
  ClientWatch();
  ClientWatch(const ClientWatch&) = delete;
  ClientWatch& operator=(const ClientWatch&) = delete;
  ~ClientWatch();

  /// As long as it lives, its flag is set soon after the client has closed `socket`, or its half of
  /// it, and once all are cancelled.
  class Watched {
   public:
    Watched(ClientWatch& watch, int socket);
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;
    ~Watched();
    [[nodiscard]] const std::atomic<bool>& is_cancelled() const { return is_cancelled_; }

   private:
    friend class ClientWatch;
    ClientWatch& watch_;
    int socket_;
    std::atomic<bool> is_cancelled_ = false;
  };

  /// Sets the flags of all that is watched, and of what will be.
  void cancel_all();

 private:
  void run();
  void look();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Watched*> watched_;
  bool is_cancelling_ = false;
  bool is_idle_ = false;
  bool must_end_ = false;
  std::thread thread_;
};

}  // namespace mneme::internal

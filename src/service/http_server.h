// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Connections and their threads; httplib reads requests and finds who answers them.
#pragma once

#include "service/connection.h"
#include "service/cpp_httplib.h"
#include "service/listener.h"

#include <atomic>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

namespace mneme::internal {

/// One thread accepts, one more reads and answers per connection. Routes are set before start().
class HttpServer : public httplib::Server {
 public:
  HttpServer(Listener listener, const ConnectionLimits& limits, int most_connections);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer() override;

  /// Errors: io, if the machine has no descriptors or threads left.
  [[nodiscard]] Result<void> start();
  /// Accepts no more and closes idle connections; those that are answered go on.
  void stop_accepting();
  /// Returns once all connections are closed, or after `patience_s`.
  void wait(double patience_s) const;
  /// Cuts the connections that are left, and waits for their threads.
  void join();

  [[nodiscard]] const std::string& address() const { return listener_.address; }
  [[nodiscard]] int connection_count() const { return connection_count_; }
  /// Of the request that this thread answers.
  [[nodiscard]] static HttpConnection& connection();

 private:
  struct Thread {
    std::thread thread;
    Descriptor socket;  ///< closed by the thread, under mutex_
    std::atomic<bool> is_done = false;
  };
  void accept_clients();
  void add_client(Descriptor socket);
  /// False if the machine has no thread for it.
  [[nodiscard]] bool start_thread(Descriptor& socket);
  void serve(Thread& thread);
  void remove_done();

  Listener listener_;
  ConnectionLimits limits_;
  int most_connections_;
  Descriptor stop_event_;
  std::atomic<bool> is_stopping_ = false;
  std::atomic<int> connection_count_ = 0;
  std::thread acceptor_;
  std::mutex mutex_;
  std::list<Thread> threads_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// HTTP/1.1 over sockets by Boost.Beast, with limits of time and size.
#pragma once

#include "service/answer.h"
#include "service/listener.h"
#include "service/request_reader.h"

#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace mneme::internal {

struct HttpLimits {
  double request_timeout_s = 10;  ///< seconds to receive a whole request, and to send its answer
  double idle_timeout_s = 60;
  RequestLimits request = {};
  int connections = 1;
  int busy_requests = 1;  ///< largest number of requests that block a thread at a time
};

/// Called from any thread.
struct HttpHandlers {
  /// Refuses a request by its head, before its body is read.
  std::function<std::optional<Answer>(const HttpRequest&)> refuse;
  /// `is_cancelled` is set when the client disconnects, or by HttpServer::cancel_all().
  std::function<Answer(const HttpRequest&, const std::atomic<bool>& is_cancelled)> answer;
  /// Counts a request that was refused by its head or is malformed.
  std::function<void(int status)> count_refused;
};

/// Serves all connections by a few threads. Each request is answered on one of them. One that has
/// computed for a while goes on at low priority, so that short ones need not share the cores.
class HttpServer {
 public:
  HttpServer(HttpHandlers handlers, const HttpLimits& limits);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  /// Listens as listen_at(). Throws std::system_error without threads, and
  /// boost::system::system_error without file descriptors.
  [[nodiscard]] Result<void> start(const std::string& where, bool may_be_remote);
  /// Accepts no more connections and closes idle ones. Running requests continue.
  void stop_accepting();
  /// Cancels all running and later requests.
  void cancel_all();
  /// Waits until all connections are closed, at most `patience_s`.
  void wait(double patience_s) const;
  /// Cuts the remaining connections and joins all threads.
  void join();

  [[nodiscard]] const std::string& address() const { return listener_->address; }
  [[nodiscard]] int connection_count() const;

 private:
  class Connection;
  void accept();
  void add(asio::basic_stream_socket<asio::generic::stream_protocol, Strand> socket);
  /// Schedules cancel_disconnected(). Call with mutex_ locked.
  void watch();
  void cancel_disconnected();
  void close_listener();
  void run(std::size_t index);
  /// Replaces threads of low priority, which only privileged processes can raise again.
  void replace_threads();

  HttpHandlers handlers_;
  HttpLimits limits_;
  std::atomic<bool> is_stopping_ = false;
  mutable std::mutex mutex_;
  std::set<Connection*> connections_;
  std::set<Connection*> answering_;
  bool is_watching_ = false;
  bool is_cancelling_ = false;
  asio::io_context io_;  ///< owns the connections, which use the members above
  asio::steady_timer watch_timer_;
  asio::steady_timer accept_timer_;
  std::optional<Listener> listener_;
  std::vector<std::thread> threads_;
  std::vector<std::size_t> slow_threads_;  ///< indices of ended threads
  bool is_joining_ = false;
  std::condition_variable has_slow_threads_;
  std::thread replacer_;
};

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/http_server.h"

#include "mneme/base.h"

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mneme::internal {
namespace {

thread_local HttpConnection* current_connection = nullptr;

constexpr std::string_view kTooManyConnections =
    "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 1\r\nConnection: close\r\n"
    "Content-Type: application/json\r\nContent-Length: 74\r\n\r\n"
    "{\"error\":{\"code\":\"busy\",\"message\":\"too many connections: try again soon\"}}";

/// Answers are whole ones and not compressed, as RFC 9110, 14.2 and 12.5.3 allow: httplib would
/// hold one copy per range, and compress at Brotli's slowest, which takes longer than any plan.
void ask_for_plain_answer(httplib::Request& request) {
  request.ranges.clear();
  request.headers.erase("Accept-Encoding");
}

}  // namespace

HttpServer::HttpServer(Listener listener, const ConnectionLimits& limits, int most_connections)
    : listener_(std::move(listener)),
      limits_(limits),
      most_connections_(most_connections),
      stop_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

HttpServer::~HttpServer() {
  stop_accepting();
  join();
}

HttpConnection& HttpServer::connection() { return *current_connection; }

Result<void> HttpServer::start() {
  if (stop_event_.number() < 0) return fail(ErrorCode::io, "cannot listen: too many open files");
  try {
    acceptor_ = std::thread([this] { accept_clients(); });
  } catch (const std::system_error& error) {
    return fail(ErrorCode::io, std::string("cannot listen: no thread to be had: ") + error.what());
  }
  return {};
}

void HttpServer::accept_clients() {
  while (!is_stopping_) {
    std::array<pollfd, 2> sockets = {
        {{listener_.socket.number(), POLLIN, 0}, {stop_event_.number(), POLLIN, 0}}};
    if (poll(sockets.data(), sockets.size(), -1) < 0 || sockets[1].revents != 0) continue;
    Descriptor client(accept4(listener_.socket.number(), nullptr, nullptr, SOCK_CLOEXEC));
    remove_done();
    if (client.number() >= 0) {
      add_client(std::move(client));
    } else {
      // Most likely out of descriptors: the client waits until another one leaves.
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
}

void HttpServer::add_client(Descriptor socket) {
  const int on = 1;
  setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (connection_count_ < most_connections_ && start_thread(socket)) return;
  send(socket.number(), kTooManyConnections.data(), kTooManyConnections.size(),
       MSG_NOSIGNAL | MSG_DONTWAIT);
}

bool HttpServer::start_thread(Descriptor& socket) {
  const std::lock_guard lock(mutex_);
  Thread& thread = threads_.emplace_back();
  thread.socket = std::move(socket);
  ++connection_count_;
  try {
    thread.thread = std::thread([this, &thread] { serve(thread); });
    return true;
  } catch (const std::system_error&) {
    --connection_count_;
    socket = std::move(thread.socket);
    threads_.pop_back();
    return false;
  }
}

void HttpServer::serve(Thread& thread) {
  HttpConnection connection(thread.socket.number(), stop_event_.number(), limits_);
  current_connection = &connection;
  while (!connection.must_close() && connection.wait_for_request()) {
    bool is_closed_by_client = false;
    const bool is_answered =
        process_request(connection, is_stopping_, is_closed_by_client, ask_for_plain_answer);
    const bool is_sent = connection.flush();
    if (!is_answered || !is_sent || is_closed_by_client || is_stopping_) break;
  }
  current_connection = nullptr;
  if (connection.must_close()) connection.drain();
  {
    const std::lock_guard lock(mutex_);
    shutdown(thread.socket.number(), SHUT_RDWR);
    thread.socket = Descriptor();
  }
  --connection_count_;
  thread.is_done = true;
}

void HttpServer::remove_done() {
  const std::lock_guard lock(mutex_);
  threads_.remove_if([](Thread& thread) {
    if (!thread.is_done) return false;
    thread.thread.join();
    return true;
  });
}

void HttpServer::stop_accepting() {
  if (is_stopping_.exchange(true)) return;
  const std::uint64_t one = 1;
  static_cast<void>(!write(stop_event_.number(), &one, sizeof one));
  if (acceptor_.joinable()) acceptor_.join();
  listener_.socket = Descriptor();
  remove_socket_file(listener_);
}

void HttpServer::wait(double patience_s) const {
  const Stopwatch stopwatch;
  while (connection_count_ > 0 && stopwatch.elapsed_s() < patience_s) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void HttpServer::join() {
  std::list<Thread> threads;
  {
    const std::lock_guard lock(mutex_);
    for (Thread& thread : threads_) shutdown(thread.socket.number(), SHUT_RDWR);
    threads.swap(threads_);
  }
  for (Thread& thread : threads) thread.thread.join();
}

}  // namespace mneme::internal

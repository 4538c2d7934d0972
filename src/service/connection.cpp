// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <poll.h>
#include <sys/socket.h>

namespace mneme::internal {
namespace {

constexpr std::size_t kBufferBytes = 16384;
constexpr std::size_t kMostUnsentBytes = std::size_t{1} << 20;
constexpr double kMostDrainS = 1;

using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// True if one of `sockets` has an event before `deadline`.
bool wait_for_event(std::span<pollfd> sockets, Clock::time_point deadline) {
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() < 0) return false;
    const int count = poll(sockets.data(), sockets.size(), static_cast<int>(left.count()) + 1);
    if (count > 0) return true;
    if (count < 0 && errno != EINTR) return false;
  }
}

}  // namespace

HttpConnection::HttpConnection(int socket, int stop_event, const ConnectionLimits& limits)
    : socket_(socket),
      stop_event_(stop_event),
      limits_(limits),
      deadline_(after(limits.request_timeout_s)) {}

bool HttpConnection::wait_for_request() {
  request_bytes_ = in_.size() - taken_;
  most_bytes_ = limits_.head_bytes;
  if (request_bytes_ == 0) {
    std::array<pollfd, 2> sockets = {{{socket_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
    if (!wait_for_event(sockets, after(limits_.idle_timeout_s))) return false;
    if (sockets[1].revents != 0) return false;
  }
  deadline_ = after(limits_.request_timeout_s);
  return true;
}

bool HttpConnection::flush() {
  const auto deadline = after(limits_.request_timeout_s);
  std::size_t sent = 0;
  while (sent < out_.size()) {
    const ssize_t count =
        send(socket_, out_.data() + sent, out_.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    std::array<pollfd, 1> socket = {{{socket_, POLLOUT, 0}}};
    const bool must_wait = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    if (!must_wait || !wait_for_event(socket, deadline)) return false;
  }
  out_.clear();
  return true;
}

void HttpConnection::drain() {
  shutdown(socket_, SHUT_WR);
  in_.resize(kBufferBytes);
  const auto deadline = after(std::min(kMostDrainS, limits_.request_timeout_s));
  std::array<pollfd, 2> sockets = {{{socket_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
  while (Clock::now() < deadline && wait_for_event(sockets, deadline) && sockets[1].revents == 0) {
    if (recv(socket_, in_.data(), in_.size(), MSG_DONTWAIT) <= 0) break;
  }
}

bool HttpConnection::receive() {
  // An interim answer, such as 100 Continue, is what the client waits for.
  if (!flush() || request_bytes_ >= most_bytes_) return false;
  in_.resize(kBufferBytes);
  taken_ = 0;
  ssize_t count = recv(socket_, in_.data(), in_.size(), MSG_DONTWAIT);
  while (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
    std::array<pollfd, 1> socket = {{{socket_, POLLIN, 0}}};
    if (!wait_for_event(socket, deadline_)) break;
    count = recv(socket_, in_.data(), in_.size(), MSG_DONTWAIT);
  }
  in_.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  request_bytes_ += in_.size();
  return !in_.empty();
}

bool HttpConnection::is_readable() const {
  if (taken_ < in_.size()) return true;
  std::array<pollfd, 1> socket = {{{socket_, POLLIN, 0}}};
  return wait_for_event(socket, deadline_);
}

bool HttpConnection::is_writable() const { return true; }

ssize_t HttpConnection::read(char* data, size_t size) {
  if (taken_ == in_.size() && !receive()) return -1;
  const std::size_t count = std::min(size, in_.size() - taken_);
  std::copy_n(in_.data() + taken_, count, data);
  taken_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t HttpConnection::write(const char* data, size_t size) {
  out_.append(data, size);
  if (out_.size() > kMostUnsentBytes && !flush()) return -1;
  return static_cast<ssize_t>(size);
}

// Nobody asks who it is: the token says what may be done.
void HttpConnection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

void HttpConnection::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace mneme::internal

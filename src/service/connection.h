// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The bytes of one client: deadlines for all of a request, and answers in one piece.
#pragma once

#include "service/cpp_httplib.h"

#include <chrono>
#include <cstddef>
#include <string>

namespace mneme::internal {

struct ConnectionLimits {
  double request_timeout_s = 10;
  double idle_timeout_s = 60;
  std::size_t head_bytes = std::size_t{64} << 10;
  std::size_t body_bytes = 0;
};

/// A socket as httplib reads and writes it. What it does not own: the socket. Belongs to the thread
/// of its connection.
class HttpConnection final : public httplib::Stream {
 public:
  HttpConnection(int socket, int stop_event, const ConnectionLimits& limits);

  /// Waits for the first byte of the next request. False if none comes in time, if the client is
  /// gone, or once `stop_event` can be read.
  [[nodiscard]] bool wait_for_request();
  /// The head is as it should be: from here on the body counts, too.
  void expect_body() { most_bytes_ = limits_.head_bytes + limits_.body_bytes; }
  /// Sends what was written. False if the client does not take it.
  bool flush();

  /// The answer is the last one: there may be bytes of this request that nobody has read.
  void close_after_answer() { must_close_ = true; }
  [[nodiscard]] bool must_close() const { return must_close_; }
  /// Says goodbye and takes, for a while, what the client still sends: cut off at once, it might
  /// never read the answer (RFC 9112, 9.6).
  void drain();

  [[nodiscard]] bool is_readable() const override;
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  ssize_t write(const char* data, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Receives into the empty buffer. False at the deadline, at the end, and beyond the limit.
  bool receive();

  int socket_;
  int stop_event_;
  ConnectionLimits limits_;
  Clock::time_point deadline_;
  std::size_t request_bytes_ = 0;
  std::size_t most_bytes_ = 0;  ///< of the request, as far as it is known
  std::string in_;
  std::size_t taken_ = 0;  ///< of in_
  std::string out_;
  bool must_close_ = false;
};

}  // namespace mneme::internal

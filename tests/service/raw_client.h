// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sockets without HTTP, for what no HTTP library would send.
#pragma once

#include "service/service_fixture.h"

#include <string>
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace mneme::test {

inline sockaddr_un unix_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  REQUIRE(path.size() < sizeof address.sun_path);
  path.copy(address.sun_path, path.size());
  return address;
}

/// A client that says what it likes.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  }
  explicit RawClient(const std::string& path, int flags = 0)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | flags, 0)) {
    const sockaddr_un address = unix_address(path);
    is_connected_ =
        connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    REQUIRE((is_connected_ || flags != 0));
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { close(socket_); }

  [[nodiscard]] bool is_connected() const { return is_connected_; }

  /// False if the service takes only a part of it.
  [[nodiscard]] bool offer(const std::string& text) const {
    return send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  void say(const std::string& text) const { REQUIRE(offer(text)); }
  void post(const std::string& path, const Json& body) const {
    const std::string text = body.dump();
    say(
        fmt::format("POST {} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                    "Content-Length: {}\r\n\r\n{}",
                    path, text.size(), text));
  }
  /// All until the service closes the connection, or until `end` has come.
  [[nodiscard]] std::string hear(const std::string& end = "\377", int flags = 0) const {
    std::string text;
    char buffer[4096];
    while (!contains(text, end)) {
      const ssize_t count = recv(socket_, buffer, sizeof buffer, flags);
      if (count <= 0) break;
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }
  /// Returns the bytes that have arrived by now.
  [[nodiscard]] std::string hear_now() const { return hear("\377", MSG_DONTWAIT); }

 private:
  int socket_;
  bool is_connected_ = true;
};

/// Listens at a socket file, and takes nobody.
class Listening {
 public:
  explicit Listening(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    const sockaddr_un address = unix_address(path);
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(listen(socket_, 0) == 0);
  }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
  ~Listening() { close(socket_); }

 private:
  int socket_;
};

inline int count_answers(const std::string& heard) {
  int count = 0;
  for (std::size_t at = heard.find("HTTP/1.1 "); at != std::string::npos;
       at = heard.find("HTTP/1.1 ", at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/listener.h"

#include "mneme/service.h"

#include <fmt/format.h>

#include <netdb.h>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace mneme::internal {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kBacklog = 128;

tl::unexpected<Error> cannot_listen(const std::string& where) {
  return fail(ErrorCode::io, fmt::format("cannot listen at {}: {}", where, std::strerror(errno)));
}

Descriptor new_socket(int family) {
  return Descriptor(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

const sockaddr* generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// HOST and PORT, or the path of a socket.
struct Address {
  std::string host = {}, port = {}, path = {};
};

Result<Address> split_address(const std::string& where) {
  if (where.starts_with(kUnix)) {
    const std::string path = where.substr(kUnix.size());
    constexpr std::size_t kMostBytes = sizeof sockaddr_un{}.sun_path - 1;
    if (!path.empty() && path.size() <= kMostBytes) return Address{.path = path};
    return fail(ErrorCode::invalid,
                fmt::format("'{}': expected unix:PATH with 1 to {} bytes", where, kMostBytes));
  }
  const std::size_t colon = where.rfind(':');
  std::string host = where.substr(0, colon);
  const std::string port = colon == std::string::npos ? "" : where.substr(colon + 1);
  const bool is_number = !port.empty() && port.size() <= 5 &&
                         port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !is_number || std::stoi(port) > 65535) {
    return fail(
        ErrorCode::invalid,
        fmt::format("'{}': expected HOST:PORT, such as 127.0.0.1:7890, or unix:PATH", where));
  }
  const bool is_bracketed = host.starts_with('[') && host.ends_with(']');
  if (is_bracketed) host = host.substr(1, host.size() - 2);
  return Address{.host = std::move(host), .port = port};
}

Result<Listener> listen_at_file(const std::string& path, const std::string& where) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, path.size());
  struct stat file {};
  if (stat(path.c_str(), &file) == 0) {
    if (!S_ISSOCK(file.st_mode)) {
      return fail(ErrorCode::io,
                  fmt::format("cannot listen at {}: it is a file, not a socket", where));
    }
    const Descriptor probe = new_socket(AF_UNIX);
    const bool is_answered = connect(probe.number(), generic(address), sizeof address) == 0;
    // A long line of clients that wait is an answer, too.
    if (is_answered || errno == EAGAIN) {
      return fail(ErrorCode::io, fmt::format("cannot listen at {}: another program does", where));
    }
    if (errno != ECONNREFUSED) return cannot_listen(where);
    unlink(path.c_str());
  }
  Listener listener{new_socket(AF_UNIX), where};
  const int socket = listener.socket.number();
  const mode_t before = umask(0077);
  const bool is_bound = bind(socket, generic(address), sizeof address) == 0;
  umask(before);
  if (!is_bound || listen(socket, kBacklog) != 0 || stat(path.c_str(), &file) != 0) {
    return cannot_listen(where);
  }
  listener.socket_file = path;
  listener.file_number = file.st_ino;
  return listener;
}

bool is_loopback(const in_addr& address) { return ntohl(address.s_addr) >> 24 == IN_LOOPBACKNET; }

bool is_loopback(const sockaddr* address) {
  if (address->sa_family == AF_INET) {
    return is_loopback(reinterpret_cast<const sockaddr_in*>(address)->sin_addr);
  }
  const auto* v6 = reinterpret_cast<const sockaddr_in6*>(address);
  return IN6_IS_ADDR_LOOPBACK(&v6->sin6_addr);
}

int port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  const bool is_v4 = address.ss_family == AF_INET;
  return ntohs(is_v4 ? reinterpret_cast<const sockaddr_in&>(address).sin_port
                     : reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
}

Result<Listener> listen_at_host(const Address& asked, const std::string& where,
                                bool may_be_remote) {
  const std::string& host = asked.host;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), asked.port.c_str(), &hints, &found); code != 0) {
    return fail(ErrorCode::io, fmt::format("cannot listen at {}: {}", where, gai_strerror(code)));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, &freeaddrinfo);
  if (!may_be_remote && !is_loopback(found->ai_addr)) {
    return fail(ErrorCode::invalid,
                fmt::format("other machines reach {}: expected a token that they must know, or an "
                            "address of this machine, such as 127.0.0.1",
                            where));
  }
  Listener listener{new_socket(found->ai_family), ""};
  const int socket = listener.socket.number(), on = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(socket, found->ai_addr, found->ai_addrlen) != 0 || listen(socket, kBacklog) != 0) {
    return cannot_listen(where);
  }
  const bool needs_brackets = host.find(':') != std::string::npos;
  listener.address = fmt::format("http://{}{}{}:{}", needs_brackets ? "[" : "", host,
                                 needs_brackets ? "]" : "", port_of(socket));
  return listener;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (number_ >= 0) close(number_);
  number_ = other.release();
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

int Descriptor::release() { return std::exchange(number_, -1); }

Result<Listener> listen_at(const std::string& where, bool may_be_remote) {
  const auto asked = split_address(where);
  if (!asked) return tl::unexpected(asked.error());
  return asked->path.empty() ? listen_at_host(*asked, where, may_be_remote)
                             : listen_at_file(asked->path, where);
}

void remove_socket_file(const Listener& listener) {
  struct stat file {};
  const bool is_there =
      !listener.socket_file.empty() && stat(listener.socket_file.c_str(), &file) == 0;
  if (is_there && file.st_ino == listener.file_number) unlink(listener.socket_file.c_str());
}

bool is_own_host(const std::string& host, const std::string& address) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string::npos) return false;
  const std::string name = host.substr(0, host.find(':', bracket));
  in_addr v4{};
  in6_addr v6{};
  const std::string inner = bracket > 0 ? name.substr(1, bracket - 1) : "";
  if (inet_pton(AF_INET6, inner.c_str(), &v6) == 1) return IN6_IS_ADDR_LOOPBACK(&v6);
  if (inet_pton(AF_INET, name.c_str(), &v4) == 1) return is_loopback(v4);
  return strcasecmp(name.c_str(), "localhost") == 0 || address.starts_with("http://" + name + ":");
}

}  // namespace mneme::internal

namespace mneme {

Result<void> check_listen(const std::string& listen) {
  return internal::split_address(listen).map([](const auto&) {});
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/listener.h"

#include "mneme/service.h"

#include "base/fail.h"
#include "base/text.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace mneme::internal {
namespace {

using asio::ip::tcp;
using UnixProtocol = asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::string_view kUnix = "unix:";

tl::unexpected<Error> cannot_listen(const std::string& where, const std::string& why) {
  return fail(ErrorCode::io, "cannot listen at {}: {}", where, why);
}

/// HOST and PORT, or the path of a socket.
struct Address {
  std::string host = {}, port = {}, path = {};
};

bool is_port(std::string_view text) {
  return text.size() <= 5 && parse_number<std::uint16_t>(text).has_value();
}

Result<Address> split_address(const std::string& where) {
  if (where.starts_with(kUnix)) {
    const std::string path = where.substr(kUnix.size());
    constexpr std::size_t kMostBytes = sizeof sockaddr_un{}.sun_path - 1;
    if (!path.empty() && path.size() <= kMostBytes) return Address{.path = path};
    return fail(ErrorCode::invalid, "'{}': expected unix:PATH with a path of 1 to {} bytes", where,
                kMostBytes);
  }
  const std::size_t colon = where.rfind(':');
  std::string host = where.substr(0, colon);
  const std::string port = colon == std::string::npos ? "" : where.substr(colon + 1);
  if (host.empty() || !is_port(port)) {
    return fail(ErrorCode::invalid,
                "'{}': expected HOST:PORT, such as 127.0.0.1:7890, or unix:PATH", where);
  }
  const bool is_bracketed = host.starts_with('[') && host.ends_with(']');
  if (is_bracketed) host = host.substr(1, host.size() - 2);
  return Address{.host = std::move(host), .port = port};
}

/// True if a program listens at the socket file, even if its queue of clients is full.
bool is_listened_at(asio::io_context& io, const UnixProtocol::endpoint& endpoint) {
  UnixProtocol::socket probe(io, UnixProtocol());
  probe.native_non_blocking(true);
  return ::connect(probe.native_handle(), endpoint.data(),
                   static_cast<socklen_t>(endpoint.size())) == 0 ||
         errno == EAGAIN;
}

/// Binds the acceptor and listens.
template <class Endpoint>
error_code open(Listener& listener, const Endpoint& endpoint) {
  error_code error;
  listener.acceptor.open(endpoint.protocol(), error);
  if (!error) listener.acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) listener.acceptor.bind(endpoint, error);
  if (!error) listener.acceptor.listen(asio::socket_base::max_listen_connections, error);
  return error;
}

Result<Listener> listen_at_file(asio::io_context& io, const std::string& path,
                                const std::string& where) {
  const UnixProtocol::endpoint endpoint(path);
  struct stat file {};
  if (stat(path.c_str(), &file) == 0) {
    if (!S_ISSOCK(file.st_mode)) return cannot_listen(where, "this is a file, not a socket");
    if (is_listened_at(io, endpoint)) return cannot_listen(where, "another program listens there");
    if (errno != ECONNREFUSED) return cannot_listen(where, std::strerror(errno));
    unlink(path.c_str());
  }
  Listener listener{decltype(Listener::acceptor)(asio::make_strand(io)), where};
  const mode_t before = umask(0077);
  const error_code error = open(listener, endpoint);
  umask(before);
  if (error) return cannot_listen(where, error.message());
  if (stat(path.c_str(), &file) != 0) return cannot_listen(where, std::strerror(errno));
  listener.socket_file = path;
  listener.file_number = file.st_ino;
  return listener;
}

Result<Listener> listen_at_host(asio::io_context& io, const Address& wanted,
                                const std::string& where, bool may_be_remote) {
  error_code error;
  const auto found = tcp::resolver(io).resolve(
      wanted.host, wanted.port, tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error) return cannot_listen(where, error.message());
  const tcp::endpoint endpoint = *found.begin();
  if (!may_be_remote && !endpoint.address().is_loopback()) {
    return fail(
        ErrorCode::invalid,
        "other machines reach {}: set a token, or listen at an address of this machine, such "
        "as 127.0.0.1",
        where);
  }
  Listener listener{decltype(Listener::acceptor)(asio::make_strand(io))};
  error = open(listener, endpoint);
  if (error) return cannot_listen(where, error.message());
  tcp::endpoint bound;
  const auto local = listener.acceptor.local_endpoint();
  std::memcpy(bound.data(), local.data(), local.size());
  const bool needs_brackets = wanted.host.find(':') != std::string::npos;
  listener.address = fmt::format("http://{}{}{}:{}", needs_brackets ? "[" : "", wanted.host,
                                 needs_brackets ? "]" : "", bound.port());
  return listener;
}

}  // namespace

Result<Listener> listen_at(asio::io_context& io, const std::string& where, bool may_be_remote) {
  const Address wanted = MNEME_TRY(split_address(where));
  return wanted.path.empty() ? listen_at_host(io, wanted, where, may_be_remote)
                             : listen_at_file(io, wanted.path, where);
}

void remove_socket_file(const Listener& listener) {
  struct stat file {};
  const bool is_there =
      !listener.socket_file.empty() && stat(listener.socket_file.c_str(), &file) == 0;
  if (is_there && file.st_ino == listener.file_number) unlink(listener.socket_file.c_str());
}

bool is_own_host(std::string_view host, const std::string& address) {
  const bool is_bracketed = host.starts_with('[');
  const std::size_t end = is_bracketed ? host.find(']') : host.find(':');
  if (is_bracketed && end == std::string_view::npos) return false;
  const std::string name(host.substr(is_bracketed ? 1 : 0, is_bracketed ? end - 1 : end));
  const std::string_view rest =
      end == std::string_view::npos ? "" : host.substr(end + (is_bracketed ? 1 : 0));
  if (!rest.empty() && (rest[0] != ':' || !is_port(rest.substr(1)))) return false;
  if (name.find('%') != name.npos) return false;  // make_address() takes a zone for a part of it
  error_code error;
  const auto number = asio::ip::make_address(name, error);
  if (!error) return number.is_loopback() && number.is_v6() == is_bracketed;
  return !is_bracketed && !name.empty() &&
         (strcasecmp(name.c_str(), "localhost") == 0 ||
          address.starts_with("http://" + name + ":"));
}

}  // namespace mneme::internal

namespace mneme {

Result<void> check_listen(const std::string& listen) {
  return internal::split_address(listen).map([](const auto&) {});
}

}  // namespace mneme

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sockets that clients connect to, and the names by which they may call this machine.
#pragma once

#include "mneme/base.h"

#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/strand.hpp>

#include <string>
#include <string_view>
#include <sys/types.h>

namespace mneme::internal {

namespace asio = boost::asio;

using Strand = asio::strand<asio::io_context::executor_type>;

struct Listener {
  asio::basic_socket_acceptor<asio::generic::stream_protocol, Strand> acceptor;
  std::string address = {};      ///< as clients name it
  std::string socket_file = {};  ///< removed at the end; empty for an address of a network
  ino_t file_number = 0;         ///< of socket_file
};

/// Listens at HOST:PORT or unix:PATH. A socket file that nobody listens at is replaced; only its
/// owner can connect to it. `may_be_remote` allows addresses that other machines reach. Errors:
/// invalid, io.
[[nodiscard]] Result<Listener> listen_at(asio::io_context& io, const std::string& where,
                                         bool may_be_remote);
/// Unless another program has put a file of its own in its place.
void remove_socket_file(const Listener& listener);

/// True if `host`, a value of the header Host, names this machine for a client that connected to
/// `address`, a listener's. Any page can give its own name the address of this machine, but sends
/// that name.
[[nodiscard]] bool is_own_host(std::string_view host, const std::string& address);

}  // namespace mneme::internal

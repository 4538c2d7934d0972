// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Listening sockets, and the host names that clients may use for this machine.
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
  std::string address = {};      ///< address for clients
  std::string socket_file = {};  ///< removed at the end; empty for a network address
  ino_t file_number = 0;         ///< inode of socket_file
};

/// Listens at HOST:PORT or unix:PATH. A stale socket file is replaced; only its owner can connect.
/// `may_be_remote` allows addresses that other machines reach. Errors: invalid, io.
[[nodiscard]] Result<Listener> listen_at(asio::io_context& io, const std::string& where,
                                         bool may_be_remote);
/// Removes the socket file unless another program has replaced it.
void remove_socket_file(const Listener& listener);

/// True if the header Host names this machine: a loopback address, localhost or the host of
/// `address`. This refuses web pages whose own host name resolves to this machine.
[[nodiscard]] bool is_own_host(std::string_view host, const std::string& address);

}  // namespace mneme::internal

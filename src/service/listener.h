// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A socket that clients connect to.
#pragma once

#include "mneme/base.h"

#include <string>
#include <sys/types.h>

namespace mneme::internal {

/// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  [[nodiscard]] int number() const { return number_; }
  int release();

 private:
  int number_;
};

struct Listener {
  Descriptor socket;
  std::string address;           ///< as clients name it
  std::string socket_file = {};  ///< to be removed at the end; empty for an address of a network
  ino_t file_number = 0;         ///< of socket_file
};

/// Listens at HOST:PORT or unix:PATH. A socket file that nobody listens at is replaced; it is for
/// its owner alone. `may_be_remote` allows addresses that other machines reach. Errors: invalid,
/// io.
[[nodiscard]] Result<Listener> listen_at(const std::string& where, bool may_be_remote);
/// Unless another program has put a file of its own in its place.
void remove_socket_file(const Listener& listener);

/// True if a client that connected to `address`, a listener's, means this machine by `host`, a
/// value of the header Host. Any page can give its own name the address of this machine, but sends
/// that name.
[[nodiscard]] bool is_own_host(const std::string& host, const std::string& address);

}  // namespace mneme::internal

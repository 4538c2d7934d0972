// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A socket that clients connect to.
#pragma once

#include "mneme/base.h"

#include <string>

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
  std::string address;      ///< as clients name it
  std::string socket_file;  ///< to be removed at the end; empty for an address of a network
};

/// Listens at HOST:PORT or unix:PATH. A socket file that nobody listens at is replaced; it is for
/// its owner alone. `may_be_remote` allows addresses that other machines reach. Errors: invalid, io.
[[nodiscard]] Result<Listener> listen_at(const std::string& where, bool may_be_remote);

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/client_watch.h"

#include <chrono>
#include <poll.h>

namespace mneme::internal {
namespace {

constexpr std::chrono::milliseconds kPeriod{10};
/// Rounds without anybody to watch until it sleeps: to wake it costs a client some microseconds.
constexpr int kIdleRounds = 50;

}  // namespace

ClientWatch::ClientWatch() : thread_([this] { run(); }) {}

ClientWatch::~ClientWatch() {
  {
    const std::lock_guard lock(mutex_);
    must_end_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

ClientWatch::Watched::Watched(ClientWatch& watch, int socket) : watch_(watch), socket_(socket) {
  bool must_wake = false;
  {
    const std::lock_guard lock(watch_.mutex_);
    watch_.watched_.push_back(this);
    is_cancelled_ = watch_.is_cancelling_;
    must_wake = watch_.is_idle_;
  }
  if (must_wake) watch_.wake_.notify_one();
}

ClientWatch::Watched::~Watched() {
  const std::lock_guard lock(watch_.mutex_);
  std::erase(watch_.watched_, this);
}

void ClientWatch::cancel_all() {
  const std::lock_guard lock(mutex_);
  is_cancelling_ = true;
  for (Watched* watched : watched_) watched->is_cancelled_ = true;
}

void ClientWatch::look() {
  std::vector<pollfd> sockets;
  for (const Watched* watched : watched_) sockets.push_back({watched->socket_, POLLRDHUP, 0});
  if (poll(sockets.data(), sockets.size(), 0) <= 0) return;
  for (std::size_t i = 0; i < sockets.size(); ++i) {
    if (sockets[i].revents != 0) watched_[i]->is_cancelled_ = true;
  }
}

void ClientWatch::run() {
  std::unique_lock lock(mutex_);
  for (int idle_rounds = 0; !must_end_;) {
    idle_rounds = watched_.empty() ? idle_rounds + 1 : 0;
    if (!watched_.empty()) look();
    is_idle_ = idle_rounds > kIdleRounds;
    if (is_idle_) {
      wake_.wait(lock, [&] { return must_end_ || !watched_.empty(); });
    } else {
      wake_.wait_for(lock, kPeriod, [&] { return must_end_; });
    }
  }
}

}  // namespace mneme::internal

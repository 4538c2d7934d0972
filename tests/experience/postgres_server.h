// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A PostgreSQL server of the tests' own: in a temporary directory, on a Unix socket only.
#pragma once

#include "experience/fixtures.h"

#include "experience/postgres_connection.h"

#include <fcntl.h>
#include <pwd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

namespace mneme::test {

/// PostgreSQL refuses to run as root: then it runs as the user that Debian's package makes.
class PostgresServer {
 public:
  /// The one server of this program, or null, with a message, where there is none to be had.
  static PostgresServer* instance() {
    static const std::unique_ptr<PostgresServer> server = start_server();
    if (server == nullptr) MESSAGE("skipped: PostgreSQL cannot be started here");
    return server.get();
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;
  ~PostgresServer() { (void)run({"pg_ctl", "-D", data(), "-m", "immediate", "-w", "stop"}); }

  /// The URL of a schema of its own for each call.
  std::string new_url() {
    const std::string schema = "test" + std::to_string(++schema_count_);
    auto connection = internal::PostgresConnection::open(url());
    REQUIRE_MESSAGE(connection.has_value(), (connection ? "" : connection.error().message));
    REQUIRE(connection->query(("CREATE SCHEMA " + schema).c_str()).has_value());
    return url() + "&options=-csearch_path%3D" + schema;
  }
  [[nodiscard]] std::string url() const {
    return "postgresql://mneme@/postgres?host=" + (directory_ / "");
  }

  /// Ends the postmaster without a chance to tidy up.
  void kill_postmaster() const {
    std::ifstream file(data() + "/postmaster.pid");
    pid_t postmaster = 0;
    file >> postmaster;
    REQUIRE(postmaster > 0);
    ::kill(postmaster, SIGKILL);
  }
  /// Its last backends may need a moment to notice that it is gone.
  [[nodiscard]] bool start() const {
    for (int attempt = 0; attempt < 20; ++attempt) {
      if (run({"pg_ctl", "-D", data(), "-o", "-c listen_addresses= -k " + (directory_ / ""), "-l",
               directory_ / "log", "-w", "start"})) {
        return true;
      }
    }
    return false;
  }

 private:
  PostgresServer() = default;

  static std::unique_ptr<PostgresServer> start_server() {
    std::unique_ptr<PostgresServer> server(new PostgresServer);
    server->user_ = ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr;
    if (::geteuid() == 0 && server->user_ == nullptr) return nullptr;
    server->binaries_ = find_binaries();
    if (server->binaries_.empty()) return nullptr;
    if (server->user_ != nullptr && ::chown((server->directory_ / "").c_str(),
                                            server->user_->pw_uid, server->user_->pw_gid) != 0) {
      return nullptr;
    }
    const bool is_made = server->run({"initdb", "-D", server->data(), "-U", "mneme", "-A", "trust",
                                      "-E", "UTF8", "--locale=C", "--no-sync"});
    return is_made && server->start() ? std::move(server) : nullptr;
  }

  static std::string find_binaries() {
    std::error_code missing;
    std::string newest;
    for (const auto& entry : std::filesystem::directory_iterator("/usr/lib/postgresql", missing)) {
      const std::string binaries = entry.path() / "bin";
      if (std::filesystem::exists(binaries + "/initdb")) newest = std::max(newest, binaries);
    }
    return newest;
  }

  [[nodiscard]] std::string data() const { return directory_ / "data"; }

  [[nodiscard]] bool run(std::vector<std::string> words) const {
    words[0] = binaries_ + "/" + words[0];
    return wait_for(start_child([&] {
             const int nowhere = ::open("/dev/null", O_RDWR);
             for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
             if (user_ != nullptr &&
                 (::setgid(user_->pw_gid) != 0 || ::setuid(user_->pw_uid) != 0)) {
               return 126;
             }
             if (::chdir("/") != 0) return 126;
             std::vector<char*> arguments;
             for (std::string& word : words) arguments.push_back(word.data());
             arguments.push_back(nullptr);
             ::execv(arguments[0], arguments.data());
             return 127;
           })) == 0;
  }

  TemporaryDirectory directory_;
  const passwd* user_ = nullptr;
  std::string binaries_;
  int schema_count_ = 0;
};

inline internal::PostgresConnection connect_to(const std::string& url) {
  auto connection = internal::PostgresConnection::open(url);
  REQUIRE_MESSAGE(connection.has_value(), (connection ? "" : connection.error().message));
  return std::move(*connection);
}

}  // namespace mneme::test

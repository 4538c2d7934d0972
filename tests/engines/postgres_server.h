// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A PostgreSQL server of the tests' own: in a temporary directory, on a Unix socket only.
#pragma once

#include "engines/fixtures.h"
#include "engines/postgres_connection.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/socket.h>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

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
  /// Another server, that answers on 127.0.0.1 to those who use TLS, or null where that cannot be
  /// had.
  static std::unique_ptr<PostgresServer> start_with_tls() {
    std::unique_ptr<PostgresServer> server = make_server();
    if (server == nullptr || !server->make_certificate("server") ||
        !server->make_certificate("stranger")) {
      return nullptr;
    }
    server->port_ = free_port();
    server->settings_ = "-c listen_addresses=127.0.0.1 -c ssl=on -c ssl_cert_file=" +
                        server->certificate("server") +
                        " -c ssl_key_file=" + (server->directory_ / "server.key");
    std::ofstream(server->data() + "/pg_hba.conf") << "hostssl all all 127.0.0.1/32 trust\n"
                                                      "local all all trust\n";
    return server->start() ? std::move(server) : nullptr;
  }
  /// A self-signed certificate: "server" is for localhost, "stranger" is nobody's.
  [[nodiscard]] std::string certificate(const std::string& name) const {
    return directory_ / (name + ".crt");
  }
  [[nodiscard]] int port() const { return port_; }

  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;
  ~PostgresServer() { (void)run({"pg_ctl", "-D", data(), "-m", "immediate", "-w", "stop"}); }

  /// The URL of a schema of its own for each call.
  std::string new_url() {
    const std::string schema = "test" + std::to_string(++schema_count_);
    auto connection = require(internal::PostgresConnection::open(url()));
    require(connection.query(("CREATE SCHEMA " + schema).c_str()));
    return url() + "&options=-csearch_path%3D" + schema;
  }
  [[nodiscard]] std::string url() const {
    return "postgresql://mneme@/postgres?host=" + (directory_ / "");
  }

  /// Ends the postmaster without a chance to tidy up.
  void kill_postmaster() const { ::kill(postmaster(), SIGKILL); }
  /// Sends a signal to all processes of the server.
  void signal(int number) const {
    const pid_t parent = postmaster();
    ::kill(parent, number);
    for (const auto& process : std::filesystem::directory_iterator("/proc")) {
      std::ifstream file(process.path() / "stat");
      std::string text;
      std::getline(file, text);
      const std::size_t end = text.rfind(')');  // of the program's name
      if (end == std::string::npos) continue;
      char state = 0;
      pid_t its_parent = 0;
      std::istringstream(text.substr(end + 1)) >> state >> its_parent;
      if (its_parent == parent) ::kill(std::stoi(process.path().filename()), number);
    }
  }
  /// Its last backends may need a moment to notice that it is gone.
  [[nodiscard]] bool start() const {
    for (int attempt = 0; attempt < 20; ++attempt) {
      // After a crash one call puts all on the disk, instead of one for each of a thousand files.
      const std::string options =
          fmt::format("{} -c port={} -k {} -c recovery_init_sync_method=syncfs", settings_, port_,
                      directory_ / "");
      if (run({"pg_ctl", "-D", data(), "-o", options, "-l", directory_ / "log", "-w", "start"})) {
        return true;
      }
    }
    return false;
  }

 private:
  PostgresServer() = default;

  [[nodiscard]] pid_t postmaster() const {
    std::ifstream file(data() + "/postmaster.pid");
    pid_t pid = 0;
    file >> pid;
    REQUIRE(pid > 0);
    return pid;
  }

  static std::unique_ptr<PostgresServer> start_server() {
    std::unique_ptr<PostgresServer> server = make_server();
    return server != nullptr && server->start() ? std::move(server) : nullptr;
  }

  static std::unique_ptr<PostgresServer> make_server() {
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
    return is_made ? std::move(server) : nullptr;
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

  [[nodiscard]] bool make_certificate(const std::string& name) const {
    return run({"/usr/bin/openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2",
                "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout",
                directory_ / (name + ".key"), "-out", certificate(name)});
  }

  static int free_port() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    REQUIRE(::bind(socket, generic, size) == 0);
    REQUIRE(::getsockname(socket, generic, &size) == 0);
    ::close(socket);
    return ntohs(address.sin_port);
  }

  [[nodiscard]] bool run(std::vector<std::string> words) const {
    if (!words[0].starts_with('/')) words[0] = binaries_ + "/" + words[0];
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
  std::string settings_ = "-c listen_addresses=";
  int port_ = 5432;
  int schema_count_ = 0;
};

inline internal::PostgresConnection connect_to(const std::string& url) {
  return require(internal::PostgresConnection::open(url));
}

}  // namespace mneme::test

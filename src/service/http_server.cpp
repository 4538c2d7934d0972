// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/http_server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/write.hpp>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>
#include <poll.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

namespace mneme::internal {
namespace {

namespace beast = boost::beast;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kWatchPeriod{10};
constexpr milliseconds kAcceptPause{10};
constexpr std::chrono::seconds kMostDrain{1};
constexpr std::size_t kReadBytes = 16384;
/// Threads for requests that neither plan nor wait in the queue.
constexpr int kSpareThreads = 4;
/// CPU seconds after which a request goes on at low priority, and bytes of a body that take as long
/// to read.
constexpr double kLongWork_s = 0.005;
constexpr std::size_t kLongBody = 64 << 10;
constexpr int kLongWorkNice = 10;

/// For answers that are data, and for pages, whose styles and scripts are inline.
constexpr const char* kDataPolicy = "default-src 'none'; frame-ancestors 'none'";
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: "
    "blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr std::string_view kTooManyConnections =
    "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 1\r\nConnection: close\r\n"
    "Content-Type: application/json\r\nContent-Length: 74\r\n\r\n"
    "{\"error\":{\"code\":\"busy\",\"message\":\"too many connections: try again soon\"}}";

auto seconds(double value) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(value));
}

thread_local bool has_low_priority = false;

}  // namespace

/// The CPU time of a thread, readable from other threads while it runs.
class ThreadClock {
 public:
  /// The clock of the calling thread.
  ThreadClock() : thread_(gettid()) { pthread_getcpuclockid(pthread_self(), &clock_); }
  [[nodiscard]] double now_s() const {
    timespec time{};
    clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  void lower_priority() const {
    const auto id = static_cast<id_t>(thread_);
    setpriority(PRIO_PROCESS, id, getpriority(PRIO_PROCESS, id) + kLongWorkNice);
  }

 private:
  pid_t thread_;
  clockid_t clock_ = CLOCK_REALTIME;
};

/// A client connection. Requests are answered one after the other, on a strand.
class HttpServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Socket = asio::basic_stream_socket<asio::generic::stream_protocol, Strand>;

  Connection(HttpServer& server, Socket socket)
      : server_(server),
        stream_(std::move(socket)),
        // More than a head may have; bodies are consumed as they arrive.
        buffer_(2 * std::size_t{server.limits_.request.head_bytes}) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    const std::lock_guard lock(server_.mutex_);
    server_.connections_.erase(this);
    server_.answering_.erase(this);
  }

  void start() {
    {
      const std::lock_guard lock(server_.mutex_);
      server_.connections_.insert(this);
    }
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] { self->await_request(); });
  }
  /// Callable from any thread. A running request is finished first.
  void close_if_idle() {
    asio::post(stream_.get_executor(), [self = weak_from_this()] {
      if (const auto connection = self.lock(); connection && connection->is_idle_) {
        connection->stream_.cancel();
      }
    });
  }
  [[nodiscard]] int socket() { return stream_.socket().native_handle(); }
  void cancel() { is_cancelled_ = true; }
  /// Lowers the priority of a request that has computed for long. Call while it is answered.
  void yield_to_short_requests() {
    const bool is_long = reader_->request().body().size() >= kLongBody;
    if (has_yielded_ || (!is_long && clock_.now_s() - begin_s_ < kLongWork_s)) return;
    has_yielded_ = true;
    clock_.lower_priority();
  }

 private:
  /// Returns a handler that calls `member` and keeps the connection alive.
  template <class... Ignored>
  auto then(void (Connection::*member)(error_code)) {
    return [self = shared_from_this(), member](error_code error, Ignored...) {
      (self.get()->*member)(error);
    };
  }

  void await_request() {
    reader_.emplace(server_.limits_.request);
    if (buffer_.size() > 0) return begin_request();
    if (server_.is_stopping_) return;
    is_idle_ = true;
    stream_.expires_after(seconds(server_.limits_.idle_timeout_s));
    read_more(&Connection::end_idling);
  }

  void end_idling(error_code error) {
    is_idle_ = false;
    if (!error) begin_request();
  }

  void begin_request() {
    stream_.expires_after(seconds(server_.limits_.request_timeout_s));
    read_head({});
  }

  void read_more(void (Connection::*next)(error_code)) {
    const std::size_t room = buffer_.max_size() - buffer_.size();
    stream_.async_read_some(buffer_.prepare(std::min(kReadBytes, room)),
                            [self = shared_from_this(), next](error_code error, std::size_t count) {
                              self->buffer_.commit(count);
                              (self.get()->*next)(error);
                            });
  }

  void read_head(error_code error) {
    if (error) return;
    if (auto refused = reader_->read_head(buffer_)) return refuse(*std::move(refused));
    if (!reader_->has_head()) return read_more(&Connection::read_head);
    if (auto refused = server_.handlers_.refuse(reader_->request())) {
      return refuse(*std::move(refused));
    }
    if (reader_->is_done() || !must_invite(reader_->request())) return read_body({});
    asio::async_write(stream_, asio::buffer(kContinue), then<std::size_t>(&Connection::read_body));
  }

  void read_body(error_code error) {
    if (error) return;
    if (auto refused = reader_->read_body(buffer_)) return refuse(*std::move(refused));
    if (!reader_->is_done()) return read_more(&Connection::read_body);
    answer();
  }

  void answer() {
    stream_.expires_never();
    begin_answering();
    Answer found = answer_or_fail();
    end_answering();
    write(std::move(found), reader_->keep_alive() && !server_.is_stopping_);
  }

  Answer answer_or_fail() {
    try {
      return server_.handlers_.answer(reader_->request(), is_cancelled_);
    } catch (...) {  // other clients must still be served
      return refusal(500, "internal", "the request could not be answered");
    }
  }

  void begin_answering() {
    const std::lock_guard lock(server_.mutex_);
    is_cancelled_ = server_.is_cancelling_;
    clock_ = {};
    begin_s_ = clock_.now_s();
    has_yielded_ = has_low_priority;
    server_.answering_.insert(this);
    yield_to_short_requests();
    if (!server_.is_watching_) server_.watch();
  }

  void end_answering() {
    const std::lock_guard lock(server_.mutex_);
    server_.answering_.erase(this);
    has_low_priority = has_yielded_;
  }

  void refuse(Answer answer) {
    server_.handlers_.count_refused(answer.status);
    write(std::move(answer), false);
  }

  void write(Answer answer, bool keeps_alive) {
    const bool is_head = reader_->request().method() == http::verb::head;
    response_ = {};
    response_.result(static_cast<unsigned>(answer.status));
    response_.set(http::field::content_type, answer.type);
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    const bool is_page = std::string_view(answer.type).starts_with("text/html");
    response_.set("Content-Security-Policy", is_page ? kPagePolicy : kDataPolicy);
    if (answer.may_retry) response_.set(http::field::retry_after, "1");
    response_.keep_alive(keeps_alive);
    const bool is_old = reader_->request().version() < 11;  // HTTP/1.0 must be told
    if (keeps_alive && is_old) response_.set(http::field::connection, "keep-alive");
    response_.body() = std::move(answer.body);
    response_.prepare_payload();
    stream_.expires_after(seconds(server_.limits_.request_timeout_s));
    const auto done = then<std::size_t>(keeps_alive ? &Connection::go_on : &Connection::drain);
    if (!is_head) return http::async_write(stream_, response_, done);
    serializer_.emplace(response_);
    http::async_write_header(stream_, *serializer_, done);
  }

  void go_on(error_code error) {
    if (!error) await_request();
  }

  /// Reads on for a while: a client that is cut off at once may never see the answer (RFC
  /// 9112, 9.6).
  void drain(error_code error) {
    if (error) return;
    stream_.socket().shutdown(asio::socket_base::shutdown_send, error);
    stream_.expires_after(std::min<std::chrono::steady_clock::duration>(
        kMostDrain, seconds(server_.limits_.request_timeout_s)));
    discard({});
  }

  void discard(error_code error) {
    if (error || server_.is_stopping_) return;
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kReadBytes), then<std::size_t>(&Connection::discard));
  }

  HttpServer& server_;
  beast::basic_stream<asio::generic::stream_protocol, Strand> stream_;
  beast::flat_buffer buffer_;
  std::optional<RequestReader> reader_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool is_idle_ = false;
  std::atomic<bool> is_cancelled_ = false;
  ThreadClock clock_;  ///< of the thread that answers
  double begin_s_ = 0;
  bool has_yielded_ = false;
};

HttpServer::HttpServer(HttpHandlers handlers, const HttpLimits& limits)
    : handlers_(std::move(handlers)), limits_(limits), watch_timer_(io_), accept_timer_(io_) {}

HttpServer::~HttpServer() {
  stop_accepting();
  join();
}

Result<void> HttpServer::start(const std::string& where, bool may_be_remote) {
  Listener listener = MNEME_TRY(listen_at(io_, where, may_be_remote));
  listener_ = std::move(listener);
  asio::post(listener_->acceptor.get_executor(), [this] { accept(); });
  const int count = std::min(limits_.busy_requests, limits_.connections) + kSpareThreads;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    threads_.emplace_back([this, i] { run(i); });
  }
  replacer_ = std::thread([this] { replace_threads(); });
  return {};
}

/// An exception of a handler, such as std::bad_alloc, ends only its connection.
void HttpServer::run(std::size_t index) {
  while (!io_.stopped() && !has_low_priority) {
    try {
      io_.run_one();
    } catch (const std::exception&) {
      continue;
    }
  }
  if (!has_low_priority) return;
  const std::lock_guard lock(mutex_);
  slow_threads_.push_back(index);
  has_slow_threads_.notify_one();
}

void HttpServer::replace_threads() {
  std::unique_lock lock(mutex_);
  while (!is_joining_) {
    has_slow_threads_.wait(lock, [&] { return is_joining_ || !slow_threads_.empty(); });
    if (is_joining_) return;
    const std::size_t index = slow_threads_.back();
    if (threads_[index].joinable()) {
      std::thread ended = std::move(threads_[index]);
      lock.unlock();
      ended.join();
      lock.lock();
    }
    try {
      threads_[index] = std::thread([this, index] { run(index); });
      std::erase(slow_threads_, index);
    } catch (const std::system_error&) {
      has_slow_threads_.wait_for(lock, kAcceptPause);
    }
  }
}

void HttpServer::accept() {
  if (is_stopping_) return;
  listener_->acceptor.async_accept(
      asio::make_strand(io_), [this](error_code error, Connection::Socket socket) {
        if (!error) {
          // First, because add() may throw.
          accept();
          add(std::move(socket));
        } else if (error != asio::error::operation_aborted) {
          // Most likely no descriptors are left: the client waits until another one leaves.
          accept_timer_.expires_after(kAcceptPause);
          accept_timer_.async_wait(asio::bind_executor(listener_->acceptor.get_executor(),
                                                       [this](error_code) { accept(); }));
        }
      });
}

void HttpServer::add(asio::basic_stream_socket<asio::generic::stream_protocol, Strand> socket) {
  error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  if (connection_count() < limits_.connections) {
    return std::make_shared<Connection>(*this, std::move(socket))->start();
  }
  send(socket.native_handle(), kTooManyConnections.data(), kTooManyConnections.size(),
       MSG_NOSIGNAL | MSG_DONTWAIT);
}

void HttpServer::watch() {
  is_watching_ = true;
  watch_timer_.expires_after(kWatchPeriod);
  watch_timer_.async_wait([this](error_code) { cancel_disconnected(); });
}

void HttpServer::cancel_disconnected() {
  const std::lock_guard lock(mutex_);
  is_watching_ = false;
  if (answering_.empty()) return;
  std::vector<pollfd> sockets;
  for (Connection* connection : answering_) {
    sockets.push_back({connection->socket(), POLLRDHUP, 0});
  }
  poll(sockets.data(), sockets.size(), 0);
  auto socket = sockets.begin();
  for (Connection* connection : answering_) {
    if ((socket++)->revents != 0) connection->cancel();
    connection->yield_to_short_requests();
  }
  watch();
}

void HttpServer::cancel_all() {
  const std::lock_guard lock(mutex_);
  is_cancelling_ = true;
  for (Connection* connection : answering_) connection->cancel();
}

void HttpServer::stop_accepting() {
  if (is_stopping_.exchange(true) || !listener_) return;
  asio::post(listener_->acceptor.get_executor(), [this] { close_listener(); });
  remove_socket_file(*listener_);
  const std::lock_guard lock(mutex_);
  for (Connection* connection : connections_) connection->close_if_idle();
}

int HttpServer::connection_count() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(connections_.size());
}

void HttpServer::wait(double patience_s) const {
  const Stopwatch stopwatch;
  while (connection_count() > 0 && stopwatch.elapsed_s() < patience_s) {
    std::this_thread::sleep_for(milliseconds(1));
  }
}

void HttpServer::join() {
  io_.stop();
  {
    const std::lock_guard lock(mutex_);
    is_joining_ = true;
  }
  has_slow_threads_.notify_one();
  if (replacer_.joinable()) replacer_.join();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
  threads_.clear();
  if (listener_) close_listener();
  const std::lock_guard lock(mutex_);
  for (Connection* connection : connections_) shutdown(connection->socket(), SHUT_RDWR);
}

void HttpServer::close_listener() {
  error_code ignored;
  listener_->acceptor.close(ignored);
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From the bytes of a connection to requests of HTTP/1.1, without sockets.
#pragma once

#include "service/answer.h"

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include <cstdint>
#include <optional>
#include <string_view>

namespace mneme::internal {

namespace http = boost::beast::http;

/// A request with all values as received: nothing is decoded.
using HttpRequest = http::request<http::string_body>;

/// True if requests of this method must have a body.
[[nodiscard]] bool takes_body(const HttpRequest& request);
/// True if the client waits for "100 Continue" before it sends the body. Clients of HTTP/1.0 take
/// that for the answer (RFC 9110, 10.1.1).
[[nodiscard]] bool must_invite(const HttpRequest& request);

struct RequestLimits {
  std::uint32_t head_bytes = 64 << 10;
  std::uint64_t body_bytes = 0;
};

/// Reads one request. One that may end in two places is refused (RFC 9112, 6.3 and 11.2): if a
/// proxy in front of the service sees another end, the body of one client becomes a request of the
/// next.
class RequestReader {
 public:
  explicit RequestReader(const RequestLimits& limits);
  RequestReader(const RequestReader&) = delete;
  RequestReader& operator=(const RequestReader&) = delete;
  ~RequestReader() = default;

  /// Consumes the head from `bytes`, once they hold all of it. Returns a refusal as soon as no head
  /// can come.
  [[nodiscard]] std::optional<Answer> read_head(boost::beast::flat_buffer& bytes);
  [[nodiscard]] bool has_head() const { return parser_.is_header_done(); }
  /// Consumes what `bytes` hold of the body. Call after the head, with all bytes not yet consumed.
  [[nodiscard]] std::optional<Answer> read_body(boost::beast::flat_buffer& bytes);
  [[nodiscard]] bool is_done() const { return parser_.is_done(); }

  /// The request as read so far.
  [[nodiscard]] const HttpRequest& request() const { return parser_.get(); }
  /// True if the connection may bring further requests. Call after the head.
  [[nodiscard]] bool keep_alive() const { return parser_.keep_alive(); }

 private:
  /// Consumes up to `size` bytes.
  void parse(boost::beast::flat_buffer& bytes, std::size_t size, boost::system::error_code& error);
  void check_chunk(std::uint64_t size, std::string_view line, boost::system::error_code& error);
  [[nodiscard]] Answer refuse(const boost::system::error_code& error) const;

  struct CheckChunk {
    RequestReader& reader;
    void operator()(std::uint64_t size, boost::beast::string_view extensions,
                    boost::system::error_code& error) const {
      reader.check_chunk(size, {extensions.data(), extensions.size()}, error);
    }
  };

  RequestLimits limits_;
  std::size_t extension_bytes_ = 0;  ///< in the lines of chunks so far
  std::size_t seen_ = 0;             ///< bytes of the head that arrived before, without a flaw
  std::string_view bytes_;           ///< those being parsed
  CheckChunk check_chunk_{*this};
  http::request_parser<http::string_body> parser_;
};

}  // namespace mneme::internal

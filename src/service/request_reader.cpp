// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/request_reader.h"

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/string.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr std::string_view kHeadEnd = "\r\n\r\n";

std::string_view text_of(const boost::beast::flat_buffer& bytes) {
  return {static_cast<const char*>(bytes.cdata().data()), bytes.size()};
}

/// Says why a head, or the beginning of one, may be read in two ways; empty if it cannot. A line
/// ends by CR LF, and a value does not go on in the next line (RFC 9112, 2.2 and 5.2). Looks from
/// byte `begin` on.
std::string_view find_head_flaw(std::string_view head, std::size_t begin = 0) {
  for (std::size_t i = begin; i < head.size(); ++i) {
    const char c = head[i], before = i == 0 ? ' ' : head[i - 1];
    if (c == '\0') return "expected a head without NUL";
    if ((c == '\n') != (before == '\r')) return "expected lines of the head to end with CR LF";
    if (before == '\n' && (c == ' ' || c == '\t')) return "expected each header on one line";
  }
  return {};
}

Answer refuse_request(std::string_view message) { return refusal(400, "invalid", message); }

/// Refuses a head that leaves open where the request ends. Beast accepts repeated lengths and
/// encodings other than chunked.
std::optional<Answer> refuse_framing(const HttpRequest& request) {
  const std::size_t lengths = request.count(http::field::content_length);
  const std::size_t encodings = request.count(http::field::transfer_encoding);
  if (lengths + encodings > 1) {
    return refuse_request("expected one Content-Length or Transfer-Encoding");
  }
  if (request.count(http::field::host) > 1) return refuse_request("expected one header Host");
  const auto length = request[http::field::content_length];
  if (length.find(',') != boost::beast::string_view::npos) {
    return refuse_request("Content-Length: expected a whole number");
  }
  if (encodings > 0 &&
      (request.version() < 11 ||
       !boost::beast::iequals(request[http::field::transfer_encoding], "chunked"))) {
    return refuse_request("Transfer-Encoding: expected chunked, of HTTP/1.1");
  }
  const bool has_body = encodings > 0 || (lengths > 0 && length != "0");
  if (has_body && !takes_body(request) && request.method() != http::verb::delete_) {
    return refuse_request("expected no body");
  }
  if (takes_body(request) && lengths + encodings == 0) {
    return refusal(411, "invalid", "expected the header Content-Length");
  }
  return std::nullopt;
}

}  // namespace

bool must_invite(const HttpRequest& request) {
  return request.version() >= 11 &&
         boost::beast::iequals(request[http::field::expect], "100-continue");
}

bool takes_body(const HttpRequest& request) {
  const http::verb method = request.method();
  return method == http::verb::post || method == http::verb::put || method == http::verb::patch;
}

RequestReader::RequestReader(const RequestLimits& limits) : limits_(limits) {
  parser_.header_limit(limits.head_bytes);
  parser_.body_limit(limits.body_bytes);
  parser_.on_chunk_header(check_chunk_);
}

/// Beast gets the whole head at once: it joins folded lines, which are found before. Each byte is
/// examined once, in whatever pieces the head arrives.
std::optional<Answer> RequestReader::read_head(boost::beast::flat_buffer& bytes) {
  const std::string_view text = text_of(bytes);
  const std::size_t end = text.find(kHeadEnd, seen_ - std::min(seen_, kHeadEnd.size() - 1));
  const bool is_whole = end != std::string_view::npos;
  const std::size_t size = is_whole ? end + kHeadEnd.size() : text.size();
  if (size > limits_.head_bytes) return refuse(http::error::header_limit);
  if (const auto flaw = find_head_flaw(text.substr(0, size), seen_); !flaw.empty()) {
    return refuse_request(flaw);
  }
  seen_ = size;
  if (!is_whole) return std::nullopt;
  boost::system::error_code error;
  parse(bytes, size, error);
  if (error) return refuse(error);
  return refuse_framing(request());
}

/// Beast expects the shortest end of a chunked body, 0 CR LF CR LF, at once.
std::optional<Answer> RequestReader::read_body(boost::beast::flat_buffer& bytes) {
  const std::size_t least = parser_.chunked() ? 5 : 1;
  boost::system::error_code error;
  while (!is_done() && !error && bytes.size() >= least) parse(bytes, bytes.size(), error);
  if (error == http::error::need_more && bytes.size() <= limits_.head_bytes) return std::nullopt;
  // The line of one chunk, or the trailers, are longer than a head may be.
  if (error == http::error::need_more) return refuse(http::error::header_limit);
  if (error) return refuse(error);
  return std::nullopt;
}

void RequestReader::parse(boost::beast::flat_buffer& bytes, std::size_t size,
                          boost::system::error_code& error) {
  bytes_ = text_of(bytes).substr(0, size);
  bytes.consume(parser_.put(boost::asio::buffer(bytes_.data(), size), error));
}

/// Checks the line of a chunk as find_head_flaw() checks a head, and trailers: Beast has all of
/// them when it tells of the last chunk, of size 0. All extensions together are limited as a head.
void RequestReader::check_chunk(std::uint64_t size, std::string_view line,
                                boost::system::error_code& error) {
  extension_bytes_ += line.size();
  if (extension_bytes_ > limits_.head_bytes) {
    error = http::error::header_limit;
    return;
  }
  if (size == 0) {
    line = bytes_.substr(static_cast<std::size_t>(line.data() - bytes_.data()));
    line = line.substr(0, line.find(kHeadEnd) + kHeadEnd.size());
  }
  if (!find_head_flaw(line).empty()) error = http::error::bad_chunk_extension;
}

Answer RequestReader::refuse(const boost::system::error_code& error) const {
  if (error == http::error::body_limit) {
    return refusal(413, "refused",
                   fmt::format("expected a body of at most {} bytes", limits_.body_bytes));
  }
  if (error == http::error::header_limit) {
    return refusal(431, "refused",
                   fmt::format("expected a head of at most {} bytes{}", limits_.head_bytes,
                               has_head() ? ", and as much in the lines of chunks" : ""));
  }
  return refuse_request(fmt::format("the request is not HTTP/1.1: {}", error.message()));
}

}  // namespace mneme::internal

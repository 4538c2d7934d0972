// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Where requests end on a connection: as another reader says, and however the bytes arrive.
#include "fuzz/fuzz_input.h"
#include "fuzz/strict_framing.h"
#include "service/request_reader.h"

#include <boost/asio/buffer.hpp>

#include <optional>
#include <vector>

namespace mneme::fuzz {
namespace {

constexpr internal::RequestLimits kLimits = {.head_bytes = 512, .body_bytes = 512};

/// Reads the requests of what arrives in pieces of `step` bytes. After a chunk extension with an
/// open quotation Beast may wait for more or refuse; neither is a request.
class Connection {
 public:
  std::vector<FramedRequest> read(std::string_view said, std::size_t step) {
    for (std::size_t at = 0; at < said.size(); at += step) {
      const std::string_view piece = said.substr(at, step);
      boost::asio::buffer_copy(bytes_.prepare(piece.size()),
                               boost::asio::buffer(piece.data(), piece.size()));
      bytes_.commit(piece.size());
      arrived_ += piece.size();
      while (advance()) {
      }
      if (is_refused_) break;
    }
    return requests_;
  }

 private:
  /// True if another request may follow in what has arrived.
  bool advance() {
    if (!reader_) reader_.emplace(kLimits);
    auto refused = reader_->has_head() ? std::nullopt : reader_->read_head(bytes_);
    if (!refused && reader_->has_head()) refused = reader_->read_body(bytes_);
    is_refused_ = refused.has_value();
    if (refused && (refused->body.empty() || refused->status < 400)) std::abort();
    if (refused || !reader_->is_done()) return false;
    const std::size_t end = arrived_ - bytes_.size();
    requests_.push_back({end - begin_, reader_->request().body()});
    begin_ = end;
    reader_.reset();
    return bytes_.size() > 0;
  }

  boost::beast::flat_buffer bytes_;
  std::optional<internal::RequestReader> reader_;
  std::size_t arrived_ = 0, begin_ = 0;
  std::vector<FramedRequest> requests_;
  bool is_refused_ = false;
};

}  // namespace
}  // namespace mneme::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mneme::fuzz;
  if (size < 2) return 0;
  std::string_view said = as_text(data + 1, size - 1);
  const auto requests = Connection().read(said, said.size());
  if (Connection().read(said, 1 + data[0] % 64) != requests) std::abort();
  for (const FramedRequest& request : requests) {
    if (frame_request(said) != request) std::abort();
    said.remove_prefix(request.size);
  }
  return 0;
}

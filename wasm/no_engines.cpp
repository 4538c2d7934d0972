// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Stands for the room engines: a module in a browser has no database. Also for the page of the
// viewer, which contains the module instead.
#include "base/fail.h"
#include "engines/open_store.h"
#include "report/trace.h"

namespace mneme::internal {
namespace {

tl::unexpected<Error> refuse(const std::string& url) {
  return fail(ErrorCode::unsupported, url + ": WebAssembly modules open no database; plan without");
}

}  // namespace

Result<std::unique_ptr<Store>> open_store(const std::string& url, OpenMode, const OpenOptions&) {
  return refuse(url);
}
Result<OpenedStore> open_store_of(const std::string& url, const RobotSignature&, OpenMode,
                                  const OpenOptions&) {
  return refuse(url);
}
Result<OpenedStore> inspect_store(const std::string& url, const OpenOptions&) {
  return refuse(url);
}
Error with_advice(Error error, const std::string&) { return error; }
Result<Engine> engine_of(const std::string&) { return Engine::sqlite; }
std::string lasting_url(const std::string& url) { return url; }
std::string without_password(const std::string& url) { return url; }

std::string_view viewer_page() { return {}; }

}  // namespace mneme::internal

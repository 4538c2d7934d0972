// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/open_store.h"

#include "base/fail.h"
#include "engines/postgres_store.h"
#include "store/row_check.h"
#include "engines/sqlite_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>

namespace mneme::internal {
namespace {

constexpr std::string_view kHidden = "***";

std::string scheme_of(const std::string& url) {
  const std::size_t end = url.find("://");
  if (end == std::string::npos) return "";
  const std::string scheme = url.substr(0, end);
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  return std::ranges::all_of(scheme, is_letter) ? scheme : "";
}

}  // namespace

Result<Engine> engine_of(const std::string& url) {
  const std::string scheme = scheme_of(url);
  if (scheme.empty()) return Engine::sqlite;
  if (scheme == "postgresql" || scheme == "postgres") return Engine::postgresql;
  return fail(ErrorCode::unsupported,
              "{}: unknown scheme '{}'; expected the path of an SQLite file or postgresql://...",
              without_password(url), scheme);
}

std::string lasting_url(const std::string& url) {
  if (engine_of(url) != Engine::sqlite) return url;
  std::error_code error;
  const auto path = std::filesystem::absolute(url, error);
  return error ? url : path.string();
}

std::string without_password(const std::string& url) {
  std::string shown = url;
  const std::size_t scheme = shown.find("://");
  if (scheme == std::string::npos) return shown;
  const std::size_t begin = scheme + 3;
  // libpq accepts a question mark within a password.
  const std::size_t host_end = std::min(shown.find('/', begin), shown.size());
  const std::size_t at = shown.rfind('@', host_end);
  const std::size_t colon = shown.find(':', begin);
  if (at != std::string::npos && at >= begin && colon < at) {
    shown.replace(colon + 1, at - colon - 1, kHidden);
  }
  constexpr std::string_view kKey = "password=";  // and with it sslpassword
  std::size_t found = shown.find(kKey);
  for (; found != std::string::npos; found = shown.find(kKey, found)) {
    found += kKey.size();
    const std::size_t end = std::min(shown.find('&', found), shown.size());
    shown.replace(found, end - found, kHidden);
  }
  return shown;
}

namespace {

#ifndef MNEME_HAS_POSTGRESQL
tl::unexpected<Error> refuse_postgres(const std::string& url) {
  return fail(ErrorCode::unsupported,
              "{}: this mneme was built without PostgreSQL; build it where libpq-dev is installed",
              without_password(url));
}
#endif

/// Reads schema version and signature.
Result<OpenedStore> identified(std::unique_ptr<Store> store) {
  OpenedStore opened;
  opened.schema_version = MNEME_TRY(store->schema_version());
  if (opened.schema_version > 0) opened.signature = MNEME_TRY(store->signature());
  opened.store = std::move(store);
  return opened;
}

}  // namespace

Result<std::unique_ptr<Store>> open_store(const std::string& url, OpenMode mode,
                                          const OpenOptions& options) {
  const auto engine = MNEME_TRY(engine_of(url));
  if (engine == Engine::sqlite) {
    return open_sqlite_store(url, mode, options.loss_check, kMigrationTimeoutMs,
                             options.patience.stop);
  }
#ifdef MNEME_HAS_POSTGRESQL
  return open_postgres_store(url, mode, options.patience);
#else
  return refuse_postgres(url);
#endif
}

Result<OpenedStore> open_store_of(const std::string& url, const RobotSignature& signature,
                                  OpenMode mode, const OpenOptions& options) {
  if (signature.joint_count < 1) {
    return fail(ErrorCode::invalid, "{}: cannot hold experience of {}", without_password(url),
                describe(signature));
  }
  std::error_code error;
  const auto engine = MNEME_TRY(engine_of(url));
  const bool is_new = engine == Engine::sqlite && mode == OpenMode::create && !url.empty() &&
                      !std::filesystem::exists(std::filesystem::symlink_status(url, error));
  if (is_new) {
    auto store = MNEME_TRY(new_sqlite_store(url, signature, options.patience.stop));
    return OpenedStore{std::move(store), signature, 0};
  }
  auto opened = open_store(url, mode, options).and_then(identified);
  if (!opened) return opened;
  if (opened->schema_version == 0) {
    if (mode == OpenMode::read_only) {
      opened->signature = signature;
      return opened;
    }
    MNEME_TRY(opened->store->create(signature));
    opened = identified(std::move(opened->store));
    if (!opened) return opened;
  }
  if (!is_same_robot(opened->signature, signature)) {
    return refuse_robot(opened->store->name(), opened->signature, signature);
  }
  return opened;
}

Result<OpenedStore> inspect_store(const std::string& url, const OpenOptions& options) {
  return open_store(url, OpenMode::read_only, options).and_then(identified);
}

Result<std::unique_ptr<TaskQueue>> open_tasks(const std::string& url,
                                              const RobotSignature& signature, TaskOwner owner) {
  const auto engine = MNEME_TRY(engine_of(url));
  if (engine == Engine::sqlite) {
    return fail(ErrorCode::unsupported,
                "{}: workers can share tasks only on a PostgreSQL server; with files, learn in "
                "shards and merge them",
                url);
  }
#ifdef MNEME_HAS_POSTGRESQL
  return open_postgres_tasks(url, signature, std::move(owner));
#else
  (void)signature;
  (void)owner;
  return refuse_postgres(url);
#endif
}

Error with_advice(Error error, const std::string& url) {
  if (error.code == ErrorCode::corrupt) {
    error.message += fmt::format("; `mneme db verify {}` lists the damage and what to do",
                                 without_password(url));
  }
  return error;
}

}  // namespace mneme::internal

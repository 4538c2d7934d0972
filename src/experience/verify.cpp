// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"

#include "experience/database_file.h"
#include "experience/experience_table.h"
#include "experience/schema.h"

namespace mneme {
namespace {

using internal::Connection;

/// Takes what says that the file is damaged as a finding; anything else ends the verification.
Result<void> note(const Error& error, std::vector<Damage>& damages) {
  if (error.code != ErrorCode::corrupt) return tl::unexpected(error);
  damages.push_back({0, error.message});
  return {};
}

Result<void> verify_pages(Connection& connection, std::vector<Damage>& damages) {
  auto statement = connection.prepare("PRAGMA integrity_check");
  if (!statement) return note(statement.error(), damages);
  for (;;) {
    const auto has_row = statement->step();
    if (!has_row) return note(has_row.error(), damages);
    if (!*has_row) return {};
    if (statement->text(0) != "ok") damages.push_back({0, std::string(statement->text(0))});
  }
}

Result<void> verify_rows(Connection& connection, std::vector<Damage>& damages) {
  const auto space = internal::read_space(connection);
  if (!space) return note(space.error(), damages);
  const auto read = internal::read_rows(connection, [&](const internal::StoredRow& row) {
    Experience experience;
    if (const auto flaw = internal::decode(row.content, row.checksum, *space, experience)) {
      damages.push_back({row.id, *flaw});
    }
    return Result<void>();
  });
  return read ? Result<void>() : note(read.error(), damages);
}

Result<void> verify(Connection& connection, std::vector<Damage>& damages) {
  auto transaction = internal::Transaction::begin(connection, internal::Transaction::Kind::read);
  if (!transaction) return note(transaction.error(), damages);
  const auto kind = internal::identify(connection);
  if (!kind) return note(kind.error(), damages);
  if (*kind == internal::FileKind::empty) return {};
  return verify_pages(connection, damages).and_then([&] {
    return verify_rows(connection, damages);
  });
}

}  // namespace

Result<std::vector<Damage>> verify_database(const std::string& path) {
  std::vector<Damage> damages;
  auto connection = internal::open_for_reading(path);
  const auto verified =
      connection ? verify(*connection, damages) : note(connection.error(), damages);
  if (!verified) return tl::unexpected(verified.error());
  return damages;
}

}  // namespace mneme

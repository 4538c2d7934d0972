// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/experience.h"
#include "mneme/upkeep.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = mneme::fuzz::as_file(data, size, "experience.db");
  for (const char* suffix : {"-wal", "-shm", "-journal"}) ::unlink((path + suffix).c_str());
  const auto database = mneme::Database::inspect(path);
  mneme::fuzz::expect_message(database);
  mneme::fuzz::expect_message(mneme::verify_database(path));
  if (!database) return 0;
  for (std::int64_t i = 0; i < database->size(); ++i) (void)database->get(i);
  return 0;
}

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store.h"

#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a state is its numbers in the order of the columns") {
    const internal::StoreState state{1, 2, 3, 4, 5, 6, 7, 8};
    const auto numbers = internal::to_numbers(state);
    CHECK(numbers == std::array<std::int64_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(internal::to_state(numbers) == state);
  }

  TEST_CASE("every part of a tombstone and of a space counts for its checksum") {
    const internal::Tombstone tombstone{1, 2, 3, "reason", "time", 0};
    for (const internal::Tombstone& other : {internal::Tombstone{2, 2, 3, "reason", "time", 0},
                                             {1, 1, 3, "reason", "time", 0},
                                             {1, 2, 4, "reason", "time", 0},
                                             {1, 2, 3, "other", "time", 0},
                                             {1, 2, 3, "reason", "late", 0}}) {
      CHECK(checksum_of(other) != checksum_of(tombstone));
    }
    const ExperienceSpace space{"arm", "0123", 3};
    for (const ExperienceSpace& other :
         {ExperienceSpace{"leg", "0123", 3}, {"arm", "0124", 3}, {"arm", "0123", 4}}) {
      CHECK(internal::checksum_of(other) != internal::checksum_of(space));
    }
  }
}

}  // namespace mneme::test

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/compound_grids.h"

#include <cstddef>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace mneme::internal {
namespace {

constexpr std::size_t kPage = std::size_t{1} << 21;
/// Less than this does not fill enough of a page.
constexpr std::size_t kLeast = kPage / 4;

class LargePages : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes < kLeast) return ::operator new (bytes, std::align_val_t{alignment});
    const std::size_t whole = (bytes + kPage - 1) / kPage * kPage;
    void* const memory = ::operator new (whole, std::align_val_t{kPage});
#ifdef MADV_HUGEPAGE
    // Where there are none, the memory is as good but slower to fill.
    (void)madvise(memory, whole, MADV_HUGEPAGE);
#endif
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    ::operator delete (memory, std::align_val_t{bytes < kLeast ? alignment : kPage});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

}  // namespace

std::pmr::memory_resource* large_pages() {
  static LargePages pages;
  return &pages;
}

}  // namespace mneme::internal

// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// What the headers of libc++ 16 declare and emscripten's library of libc++ 13 lacks: memory
// resources.
#include <memory_resource>

#include <new>

namespace std::inline __2::pmr {  // as _LIBCPP_ABI_NAMESPACE says
namespace {

class NewDelete : public memory_resource {
  void* do_allocate(size_t bytes, size_t alignment) override {
    return ::operator new (bytes, align_val_t{alignment});
  }
  void do_deallocate(void* memory, size_t, size_t alignment) override {
    ::operator delete (memory, align_val_t{alignment});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

}  // namespace

memory_resource::~memory_resource() = default;

memory_resource* new_delete_resource() noexcept {
  static NewDelete resource;
  return &resource;
}

memory_resource* get_default_resource() noexcept { return new_delete_resource(); }

void* monotonic_buffer_resource::do_allocate(size_t bytes, size_t alignment) {
  // A chunk per request; its footer stands behind the bytes and lets release() free it.
  const size_t align = alignment < alignof(__chunk_footer) ? alignof(__chunk_footer) : alignment;
  const size_t used = (bytes + align - 1) / align * align;
  char* const start = static_cast<char*>(__res_->allocate(used + sizeof(__chunk_footer), align));
  __chunks_ = ::new (start + used) __chunk_footer{__chunks_, start, start, align};
  return start;
}

}  // namespace std::inline __2::pmr

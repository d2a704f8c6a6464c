#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Counts every operator new of a program. Include it in one of its files.

namespace krok::test {

inline std::atomic<long> allocations{0};

// Not inlined, so that the compiler sees no pair of an allocation and another's release.
[[gnu::noinline]] inline void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) std::abort();
  return memory;
}

[[gnu::noinline]] inline void release(void* memory) {
  std::free(memory);
}

}  // namespace krok::test

void* operator new(std::size_t size) {
  return krok::test::counted(size == 0 ? 1 : size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return krok::test::counted(size == 0 ? 1 : size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return krok::test::counted(size == 0 ? 1 : size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  krok::test::release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  krok::test::release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  krok::test::release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  krok::test::release(memory);
}

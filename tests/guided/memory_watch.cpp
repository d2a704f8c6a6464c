#include "guided/memory_watch.h"

#include <atomic>
#include <cstddef>

#ifdef __SANITIZE_ADDRESS__
// Of its interface (compiler-rt, sanitizer/allocator_interface.h), which GCC has without the
// header. NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*, std::size_t),
                                              void (*freed)(const volatile void*));
std::size_t __sanitizer_get_allocated_size(const volatile void* place);
}
// NOLINTEND(bugprone-reserved-identifier)
#endif

namespace krok::guided {

namespace {

std::atomic<std::int64_t> used = 0, peak = 0;

#ifdef __SANITIZE_ADDRESS__
void count(const volatile void* /*place*/, std::size_t size) {
  const std::int64_t now = used += static_cast<std::int64_t>(size);
  std::int64_t before = peak.load();
  while (now > before && !peak.compare_exchange_weak(before, now)) {
  }
}

void uncount(const volatile void* place) {
  used -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(place));
}

const int installed = __sanitizer_install_malloc_and_free_hooks(count, uncount);
#endif

}  // namespace

void begin_memory_watch() {
  // What was allocated before the hooks were there may be freed after.
  used = 0;
  peak = 0;
}

std::int64_t peak_memory() {
  return peak;
}

}  // namespace krok::guided

#include <cstdint>

// Coverage for AFL++ from GCC's own instrumentation, -fsanitize-coverage=trace-pc: AFL++'s plugin
// for GCC only loads into the very build of the compiler that it was made with. The map and the
// function are AFL++'s and GCC's interfaces (AFL++, docs/fuzzing_in_depth.md; GCC, Program
// Instrumentation Options).

// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" unsigned char* __afl_area_ptr;  // 65,536 counters unless more were asked for

// Called at each edge: counts the pair of this place and the last one.
extern "C" void __sanitizer_cov_trace_pc() {
  static thread_local std::uintptr_t last = 0;
  const auto place = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  const std::uintptr_t now = (place * 0x9E3779B97F4A7C15u) >> 48;
  ++__afl_area_ptr[now ^ last];
  last = now >> 1;
}
// NOLINTEND(bugprone-reserved-identifier)

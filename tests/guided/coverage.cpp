#include <cstdint>
#include <cstdio>
#include <cstdlib>

// Coverage for AFL++ from GCC's own instrumentation, -fsanitize-coverage=trace-pc,trace-cmp:
// AFL++'s plugin for GCC only loads into the very build of the compiler that it was made with. The
// map and the functions are AFL++'s and GCC's interfaces (AFL++, docs/fuzzing_in_depth.md; GCC,
// Program Instrumentation Options). AFL++'s runtime has the functions for comparisons of integers
// itself.
//
// With KROK_PLACES=FILE in the environment, the addresses of all edges that ran are written to FILE
// when the program ends, one in a line; coverage.py makes lines of them.

// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
extern unsigned char* __afl_area_ptr;  // 65,536 counters unless more were asked for
extern const char __executable_start;
extern const char etext;
}

namespace {

unsigned char* places = nullptr;  // of each byte of code, whether it ran; null if no one asks
std::uintptr_t code_size = 0;

void write_places() {
  std::FILE* file = std::fopen(std::getenv("KROK_PLACES"), "w");
  if (file == nullptr) return;
  for (std::uintptr_t at = 0; at < code_size; ++at) {
    if (places[at] != 0) std::fprintf(file, "0x%lx\n", static_cast<unsigned long>(at));
  }
  std::fclose(file);
}

[[gnu::constructor]] void keep_places() {
  if (std::getenv("KROK_PLACES") == nullptr) return;
  code_size = static_cast<std::uintptr_t>(&etext - &__executable_start);
  places = static_cast<unsigned char*>(std::calloc(code_size, 1));
  std::atexit(write_places);
}

}  // namespace

// Called at each edge: counts the pair of this place and the last one.
extern "C" void __sanitizer_cov_trace_pc() {
  static thread_local std::uintptr_t last = 0;
  const auto place = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  const std::uintptr_t now = (place * 0x9E3779B97F4A7C15u) >> 48;
  ++__afl_area_ptr[now ^ last];
  last = now >> 1;
  if (places != nullptr) {
    const auto at = place - reinterpret_cast<std::uintptr_t>(&__executable_start);
    if (at < code_size) places[at] = 1;
  }
}

// Comparisons of floating-point numbers, which AFL++ does not follow.
extern "C" void __sanitizer_cov_trace_cmpf(float, float) {}
extern "C" void __sanitizer_cov_trace_cmpd(double, double) {}
// NOLINTEND(bugprone-reserved-identifier)

#include "core/simd.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include <algorithm>
#include <atomic>

namespace krok {

namespace {

#if defined(__x86_64__)
// Clang's __builtin_cpu_supports() does not know it.
bool has_f16c() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & bit_F16C) != 0;
}
#endif

Simd find_simd() {
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && has_f16c();
  if (!avx2) return Simd::other;
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
  return avx512 ? Simd::avx512 : Simd::avx2;
#else
  return Simd::other;
#endif
}

std::atomic<Simd> limit{Simd::avx512};

Simd found_simd() {
  static const Simd simd = find_simd();
  return simd;
}

}  // namespace

Simd machine_simd() {
  return std::min(found_simd(), limit.load(std::memory_order_relaxed));
}

Simd limit_simd(Simd most) {
  limit = most;
  return found_simd();
}

}  // namespace krok

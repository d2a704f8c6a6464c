#pragma once

// Which vector instructions the machine has, for kernels that are compiled for several (with
// Highway, a header away). Highway's own choice among them lives in a library that measures the
// clock whenever a program starts, which takes longer than many a tool's whole work.

namespace krok {

// avx512: F, CD, BW, DQ and VL, Highway's target AVX3. avx2: with FMA, F16C, BMI and BMI2, its
// AVX2.
enum class Simd { other, avx2, avx512 };
Simd machine_simd();

// From now on machine_simd() says at most `most`: for tests that hold the versions of a kernel
// against each other. Gives what the machine has.
Simd limit_simd(Simd most);

}  // namespace krok

// The address of the best of a function's versions for this machine; behind <hwy/highway.h>, in the
// part of a file that is compiled once, in the namespace around HWY_NAMESPACE.
#define KROK_STATIC_VERSION(function) (&HWY_STATIC_DISPATCH(function))
#define KROK_BEST_VERSION(function)                                           \
  (krok::machine_simd() == krok::Simd::avx512 ? KROK_AVX512_VERSION(function) \
   : krok::machine_simd() == krok::Simd::avx2 ? KROK_AVX2_VERSION(function)   \
                                              : KROK_STATIC_VERSION(function))
#if defined(HWY_TARGETS) && (HWY_TARGETS & HWY_AVX2)
#define KROK_AVX2_VERSION(function) (&N_AVX2::function)
#else
#define KROK_AVX2_VERSION(function) KROK_STATIC_VERSION(function)
#endif
#if defined(HWY_TARGETS) && (HWY_TARGETS & HWY_AVX3)
#define KROK_AVX512_VERSION(function) (&N_AVX3::function)
#else
#define KROK_AVX512_VERSION(function) KROK_AVX2_VERSION(function)
#endif

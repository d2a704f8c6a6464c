#pragma once

// Detects the vector instructions of the machine, for kernels compiled for several targets (with
// Highway, header only). Highway's own dispatch is in a library that measures the clock at program
// start, which takes longer than many tools run.

namespace krok {

// avx512: F, CD, BW, DQ and VL, Highway's target AVX3. avx2: with FMA, F16C, BMI and BMI2,
// Highway's target AVX2.
enum class Simd { other, avx2, avx512 };
Simd machine_simd();

// Limits machine_simd() to at most `most`, for tests that compare the versions of a kernel. Returns
// what the machine has.
Simd limit_simd(Simd most);

}  // namespace krok

// The address of the best version of a function for this machine. For use after <hwy/highway.h>, in
// the part of a file that is compiled once, in the namespace around HWY_NAMESPACE.
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

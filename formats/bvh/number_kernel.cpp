#include "formats/bvh/number_kernel.h"

// CPUs with narrower vectors use the scalar parser.
#include <hwy/detect_targets.h>
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/bvh/number_kernel.cpp"
#include <hwy/foreach_target.h>
// Order matters: foreach_target.h sets macros that highway.h uses.
#include <hwy/highway.h>

#include "core/simd.h"

HWY_BEFORE_NAMESPACE();
namespace krok::bvh::number_kernel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
using Halves = hn::ScalableTag<std::uint64_t>;
using Quarters = hn::ScalableTag<std::uint32_t>;
using Doubles = hn::ScalableTag<double>;
using ByteVector = hn::Vec<Bytes>;
using Sums = hn::Vec<Halves>;

// Each word is loaded into a 16-byte block; two vectors of blocks give one vector of doubles.
constexpr std::size_t kBlock = 16;
constexpr std::size_t kBlocks = hn::MaxLanes(Bytes()) / kBlock;
constexpr std::size_t kGroup = 2 * kBlocks;

// A constant repeated in each block.
struct alignas(64) Pattern {
  std::uint8_t bytes[64];
};
template <typename Value>
constexpr Pattern pattern(Value value) {
  Pattern result{};
  for (std::size_t i = 0; i < 64; ++i) {
    result.bytes[i] = static_cast<std::uint8_t>(value(i / kBlock, i % kBlock));
  }
  return result;
}
constexpr Pattern kPlace = pattern([](std::size_t, std::size_t i) { return i; });
constexpr Pattern kPlaceFromOne = pattern([](std::size_t, std::size_t i) { return i + 1; });
// '-' and '.', the latter after the subtraction that makes digits 0 to 9. The last byte, which must
// be a digit, has a value that does not occur in words.
constexpr Pattern kMinus = pattern([](std::size_t, std::size_t i) { return i < 15 ? '-' : ' '; });
constexpr Pattern kDot =
    pattern([](std::size_t, std::size_t i) { return (i < 15 ? '.' : ' ') ^ '0'; });
// Limit of digits, of which there can be fifteen.
constexpr Pattern kLimit = pattern([](std::size_t, std::size_t i) { return i == 0 ? 0 : 9; });
constexpr Pattern kTens = pattern([](std::size_t, std::size_t i) { return i % 2 == 0 ? 10 : 1; });
constexpr Pattern kHundreds = pattern([](std::size_t, std::size_t i) {
  return i % 4 == 0 ? 100 : i % 4 == 2 ? 1 : 0;
});
constexpr Pattern kTenThousands = pattern([](std::size_t, std::size_t i) {
  return i % 4 == 0 ? 10000 % 256 : i % 4 == 1 ? 10000 / 256 : i % 4 == 2 ? 1 : 0;
});
constexpr Pattern kFirstOfPair = pattern([](std::size_t block, std::size_t) { return 2 * block; });
constexpr Pattern kSecondOfPair =
    pattern([](std::size_t block, std::size_t) { return 2 * block + 1; });

// Indexed by the one-based position of the dot, 0 for none: 10 to the number of digits after it.
alignas(64) constexpr double kPowers[16] = {1e0, 1e15, 1e14, 1e13, 1e12, 1e11, 1e10, 1e9,
                                            1e8, 1e7,  1e6,  1e5,  1e4,  1e3,  1e2,  1e1};

HWY_INLINE ByteVector all(const Pattern& pattern) {
  return hn::Load(Bytes(), pattern.bytes);
}

// One bit for each of 64 characters: set if it is not white space.
HWY_INLINE std::uint64_t word_bits(const char* text) {
  const Bytes d;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 64; i += hn::MaxLanes(d)) {
    const auto c = hn::LoadU(d, reinterpret_cast<const std::uint8_t*>(text) + i);
    const auto control = hn::Sub(c, hn::Set(d, '\t'));  // '\t' to '\r' become 0 to 4
    const auto space =
        hn::Or(hn::Eq(c, hn::Set(d, ' ')), hn::Eq(hn::Min(control, hn::Set(d, 4)), control));
    std::uint64_t part = 0;
    hn::StoreMaskBits(d, space, reinterpret_cast<std::uint8_t*>(&part));
    bits |= part << i;
  }
  return ~bits;
}

// Offsets of word begins and ends, alternating, from `row` on. False if there are not `count`
// words.
HWY_INLINE bool find_edges(const char* row, std::size_t size, std::size_t count,
                           std::uint32_t* edges) {
  std::uint64_t inside = 0;  // whether the previous character is part of a word
  std::size_t found = 0;
  for (std::size_t at = 0; at < size; at += 64) {
    std::uint64_t bits = word_bits(row + at);
    if (size - at < 64) bits &= (std::uint64_t{1} << (size - at)) - 1;
    std::uint64_t changes = bits ^ (bits << 1 | inside);
    inside = bits >> 63;
    const auto changed = static_cast<std::size_t>(hwy::PopCount(changes));
    if (found + changed > 2 * count) return false;
    std::uint32_t* out = edges + found;
    found += changed;
    // Writes more entries than there are; later writes overwrite the excess.
    const auto put = [&](int n) {
      for (int i = 0; i < n; ++i) {
        *out++ = static_cast<std::uint32_t>(at + _tzcnt_u64(changes));
        changes &= changes - 1;
      }
    };
    put(16);
    while (changes != 0) put(8);
  }
  return found == 2 * count && inside == 0;
}

// The last 16 characters of every second word.
HWY_INLINE ByteVector load_words(const char* row, const std::uint32_t* edges) {
  const auto word = [&](std::size_t i) {
    return _mm_loadu_si128(
        reinterpret_cast<const __m128i*>(row + std::ptrdiff_t{edges[4 * i + 1]} - 16));
  };
#if HWY_TARGET == HWY_AVX2
  return ByteVector{_mm256_inserti128_si256(_mm256_castsi128_si256(word(0)), word(1), 1)};
#else
  __m512i all = _mm512_castsi128_si512(word(0));
  all = _mm512_inserti32x4(all, word(1), 1);
  all = _mm512_inserti32x4(all, word(2), 2);
  return ByteVector{_mm512_inserti32x4(all, word(3), 3)};
#endif
}

// Sums of products of adjacent lanes: 8 to 16 bits, 16 to 32; packing 32 to 16 bits of two vectors.
HWY_INLINE ByteVector join_bytes(ByteVector digits, ByteVector weights) {
#if HWY_TARGET == HWY_AVX2
  return ByteVector{_mm256_maddubs_epi16(digits.raw, weights.raw)};
#else
  return ByteVector{_mm512_maddubs_epi16(digits.raw, weights.raw)};
#endif
}
HWY_INLINE ByteVector join_pairs(ByteVector pairs, ByteVector weights) {
#if HWY_TARGET == HWY_AVX2
  return ByteVector{_mm256_madd_epi16(pairs.raw, weights.raw)};
#else
  return ByteVector{_mm512_madd_epi16(pairs.raw, weights.raw)};
#endif
}
HWY_INLINE ByteVector pack_blocks(ByteVector first, ByteVector second) {
#if HWY_TARGET == HWY_AVX2
  return ByteVector{_mm256_packus_epi32(first.raw, second.raw)};
#else
  return ByteVector{_mm512_packus_epi32(first.raw, second.raw)};
#endif
}

HWY_INLINE hn::Vec<Doubles> powers_at(Sums places) {
#if HWY_TARGET == HWY_AVX2
  return hn::GatherIndex(Doubles(), kPowers, hn::BitCast(hn::RebindToSigned<Doubles>(), places));
#else
  return hn::Vec<Doubles>{
      _mm512_permutex2var_pd(_mm512_load_pd(kPowers), places.raw, _mm512_load_pd(kPowers + 8))};
#endif
}

// One word per block: its digits as four numbers of four digits, and `facts`, in both halves of a
// block: one-based position of the dot, 0 for none, plus 128 for a minus. False if a word is not
// plain.
HWY_INLINE bool read_digits(ByteVector words, ByteVector unused, ByteVector& digits, Sums& facts) {
  const Bytes d;
  const ByteVector place = all(kPlace);
  const auto in_word = hn::Not(hn::Lt(place, unused));
  const auto minus = hn::And(hn::Eq(words, all(kMinus)), hn::Eq(place, unused));
  const ByteVector plain =
      hn::IfThenElseZero(hn::AndNot(minus, in_word), hn::Xor(words, hn::Set(d, std::uint8_t{'0'})));
  const ByteVector from_one = all(kPlaceFromOne);
  const auto dot = hn::Eq(plain, all(kDot));
  const ByteVector marks =
      hn::IfThenElse(minus, hn::Set(d, std::uint8_t{128}), hn::IfThenElseZero(dot, from_one));
  const Sums sums = hn::SumsOf8(marks);
  facts = hn::Add(sums, hn::Shuffle01(sums));
  const ByteVector dot_place = hn::And(hn::TableLookupBytes(hn::BitCast(d, facts), hn::Zero(d)),
                                       hn::Set(d, std::uint8_t{31}));
  // Shifts the digits before the dot by one, over the dot.
  const ByteVector number =
      hn::IfThenElse(hn::Gt(from_one, dot_place), plain, hn::ShiftLeftBytes<1>(plain));
  digits = join_pairs(join_bytes(number, all(kTens)), all(kHundreds));
  return hn::AllTrue(d, hn::Not(hn::Gt(number, all(kLimit))));
}

bool parse_plain_row(const char* row, const char* end, std::size_t count, double* values,
                     std::size_t stride, std::uint32_t* edges) {
  const Halves h;
  const Doubles d;
  const auto size = static_cast<std::size_t>(end - row);
  if (size > (std::size_t{1} << 30) || !find_edges(row, size, count, edges)) return false;
  for (std::size_t i = 0; i < kGroup; ++i) {
    edges[2 * (count + i)] = edges[2 * (count - 1)];
    edges[2 * (count + i) + 1] = edges[2 * (count - 1) + 1];
  }
  for (std::size_t first = 0; first < count; first += kGroup) {
    const std::uint32_t* at = edges + 2 * first;
    std::uint64_t unused = 0;  // one byte per word
    std::uint32_t too_long = 0;
    for (std::size_t i = 0; i < kGroup; ++i) {
      const std::uint32_t length = at[2 * i + 1] - at[2 * i];
      too_long |= (length - 1) >> 4;
      unused |= std::uint64_t{(16 - length) & 15} << (8 * i);
    }
    const ByteVector places = hn::BitCast(Bytes(), hn::Set(h, unused));
    ByteVector digits[2];
    Sums facts[2];
    const bool even = read_digits(
        load_words(row, at), hn::TableLookupBytes(places, all(kFirstOfPair)), digits[0], facts[0]);
    const bool odd =
        read_digits(load_words(row, at + 2), hn::TableLookupBytes(places, all(kSecondOfPair)),
                    digits[1], facts[1]);
    if (HWY_UNLIKELY(!even || !odd || too_long != 0)) return false;

    // Eight digits in each half of a word, then all; exact, since there are at most fifteen.
    const ByteVector eights = join_pairs(pack_blocks(digits[0], digits[1]), all(kTenThousands));
    const Sums integers =
        hn::Add(hn::MulEven(hn::BitCast(Quarters(), eights), hn::Set(Quarters(), 100000000u)),
                hn::ShiftRight<32>(hn::BitCast(h, eights)));
    constexpr double kExactFrom = 4503599627370496.0;  // 2^52
    const auto shifted = hn::BitCast(d, hn::Or(integers, hn::BitCast(h, hn::Set(d, kExactFrom))));
    const auto whole = hn::Sub(shifted, hn::Set(d, kExactFrom));
    const Sums both = hn::OddEven(facts[1], facts[0]);
    const auto sign = hn::And(hn::ShiftLeft<56>(both), hn::Set(h, std::uint64_t{1} << 63));
    const auto size_of_number =
        hn::Div(whole, powers_at(hn::And(both, hn::Set(h, std::uint64_t{15}))));
    HWY_ALIGN double results[kGroup];
    hn::Store(hn::Xor(size_of_number, hn::BitCast(d, sign)), d, results);
    const std::size_t used = count - first < kGroup ? count - first : kGroup;
    double* out = values + first * stride;
    for (std::size_t i = 0; i < used; ++i) out[i * stride] = results[i];
  }
  return true;
}

#else

bool parse_plain_row(const char*, const char*, std::size_t, double*, std::size_t, std::uint32_t*) {
  return false;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace krok::bvh::number_kernel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace krok::bvh::number_kernel {

bool parse_plain_row(const char* row, const char* end, std::size_t count, double* values,
                     std::size_t stride, std::uint32_t* edges) {
  const auto best = KROK_BEST_VERSION(parse_plain_row);
  return count > 0 && best(row, end, count, values, stride, edges);
}

}  // namespace krok::bvh::number_kernel

#endif  // HWY_ONCE

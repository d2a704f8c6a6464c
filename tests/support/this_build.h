#pragma once

// Whether the program is built with a sanitizer that uses memory or threads itself.

namespace krok::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace krok::test

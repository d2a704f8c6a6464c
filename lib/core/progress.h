#pragma once

#include <cstdint>
#include <string_view>

// How the library tells a program how far it is. The library never prints: a program passes a
// Progress that does.

namespace krok {

// Calls may come from any thread. The default does nothing.
class Progress {
 public:
  virtual ~Progress() = default;
  // A new piece of work of `total` steps (0: unknown), named for people: "reading frames".
  virtual void begin(std::string_view /*what*/, std::uint64_t /*total*/) {}
  virtual void advance(std::uint64_t /*steps*/) {}
  virtual void end() {}
};

}  // namespace krok

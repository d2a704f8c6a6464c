#pragma once

#include <cstdint>
#include <string_view>

// Progress reporting. The library never prints: a program passes a Progress that does.

namespace krok {

// Calls may come from any thread. The default does nothing.
class Progress {
 public:
  virtual ~Progress() = default;
  // Starts a task of `total` steps (0: unknown); `what` is for display: "reading frames".
  virtual void begin(std::string_view /*what*/, std::uint64_t /*total*/) {}
  virtual void advance(std::uint64_t /*steps*/) {}
  virtual void end() {}
};

}  // namespace krok

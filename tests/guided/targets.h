#pragma once

#include <cstddef>
#include <span>
#include <string_view>

// What `make fuzz` feeds with bytes: a reader, or a chain of operations. A target returns when its
// input was read or refused as documented, and aborts with a message on standard error otherwise:
// a value that does not pass its check, an Error without code or message or with control
// characters, an operation whose result is not finite, memory out of proportion.

namespace krok::guided {

struct Target {
  std::string_view name;
  void (*run)(std::span<const std::byte> input);
  bool writes = false;  // what it writes may take memory, too
};

std::span<const Target> targets();

// Prints `what` on standard error and aborts, which a fuzzer counts as a finding.
[[noreturn]] void fail(std::string_view what);

// krok-edit and then another tool on a motion with extreme values, all of it made from the input.
void run_operations(std::span<const std::byte> input);

// krok-import of a glTF scene, with everything that it can write.
void import_scene(std::span<const std::byte> input);

}  // namespace krok::guided

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

// XXH3 checksums (xxHash 0.8), 64 bits, seed 0.

namespace krok {

std::uint64_t xxh3(std::span<const std::byte> data);

// Sixteen lower-case hexadecimal digits.
std::string hex(std::uint64_t value);

// Streaming version of xxh3().
class Xxh3Stream {
 public:
  Xxh3Stream();
  ~Xxh3Stream();
  Xxh3Stream(const Xxh3Stream&) = delete;
  Xxh3Stream& operator=(const Xxh3Stream&) = delete;

  void update(std::span<const std::byte> data);
  std::uint64_t digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace krok

#include "core/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

// Replaces the functions of the same names by versions with runtime CPU dispatch.
#ifdef KROK_XXHASH_DISPATCHES
#include <xxh_x86dispatch.h>
#endif

#include <new>

namespace krok {

struct Xxh3Stream::State {
  XXH3_state_t* xxh3 = XXH3_createState();
  ~State() { XXH3_freeState(xxh3); }
};

Xxh3Stream::Xxh3Stream() : state_(std::make_unique<State>()) {
  if (state_->xxh3 == nullptr) throw std::bad_alloc();
  XXH3_64bits_reset(state_->xxh3);
}

Xxh3Stream::~Xxh3Stream() = default;

void Xxh3Stream::update(std::span<const std::byte> data) {
  XXH3_64bits_update(state_->xxh3, data.data(), data.size());
}

std::uint64_t Xxh3Stream::digest() const {
  return XXH3_64bits_digest(state_->xxh3);
}

std::uint64_t xxh3(std::span<const std::byte> data) {
  return XXH3_64bits(data.data(), data.size());
}

std::string hex(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

}  // namespace krok

#pragma once

#include <ImfIO.h>

#include <cstddef>
#include <cstring>
#include <span>

namespace krok::morph_exr {

// A file in memory, for OpenEXR.
class BytesIn final : public Imf::IStream {
 public:
  explicit BytesIn(std::span<const std::byte> bytes) : IStream("texture"), bytes_(bytes) {}

  bool read(char out[], int count) override {
    if (count < 0 || static_cast<std::size_t>(count) > bytes_.size() - position_) {
      throw Iex::InputExc("the file ends too early");
    }
    std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw Iex::InputExc("the file ends too early");
    position_ = static_cast<std::size_t>(position);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace krok::morph_exr

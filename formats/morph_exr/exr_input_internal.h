#pragma once

#include <IexBaseExc.h>
#include <ImfIO.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/result.h"

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

// Private to the readers of OpenEXR files: checks an OpenEXR header before the library reads it,
// which allocates memory by the sizes in the header.

struct HeaderFacts {
  std::uint32_t width = 0, height = 0;
};

// Checks that the file is a single-part scan-line image with lossless compression (NO, RLE, ZIPS or
// ZIP), that its attributes are within the file, and that the image size is possible for the file
// size, at `bytes_per_texel` at least. Code: exr-header, with the byte offset.
Result<HeaderFacts> scan_header(std::span<const std::byte> file, int bytes_per_texel = 12);

}  // namespace krok::morph_exr

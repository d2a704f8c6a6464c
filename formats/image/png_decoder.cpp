#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "formats/image/decoders_internal.h"

namespace krok::image {

namespace {

class PngDecoder {
 public:
  explicit PngDecoder(std::span<const std::byte> file) : left_(file) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &fail, &ignore);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }

  const char* message() const { return message_; }

  // False if libpng fails or reads another size.
  bool decode(Pixels& pixels) {
    if (info_ == nullptr) return false;
    std::uint8_t* const first = pixels.rgba.data();
    const auto width = static_cast<png_uint_32>(pixels.width);
    const auto height = static_cast<png_uint_32>(pixels.height);
    return decode(first, width, height);
  }

  // The same; also false for an image in colour, and then `colour`.
  bool decode_grey(GreyAndAlpha& pixels, bool& colour) {
    if (info_ == nullptr) return false;
    auto* const first = reinterpret_cast<std::uint8_t*>(pixels.values.data());
    const auto width = static_cast<png_uint_32>(pixels.width);
    const auto height = static_cast<png_uint_32>(pixels.height);
    if (!decode_grey(first, width, height)) return false;
    colour = colour_;
    pixels.has_alpha = has_alpha_;
    return !colour_;
  }

 private:
  bool decode(std::uint8_t* first, png_uint_32 width, png_uint_32 height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, &read);
    png_read_info(png_, info_);
    png_set_expand(png_);  // palettes, few bits, one transparent colour
    png_set_scale_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 0xFF, PNG_FILLER_AFTER);
    read_rows(first, width, height);
    return true;
  }

  bool decode_grey(std::uint8_t* first, png_uint_32 width, png_uint_32 height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, &read);
    png_read_info(png_, info_);
    const int kind = png_get_color_type(png_, info_);
    colour_ = (kind & PNG_COLOR_MASK_COLOR) != 0;
    if (colour_) return true;
    has_alpha_ =
        (kind & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
    png_set_expand(png_);
    png_set_expand_16(png_);
    png_set_add_alpha(png_, 0xFFFF, PNG_FILLER_AFTER);
    png_set_swap(png_);
    read_rows(first, width, height);
    return true;
  }

  // Four bytes a pixel, by the transformations set. Errors leave by png_error().
  void read_rows(std::uint8_t* first, png_uint_32 width, png_uint_32 height) {
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    const std::size_t row = std::size_t{width} * 4;
    if (png_get_image_width(png_, info_) != width || png_get_image_height(png_, info_) != height ||
        png_get_rowbytes(png_, info_) != row) {
      png_error(png_, "the header changed");
    }
    for (int pass = 0; pass < passes; ++pass) {
      for (png_uint_32 y = 0; y < height; ++y) png_read_row(png_, first + y * row, nullptr);
    }
    png_read_end(png_, nullptr);
  }

  static void read(png_structp png, png_bytep to, std::size_t size) {
    auto& self = *static_cast<PngDecoder*>(png_get_io_ptr(png));
    if (size > self.left_.size()) png_error(png, "unexpected end of file");
    std::memcpy(to, self.left_.data(), size);
    self.left_ = self.left_.subspan(size);
  }

  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngDecoder*>(png_get_error_ptr(png));
    std::strncpy(self.message_, message, sizeof(self.message_) - 1);
    png_longjmp(png, 1);
  }

  static void ignore(png_structp, png_const_charp) {}  // warnings

  std::span<const std::byte> left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  bool colour_ = false, has_alpha_ = false;
  char message_[160] = "out of memory";
};

}  // namespace

Status decode_png(std::span<const std::byte> file, Pixels& pixels) {
  PngDecoder decoder(file);
  if (decoder.decode(pixels)) return {};
  return Error("picture-damaged", fmt::format("cannot decode the PNG image: {}", decoder.message()),
               "save it again");
}

Status decode_grey_png(std::span<const std::byte> file, GreyAndAlpha& pixels) {
  PngDecoder decoder(file);
  bool colour = false;
  if (decoder.decode_grey(pixels, colour)) return {};
  if (colour) return Error("picture-kind", "the PNG image is in colour", "save it as 16-bit grey");
  return Error("picture-damaged", fmt::format("cannot decode the PNG image: {}", decoder.message()),
               "save it again");
}

}  // namespace krok::image

#include "formats/image/decode_image.h"

#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>  // wants FILE declared

#include "scene/encoded_image.h"

// Both libraries report errors with longjmp, so functions that it may skip must not have objects
// with destructors.

namespace krok::image {

namespace {

// What the header says, of an image that is not too large.
Result<ImageInfo> checked_info(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = image_info(file);
  if (!facts) return facts.error();
  const auto width = static_cast<std::size_t>(facts->width);
  const auto height = static_cast<std::size_t>(facts->height);
  if (facts->kind != ImageKind::png && facts->kind != ImageKind::jpeg) {
    return Error("picture-kind", fmt::format("the image is {}", name_of(facts->kind)),
                 "save it as PNG or JPEG, which can be shown and compared here");
  }
  if (width * height <= most_pixels) return *facts;
  return Error("picture-size",
               fmt::format("the image has {} x {} pixels, the limit is {} in total", width, height,
                           most_pixels),
               "reduce its size");
}

struct GreyAndAlpha {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;  // [height x width x 2]; alpha is 65535 without such a channel
  bool has_alpha = false;
};

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

// Fills in the pixels, whose size is already set from the file. Code: picture-damaged.
Status decode_png(std::span<const std::byte> file, Pixels& pixels) {
  PngDecoder decoder(file);
  if (decoder.decode(pixels)) return {};
  return Error("picture-damaged", fmt::format("cannot decode the PNG image: {}", decoder.message()),
               "save it again");
}

// As decode_png. Codes: picture-damaged, picture-kind.
Status decode_grey_png(std::span<const std::byte> file, GreyAndAlpha& pixels) {
  PngDecoder decoder(file);
  bool colour = false;
  if (decoder.decode_grey(pixels, colour)) return {};
  if (colour) return Error("picture-kind", "the PNG image is in colour", "save it as 16-bit grey");
  return Error("picture-damaged", fmt::format("cannot decode the PNG image: {}", decoder.message()),
               "save it again");
}

// A progressive JPEG has about ten; each scan costs a pass over the image, however few its bytes.
constexpr int kMaxScans = 100;

// libjpeg's structure is the first member, so that its callbacks can cast back.
struct Errors {
  jpeg_error_mgr manager;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX];  // the first one
};

void note(j_common_ptr jpeg) {
  auto* const errors = reinterpret_cast<Errors*>(jpeg->err);
  if (errors->message[0] == '\0') jpeg->err->format_message(jpeg, errors->message);
}

[[noreturn]] void fail(j_common_ptr jpeg) {
  auto* const errors = reinterpret_cast<Errors*>(jpeg->err);
  jpeg->err->format_message(jpeg, errors->message);
  std::longjmp(errors->back, 1);
}

void tell(j_common_ptr jpeg, int level) {
  if (level < 0) note(jpeg);  // other levels are traces
}

void limit_scans(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMaxScans) return;
  auto* const errors = reinterpret_cast<Errors*>(jpeg->err);
  std::snprintf(errors->message, sizeof(errors->message), "more than %d scans", kMaxScans);
  std::longjmp(errors->back, 1);
}

class JpegDecoder {
 public:
  JpegDecoder() {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = &fail;
    errors_.manager.emit_message = &tell;
    watch_.progress_monitor = &limit_scans;
  }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg_); }

  enum class Outcome : unsigned char { decoded, damaged, inks };

  Outcome decode(const unsigned char* file, std::size_t size, std::uint8_t* first, unsigned width,
                 unsigned height) {
    if (setjmp(errors_.back) != 0) return Outcome::damaged;
    jpeg_create_decompress(&jpeg_);
    jpeg_.progress = &watch_;
    jpeg_mem_src(&jpeg_, file, static_cast<unsigned long>(size));
    jpeg_read_header(&jpeg_, TRUE);
    if (jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK) {
      return Outcome::inks;
    }
    if (jpeg_.image_width != width || jpeg_.image_height != height) return Outcome::damaged;
    jpeg_.out_color_space = JCS_EXT_RGBA;
    jpeg_.dct_method = JDCT_ISLOW;  // bit-identical with and without SIMD
    jpeg_start_decompress(&jpeg_);
    const std::size_t row = std::size_t{width} * 4;
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW place = first + jpeg_.output_scanline * row;
      jpeg_read_scanlines(&jpeg_, &place, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return Outcome::decoded;
  }

  const char* message() const { return errors_.message; }

 private:
  Errors errors_{};
  jpeg_progress_mgr watch_{};
  jpeg_decompress_struct jpeg_{};
};

// As decode_png. Codes: picture-damaged, picture-kind.
Status decode_jpeg(std::span<const std::byte> file, Pixels& pixels) {
  JpegDecoder decoder;
  const auto outcome = decoder.decode(
      reinterpret_cast<const unsigned char*>(file.data()), file.size(), pixels.rgba.data(),
      static_cast<unsigned>(pixels.width), static_cast<unsigned>(pixels.height));
  if (outcome == JpegDecoder::Outcome::inks) {
    return Error("picture-kind", "the JPEG image is CMYK", "save it as RGB");
  }
  pixels.damage = decoder.message();
  if (outcome == JpegDecoder::Outcome::decoded) return {};
  return Error("picture-damaged", fmt::format("cannot decode the JPEG image: {}", pixels.damage),
               "save it again");
}

}  // namespace

Result<Pixels> decode(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = checked_info(file, most_pixels);
  if (!facts) return facts.error();
  Pixels pixels;
  pixels.width = facts->width;
  pixels.height = facts->height;
  pixels.rgba.resize(static_cast<std::size_t>(facts->width) *
                     static_cast<std::size_t>(facts->height) * 4);
  const auto decoder = facts->kind == ImageKind::png ? decode_png : decode_jpeg;
  if (Status status = decoder(file, pixels); !status) return status.error();
  return pixels;
}

Result<GreyPixels> decode_grey(std::span<const std::byte> file, std::size_t most_pixels) {
  const auto facts = checked_info(file, most_pixels);
  if (!facts) return facts.error();
  if (facts->kind != ImageKind::png) {
    return Error("picture-kind", "a JPEG has 8 bits of lossy grey", "use a 16-bit PNG");
  }
  GreyAndAlpha both{facts->width, facts->height, {}};
  const std::size_t count =
      static_cast<std::size_t>(facts->width) * static_cast<std::size_t>(facts->height);
  both.values.resize(2 * count);
  if (Status status = decode_grey_png(file, both); !status) return status.error();
  GreyPixels pixels{facts->width, facts->height, std::vector<std::uint16_t>(count), {}};
  pixels.opacity.resize(both.has_alpha ? count : 0);
  for (std::size_t i = 0; i < count; ++i) {
    pixels.values[i] = both.values[2 * i];
    if (both.has_alpha) pixels.opacity[i] = both.values[2 * i + 1];
  }
  return pixels;
}

}  // namespace krok::image

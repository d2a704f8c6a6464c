#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>  // wants FILE declared

#include "formats/image/decoders_internal.h"

namespace krok::image {

namespace {

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

}  // namespace

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

}  // namespace krok::image

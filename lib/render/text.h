#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"
#include "render/image.h"

// Text on an image, in DejaVu Sans, which is embedded in the library, so that output does not
// depend on installed fonts. Text is UTF-8 (invalid bytes are read as Latin-1); characters that the
// font lacks, including control characters, are shown as a box. Characters are laid out left to
// right, without shaping: scripts that need joining or reordering are not supported. Uses FreeType.

namespace krok::render {

enum class Align : unsigned char { left, centre, right };

class TextPainter {
 public:
  // Code text-font if FreeType fails (out of memory).
  static Result<TextPainter> create();
  TextPainter(TextPainter&&) noexcept;
  TextPainter& operator=(TextPainter&&) noexcept;
  ~TextPainter();

  // `size` is the em size in pixels, 4 to 400. Not thread-safe.
  double width(std::string_view text, double size);
  // `place` is on the baseline, at the text's left end, middle or right end.
  void draw(Image& image, const Vec2& place, std::string_view text, double size, Colour colour,
            Align align = Align::left);
  // `text` if it is at most `most` pixels wide, otherwise its beginning with an ellipsis; empty if
  // not even that fits.
  std::string fitted(std::string_view text, double size, double most);

 private:
  struct Face;
  explicit TextPainter(std::unique_ptr<Face> face);
  std::unique_ptr<Face> face_;
};

}  // namespace krok::render

#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"
#include "render/image.h"

// Words on a picture, in DejaVu Sans, which comes with the library: the same on every machine,
// whatever fonts it has. Texts are UTF-8 (other bytes count as Latin-1); characters that the
// typeface lacks, control characters among them, are shown as a box. Letters stand one after the
// other from left to right: scripts that join or turn their letters are not laid out. By FreeType.

namespace krok::render {

enum class Align : unsigned char { left, centre, right };

class TextPainter {
 public:
  // Code text-font where FreeType cannot (no memory).
  static Result<TextPainter> create();
  TextPainter(TextPainter&&) noexcept;
  TextPainter& operator=(TextPainter&&) noexcept;
  ~TextPainter();

  // `size` is that of the letter m's box in pixels, 4 to 400. Not to be called by two threads at
  // once.
  double width(std::string_view text, double size);
  // `place` is on the line that letters stand on, at the text's left end, middle or right end.
  void draw(Image& image, const Vec2& place, std::string_view text, double size, Colour colour,
            Align align = Align::left);
  // `text` if it is at most `most` pixels wide, otherwise as much of its beginning as fits before
  // an ellipsis; empty where not even that fits.
  std::string fitted(std::string_view text, double size, double most);

 private:
  struct Face;
  explicit TextPainter(std::unique_ptr<Face> face);
  std::unique_ptr<Face> face_;
};

}  // namespace krok::render

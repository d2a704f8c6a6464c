#include "render/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <span>

#include "core/text.h"

// The label font, DejaVu Sans, as a TrueType file. Included by the assembler: a C++ array of the
// bytes would be many times as large.
asm(".section .rodata\n"
    ".balign 16\n"
    "krok_label_font_begin:\n"
    ".incbin \"" KROK_LABEL_FONT
    "\"\n"
    "krok_label_font_end:\n"
    ".byte 0\n"
    ".previous\n"
    ".global krok_label_font_begin\n"
    ".global krok_label_font_end\n");

extern "C" const std::byte krok_label_font_begin[];
extern "C" const std::byte krok_label_font_end[];

namespace krok::render {

namespace {

constexpr char32_t kEllipsis = 0x2026;
constexpr double kMaxTextCoordinate = 1e6;  // pixels
constexpr double kFixed = 64.0;             // FreeType uses 26.6 fixed point

}  // namespace

struct TextPainter::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  Face() = default;
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;
  ~Face() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }

  void set_size(double size) const {
    const double kept = std::clamp(size, 4.0, 400.0);
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(kept * kFixed)), 72, 72);
  }

  // Without hinting, glyphs keep their shapes and widths at every size.
  bool load(char32_t character, bool drawn) const {
    const FT_Int32 how = FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP | (drawn ? FT_LOAD_RENDER : 0);
    return FT_Load_Char(face, character, how) == 0;
  }

  double width(const std::u32string& text) const {
    double sum = 0;
    for (const char32_t character : text) {
      if (load(character, false)) sum += static_cast<double>(face->glyph->linearHoriAdvance);
    }
    return sum / 65536.0;
  }
};

TextPainter::TextPainter(std::unique_ptr<Face> face) : face_(std::move(face)) {}
TextPainter::TextPainter(TextPainter&&) noexcept = default;
TextPainter& TextPainter::operator=(TextPainter&&) noexcept = default;
TextPainter::~TextPainter() = default;

Result<TextPainter> TextPainter::create() {
  auto face = std::make_unique<Face>();
  const std::span file(krok_label_font_begin, krok_label_font_end);
  const auto* bytes = reinterpret_cast<const FT_Byte*>(file.data());
  if (FT_Init_FreeType(&face->library) != 0 ||
      FT_New_Memory_Face(face->library, bytes, static_cast<FT_Long>(file.size()), 0, &face->face) !=
          0) {
    return Error("text-font", "cannot load the label font");
  }
  return TextPainter(std::move(face));
}

double TextPainter::width(std::string_view text, double size) {
  face_->set_size(size);
  return face_->width(code_points(to_utf8(text)));
}

void TextPainter::draw(Image& image, const Vec2& place, std::string_view text, double size,
                       Colour colour, Align align) {
  if (!(place.cwiseAbs().maxCoeff() < kMaxTextCoordinate)) return;
  face_->set_size(size);
  const auto letters = code_points(to_utf8(text));
  double x = place.x();
  if (align != Align::left) x -= face_->width(letters) * (align == Align::centre ? 0.5 : 1.0);
  const double line = std::round(place.y());
  for (const char32_t character : letters) {
    // Glyphs start at quarter pixels, for even spacing.
    const double start = std::floor(x * 4 + 0.5) / 4;
    FT_Vector shift{static_cast<FT_Pos>(std::lround((start - std::floor(start)) * kFixed)), 0};
    FT_Set_Transform(face_->face, nullptr, &shift);
    const bool loaded = face_->load(character, true);
    FT_Set_Transform(face_->face, nullptr, nullptr);
    if (!loaded) continue;
    const FT_GlyphSlot glyph = face_->face->glyph;
    const FT_Bitmap& bitmap = glyph->bitmap;
    const int left = static_cast<int>(std::floor(start)) + glyph->bitmap_left;
    const int top = static_cast<int>(line) - glyph->bitmap_top;
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row) {
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const unsigned char cover = bitmap.buffer[row * bitmap.pitch + column];
        image.blend(left + column, top + row, colour, cover / 255.0);
      }
    }
    x += static_cast<double>(glyph->linearHoriAdvance) / 65536.0;
  }
}

std::string TextPainter::fitted(std::string_view text, double size, double most) {
  const std::string whole = to_utf8(text);
  face_->set_size(size);
  auto letters = code_points(whole);
  if (face_->width(letters) <= most) return whole;
  while (!letters.empty()) {
    letters.back() = kEllipsis;
    if (face_->width(letters) <= most) break;
    letters.pop_back();
  }
  if (letters.empty()) return {};
  std::string result;
  for (const char32_t letter : letters) append_utf8(letter, result);
  return result;
}

}  // namespace krok::render

#include "render/font_internal.h"

// Included by the assembler: a C++ array of the bytes would be many times as large.
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

std::span<const std::byte> font_file() {
  return {krok_label_font_begin, krok_label_font_end};
}

}  // namespace krok::render

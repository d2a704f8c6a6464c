// If these fail, a damaged height image crashes a program. Run with the address and
// undefined-behaviour sanitizers.
#include <gtest/gtest.h>

#include <random>

#include "formats/height_field/height_image.h"
#include "support/height_images.h"

namespace krok::height_field {
namespace {

void read_and_check(const std::string& text) {
  const auto image = read(std::as_bytes(std::span(text)));
  if (!image) {
    EXPECT_FALSE(image.error().message.empty());
    return;
  }
  ASSERT_EQ(image->values.size(),
            static_cast<std::size_t>(image->columns) * static_cast<std::size_t>(image->rows));
}

TEST(DamagedHeights, AnyByteAnywhereIsHandled) {
  std::mt19937 random(11);
  for (const std::string& good :
       {test::exr_image(3, 2, {{"A", {1, 2, 3, 4, 5, 6}}, {"Y", {1, 2, 3, 4, 5, 6}}}),
        test::png_image(3, 2, 4, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12})}) {
    for (std::size_t at = 0; at < good.size(); ++at) {
      for (int i = 0; i < 12; ++i) {
        std::string text = good;
        text[at] = static_cast<char>(random());
        if (i % 3 == 0) text[random() % text.size()] = static_cast<char>(random());
        read_and_check(text);
      }
      read_and_check(good.substr(0, at));
    }
  }
}

}  // namespace
}  // namespace krok::height_field

// If these fail, a height image is read mirrored, scaled or shifted, a hole carries a foot, or a
// damaged image takes the program down.
#include "formats/height_field/height_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/height_images.h"
#include "support/told_mistakes.h"

namespace krok::height_field {
namespace {

std::span<const std::byte> bytes(const std::string& text) {
  return std::as_bytes(std::span(text));
}

const float kHole = std::numeric_limits<float>::quiet_NaN();

// Would fail if rows or columns were exchanged, or another channel than the heights was read.
TEST(HeightImage, ReadsTheRightChannelOfAnExr) {
  const std::vector<float> heights = {1, 2, 3, 4, 5, kHole}, others = {9, 9, 9, 9, 9, 9};
  const auto named =
      read(bytes(test::exr_image(3, 2, {{"A", others}, {"R", others}, {"Y", heights}})));
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_EQ(named->columns, 3);
  EXPECT_EQ(named->rows, 2);
  EXPECT_FALSE(named->shares);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(named->values[i], heights[i]);
  EXPECT_TRUE(std::isnan(named->values[5]));
  const auto first = read(bytes(test::exr_image(3, 2, {{"elevation", heights}, {"x", others}})));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->values[4], 5);
}

// Would fail if a PNG lost its lower 8 bits, its rows were exchanged, or a transparent pixel
// carried.
TEST(HeightImage, ReadsAll16BitsOfAPng) {
  const auto grey = read(bytes(test::png_image(2, 3, 0, {0, 1, 256, 257, 65534, 65535})));
  ASSERT_TRUE(grey) << grey.error().message;
  EXPECT_TRUE(grey->shares);
  const std::vector<double> expected = {0, 1, 256, 257, 65534, 65535};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(grey->values[i], expected[i] / 65535);
  const auto alpha = read(bytes(test::png_image(2, 2, 4, {7, 65535, 8, 0, 9, 32768, 10, 32767})));
  ASSERT_TRUE(alpha);
  EXPECT_FLOAT_EQ(alpha->values[0], 7.0f / 65535);
  EXPECT_TRUE(std::isnan(alpha->values[1]));
  EXPECT_FLOAT_EQ(alpha->values[2], 9.0f / 65535);
  EXPECT_TRUE(std::isnan(alpha->values[3]));
}

// Would fail if something that has no heights were read, or a header led to memory for what the
// file does not have: 30000 x 30000 samples are 3.6 GB.
TEST(HeightImage, RefusesWhatIsNone) {
  const auto code = [](const std::string& file) {
    const auto image = read(bytes(file));
    return image ? "none" : image.error().code;
  };
  EXPECT_EQ(code(""), "height-kind");
  EXPECT_EQ(code("Hello"), "height-kind");
  EXPECT_EQ(code(test::png_image(1, 1, 2, {1, 2, 3})), "picture-kind");
  EXPECT_EQ(code(std::string("\xFF\xD8\xFF\xE0")), "picture-damaged");
  EXPECT_EQ(code(test::png_image(2, 2, 0, {1, 2, 3, 4}, 30000, 30000)), "picture-size");
  EXPECT_EQ(code(test::png_image(2, 2, 0, {1, 2, 3, 4}, 2, 3)), "picture-damaged");
  EXPECT_EQ(code(test::exr_image(2, 1, {{"Y", {1, 2}}}, 30000, 30000)), "exr-header");
  EXPECT_EQ(code(test::exr_image(2, 1, {{"Y", {1, 2}}}, 1 << 30, 1)), "exr-header");
  EXPECT_EQ(code(test::exr_image(2, 1, {})), "exr-data");
  const std::string good = test::exr_image(2, 2, {{"Y", {1, 2, 3, 4}}});
  for (std::size_t size = 4; size < good.size(); ++size) {
    EXPECT_NE(code(good.substr(0, size)), "none") << size;
  }
}

// Would fail if an image were set elsewhere or at another height than its placement says.
TEST(HeightImage, IsPlaced) {
  HeightImage image{2, 2, {0, 0.5f, 1, kHole}, true};
  EXPECT_EQ(placed(image, {}).error().code, "height-placement");
  Placement placement;
  placement.size = {4, 6};
  EXPECT_EQ(placed(image, placement).error().code, "height-placement");
  placement.range = {1, 3};
  placement.centre = {10, 20};
  const auto field = placed(image, placement);
  ASSERT_TRUE(field);
  EXPECT_EQ(field->width, 4);
  EXPECT_EQ(field->depth, 6);
  EXPECT_EQ(field->centre_x, 10);
  EXPECT_EQ(field->centre_z, 20);
  EXPECT_EQ(field->heights[1], 2);
  EXPECT_EQ(field->heights[2], 3);
  EXPECT_TRUE(std::isnan(field->heights[3]));
  placement.range.reset();
  image.shares = false;
  EXPECT_EQ(placed(image, placement)->heights[1], 0.5f);
}

const std::string kSidecar = R"({
  "schema": "krok.ground/1",
  "size": ["20m", 3],
  "range": [0, "150cm"],
  "centre": [0, 10]
})";

// Would fail if units were ignored, or a mistake in a sidecar were not found where it is.
TEST(GroundSidecar, SaysWhereItIsWrong) {
  const auto read = read_sidecar(kSidecar);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ((*read->size)[0], 20);
  EXPECT_EQ((*read->size)[1], 3);
  EXPECT_EQ((*read->range)[1], 1.5);
  EXPECT_EQ((*read->centre)[1], 10);
  const test::Mistake mistakes[] = {
      {"\"size\"", "\"sise\"", "ground-structure 3:3", "size"},
      {"ground/1", "ground/2", "ground-structure 2:13"},
      {"3]", "3, 4]", "ground-value 3:11", "3 values"},
      {"\"20m\"", "\"20kg\"", "ground-value 3:12", "20cm"},
      {"\"150cm\"", "null", "ground-value 4:16"},
      {"[0, 10]", "[0, 1e9]", "ground-value 5:17"},
      {"[0, 10]", "7", "ground-value 5:13"},
      {"[0, 10]", "[0, 10", "json-syntax 6:1"},
  };
  test::expect_told(kSidecar, mistakes, [](const std::string& text) { return read_sidecar(text); });
}

}  // namespace
}  // namespace krok::height_field

// If these fail, binary files are misread, or a cut file is read past its end.
#include "core/bytes.h"

#include <gtest/gtest.h>

#include <array>

namespace krok {
namespace {

TEST(ByteWriter, WritesLittleEndian) {
  ByteWriter writer;
  writer.write(std::uint32_t{0x04030201});
  writer.write(std::uint8_t{5});
  writer.append_text("ab");
  ASSERT_EQ(writer.size(), 7u);
  const std::array expected = {1, 2, 3, 4, 5, 'a' + 0, 'b' + 0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(static_cast<int>(writer.bytes()[i]), expected[i]);
  }
}

TEST(ByteWriter, AlignsWithZeros) {
  ByteWriter writer;
  writer.align(64);
  EXPECT_EQ(writer.size(), 0u);
  writer.append_text("x");
  writer.align(64);
  EXPECT_EQ(writer.size(), 64u);
  EXPECT_EQ(writer.bytes()[63], std::byte{0});
  writer.align(64);
  EXPECT_EQ(writer.size(), 64u);
}

TEST(ByteReader, ReadsBackWhatWasWritten) {
  ByteWriter writer;
  writer.write(1.5);
  writer.write(std::int16_t{-3});
  writer.append_text("name");
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.read<double>(), 1.5);
  EXPECT_EQ(reader.read<std::int16_t>(), -3);
  EXPECT_EQ(reader.take_text(4), "name");
  EXPECT_EQ(reader.remaining(), 0u);
  EXPECT_TRUE(reader.ok());
}

TEST(ByteReader, StaysFailedAfterAReadPastTheEnd) {
  const std::array<std::byte, 3> data = {std::byte{1}, std::byte{2}, std::byte{3}};
  ByteReader reader(data);
  EXPECT_EQ(reader.read<std::uint32_t>(), 0u);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.remaining(), 0u);
  EXPECT_TRUE(reader.take(1).empty());
  reader.seek(0);
  EXPECT_FALSE(reader.ok());
}

TEST(ByteReader, TakesNoCountThatOverflows) {
  const std::array<std::byte, 3> data = {};
  ByteReader reader(data);
  reader.take(1);
  EXPECT_TRUE(reader.take(static_cast<std::size_t>(-1)).empty());
  EXPECT_FALSE(reader.ok());
}

TEST(ByteReader, SeeksWithinItsDataOnly) {
  const std::array<std::byte, 3> data = {std::byte{7}, std::byte{8}, std::byte{9}};
  ByteReader reader(data);
  reader.seek(2);
  EXPECT_EQ(reader.read<std::uint8_t>(), 9);
  reader.seek(3);
  EXPECT_TRUE(reader.ok());
  reader.seek(4);
  EXPECT_FALSE(reader.ok());
}

}  // namespace
}  // namespace krok

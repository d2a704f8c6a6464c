// If these fail, bytes of a file come in a wrong order, are lost or are there twice.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/file.h"
#include "support/folder_test.h"

namespace krok {
namespace {

using AppendedBytesTest = test::FolderTest;

TEST_F(AppendedBytesTest, WritesLargeAndSmallPiecesInOrder) {
  std::string expected;
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok());
  for (const std::size_t size : {1, 1000, 262143, 262144, 5, 700000, 0, 3}) {
    const std::string piece(size, static_cast<char>('a' + size % 26));
    expected += piece;
    ASSERT_TRUE(file->write(piece).ok());
    EXPECT_EQ(file->size(), expected.size());
  }
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(get(path("out")), expected);
}

// Those of this size are given to the system in two parts.
TEST_F(AppendedBytesTest, APipeGetsAllInOrder) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  std::string expected, got;
  std::thread reader([&] { got = get(path("pipe")); });
  auto file = OutputFile::create(path("pipe"));
  ASSERT_TRUE(file.ok());
  for (int i = 0; i < 30; ++i) {
    const std::string piece(static_cast<std::size_t>(200000 + i), static_cast<char>('a' + i % 26));
    expected += piece;
    EXPECT_TRUE(file->write(piece));
  }
  EXPECT_TRUE(file->commit());
  file = OutputFile::create(path("other"));  // lets go of the pipe
  reader.join();
  EXPECT_EQ(got, expected);
}

TEST_F(AppendedBytesTest, LargeAndSmallWritesComeInOrder) {
  std::string expected;
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok());
  for (int i = 0; i < 200; ++i) {
    const std::string part(static_cast<std::size_t>(i % 5 == 0 ? 300000 : i * 777 % 100000),
                           static_cast<char>('a' + i % 26));
    ASSERT_TRUE(file->write(part));
    expected += part;
    if (i % 40 == 7) {
      expected.replace(5 * static_cast<std::size_t>(i), 3, "new");
      ASSERT_TRUE(
          file->overwrite(5 * static_cast<std::uint64_t>(i), std::as_bytes(std::span("new", 3))));
    }
  }
  EXPECT_EQ(file->size(), expected.size());
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(InputFile::open(path("out"))->text(), expected);
}

// Parts of sizes around those that are given to the system, and more of them than it takes at once.
TEST_F(AppendedBytesTest, PartsComeOneBehindTheOther) {
  std::string expected;
  auto file = OutputFile::create(path("out"));
  ASSERT_TRUE(file.ok());
  std::vector<std::vector<std::size_t>> writes = {
      {}, {0}, {3, 0, 4}, {262137, 1}, {262142, 1, 1, 5}, {600000, 0, 600000, 7}, {1, 262144}};
  writes.emplace_back(5000, 777);
  writes.emplace_back(2100, 1);
  for (const auto& sizes : writes) {
    std::vector<std::string> texts;
    for (const std::size_t size : sizes) {
      texts.emplace_back(size, static_cast<char>('a' + (texts.size() * 7 + size) % 26));
      expected += texts.back();
    }
    std::vector<std::span<const std::byte>> parts;
    for (const std::string& text : texts) parts.push_back(std::as_bytes(std::span(text)));
    ASSERT_TRUE(file->write(parts));
    EXPECT_EQ(file->size(), expected.size());
  }
  ASSERT_TRUE(file->commit());
  EXPECT_TRUE(get(path("out")) == expected);
}

TEST_F(AppendedBytesTest, AFullDeviceIsAnErrorInTheMiddleOfParts) {
  auto file = OutputFile::create("/dev/full");
  ASSERT_TRUE(file.ok());
  const std::string text(400000, 'x');
  const std::vector parts(3, std::as_bytes(std::span(text)));
  const Status status = file->write(parts);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "file-unwritable");
  EXPECT_FALSE(file->commit().ok());
}

}  // namespace
}  // namespace krok

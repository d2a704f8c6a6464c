// If these fail, errors lose their place or text on the way to the user.
#include "core/result.h"

#include <gtest/gtest.h>

#include <memory>

namespace krok {
namespace {

Result<int> half(int value) {
  if (value % 2 != 0) return Error("odd", "the number is odd", "take another");
  return value / 2;
}

TEST(Result, HoldsAValue) {
  const Result<int> result = half(8);
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_EQ(*result, 4);
  EXPECT_EQ(result.value(), 4);
}

TEST(Result, HoldsAnError) {
  const Result<int> result = half(7);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "odd");
  EXPECT_EQ(result.error().message, "the number is odd");
  EXPECT_EQ(result.error().hint, "take another");
  EXPECT_EQ(result.error().severity, Severity::error);
}

TEST(Result, MovesAValueThatCannotBeCopied) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = *std::move(result);
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 3);
}

TEST(Result, StatusIsSuccessByDefault) {
  EXPECT_TRUE(Status().ok());
  const Status status = Error("code", "text");
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "code");
}

TEST(Error, TakesAPlaceAndKeepsTheFirstFile) {
  const Error error = Error("c", "m").in_file("a.bvh").in_file("b.bvh").at_line(3, 5).at_byte(17);
  EXPECT_EQ(error.where.file, "a.bvh");
  EXPECT_EQ(error.where.line, 3);
  EXPECT_EQ(error.where.column, 5);
  EXPECT_EQ(error.where.byte_offset, 17);
}

TEST(Error, KnowsNoPlaceByDefault) {
  const Error error("c", "m");
  EXPECT_TRUE(error.where.file.empty());
  EXPECT_EQ(error.where.line, 0);
  EXPECT_EQ(error.where.byte_offset, -1);
  EXPECT_EQ(error.frame, -1);
}

}  // namespace
}  // namespace krok

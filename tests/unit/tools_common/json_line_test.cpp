// If these fail, journals and reports of batches hold other bytes than the JSON library writes: a
// name in another script or a broken byte makes a line that no one can read.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tools/common/json_line.h"

namespace krok {
namespace {

std::string by_library(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

TEST(JsonLine, EachByteAsTheLibraryWritesIt) {
  for (int byte = 0; byte < 256; ++byte) {
    const std::string text = std::string("a") + static_cast<char>(byte) + "b";
    EXPECT_EQ(json_line(text), by_library(text)) << byte;
    const Json named = {{text, byte}};
    EXPECT_EQ(json_line(named), by_library(named)) << byte;
  }
  for (const char* text :
       {"", "\xc3\xa9", "\xc3", "\xed\xa0\x80", "\xf0\x9f\x9a\xb6 walk", "\\\"/"}) {
    EXPECT_EQ(json_line(text), by_library(text));
  }
}

TEST(JsonLine, EachKindOfValue) {
  const Json value = {{"nothing", nullptr},
                      {"no", false},
                      {"yes", true},
                      {"least", std::numeric_limits<std::int64_t>::min()},
                      {"most", std::numeric_limits<std::uint64_t>::max()},
                      {"minus", -7},
                      {"third", 1.0 / 3.0},
                      {"whole", 120.0},
                      {"not a number", std::nan("")},
                      {"z before a", Json::array()},
                      {"a", Json::object()},
                      {"nested", {{"list", {1, "two", {{"three", 3}}, Json::array({nullptr})}}}}};
  EXPECT_EQ(json_line(value), by_library(value));
  EXPECT_EQ(json_line(Json()), "null");
  EXPECT_EQ(json_line(Json::array({1, 2})), "[1,2]");
}

}  // namespace
}  // namespace krok

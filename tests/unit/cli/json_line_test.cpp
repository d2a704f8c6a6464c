// If these fail, a name in another script or a broken byte makes a line of a batch's journal that
// no one can read, or ends the batch.
#include "tools/cli/report.h"

#include <gtest/gtest.h>

namespace krok::cli {
namespace {

TEST(JsonLine, IsOneLineWithNamesInTheirOrder) {
  const Json value = {{"b", {1, "two\n", nullptr}}, {"a", Json::object()}};
  EXPECT_EQ(json_text(value), R"({"b":[1,"two\n",null],"a":{}})");
}

TEST(JsonLine, BytesThatAreNoTextAreReplaced) {
  EXPECT_EQ(json_text(Json("caf\xc3\xa9")), "\"caf\xc3\xa9\"");
  EXPECT_EQ(json_text(Json("caf\xe9")), "\"caf\xef\xbf\xbd\"");
}

}  // namespace
}  // namespace krok::cli

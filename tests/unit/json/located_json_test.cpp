// If these fail, messages about hand-written JSON point to the wrong place, or a hostile file takes
// time or memory out of proportion.

#include "formats/json/located_json.h"

#include <gtest/gtest.h>

#include <random>

#include "support/told_mistakes.h"

namespace krok::json {
namespace {

using Kind = Value::Kind;

TEST(LocatedJson, ReadsEveryKindWithItsPlace) {
  const std::string text =
      "{ \"a\\\"b\" : [1, -2.5e1 ,true,null,\"x\\u00e4\"],\r\n  \"c\":{\"d\":[]} }";
  const auto root = parse(text);
  ASSERT_TRUE(root.ok());
  ASSERT_EQ(root->kind, Kind::object);
  ASSERT_EQ(root->members.size(), 2u);
  EXPECT_EQ(root->members[0].key, "a\"b");
  EXPECT_EQ(root->members[0].key_offset, text.find("\"a"));
  const Value& list = root->members[0].value;
  EXPECT_EQ(list.offset, text.find('['));
  ASSERT_EQ(list.items.size(), 5u);
  EXPECT_EQ(list.items[0].number, 1);
  EXPECT_EQ(list.items[0].offset, text.find("1,"));
  EXPECT_EQ(list.items[1].number, -25);
  EXPECT_EQ(list.items[1].offset, text.find("-2"));
  EXPECT_TRUE(list.items[2].truth);
  EXPECT_EQ(list.items[2].offset, text.find("true"));
  EXPECT_EQ(list.items[3].kind, Kind::null);
  EXPECT_EQ(list.items[4].text, "x\xC3\xA4");
  EXPECT_EQ(list.items[4].offset, text.find("\"x"));
  const Value* c = root->find("c");
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->offset, text.rfind('{'));
  EXPECT_EQ(c->find("d")->offset, text.rfind('['));
  EXPECT_EQ(root->find("e"), nullptr);
}

TEST(LocatedJson, SaysWhereTheTextIsBroken) {
  const auto place = [](std::string_view text) {
    const auto result = parse(text);
    EXPECT_FALSE(result.ok()) << text;
    if (result.ok()) return std::string("none");
    EXPECT_FALSE(result.error().message.empty());
    return test::place_of(result.error());
  };
  EXPECT_EQ(place("{\n  \"a\": 1,\n  \"b\" 2\n}"), "json-syntax 3:7");
  EXPECT_EQ(place("{\"a\": 1} x"), "json-syntax 1:10");
  // As JavaScript and Python allow it.
  for (const char* text : {"[1, 2,\n]", "{\"a\": 1, }"}) {
    EXPECT_NE(parse(text).error().hint.find("no comma"), std::string::npos) << text;
  }
  EXPECT_EQ(parse("[,]").error().hint.find("no comma"), std::string::npos);
  EXPECT_EQ(place("[1, 2"), "json-syntax 1:6");
  EXPECT_EQ(place(""), "json-syntax 1:1");
  EXPECT_EQ(place("{\"a\": 1,\n \"a\": 2}"), "json-syntax 2:2");
  EXPECT_EQ(place("[NaN]"), "json-syntax 1:2");
  EXPECT_EQ(place("[\"\xFF\"]").substr(0, 13), "json-syntax 1");
  EXPECT_EQ(place(std::string(33, '[')), "json-limit 1:33");
  EXPECT_EQ(parse("[1, 2]", 3).error().code, "json-limit");
  EXPECT_TRUE(parse("\xEF\xBB\xBF[]").ok());
}

TEST(LocatedJson, ManyKeysAreRefusedBeforeTheyTakeLong) {
  std::string text = "{";
  for (int i = 0; i < 200'000; ++i) text += "\"" + std::to_string(i) + "\":0,";
  text.back() = '}';
  EXPECT_EQ(parse(text).error().code, "json-limit");
}

TEST(LocatedJson, DamageNeverCrashes) {
  const std::string good = "{\"a\": [1, 2.5, \"t\\n\", {\"b\": null}], \"c\": true}";
  std::mt19937 random(1);
  for (int round = 0; round < 5000; ++round) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) {
      bad[random() % bad.size()] = static_cast<char>(random() % 256);
    }
    const auto result = parse(bad.substr(0, random() % (bad.size() + 1)));
    if (!result.ok()) {
      EXPECT_FALSE(result.error().code.empty());
    }
  }
}

}  // namespace
}  // namespace krok::json

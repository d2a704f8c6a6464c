// If these fail, contacts and keytimes come back from their file other than they were written, an
// edit by hand is not noticed and gets lost, or a mistake in the file is passed over or reported at
// the wrong place.

#include "formats/keys/keys.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/this_build.h"
#include "support/told_mistakes.h"

namespace krok::keys {
namespace {

Skeleton feet() {
  Skeleton skeleton;
  skeleton.add("Hips", Skeleton::kNoParent, {Vec3(0, 1, 0), Quat::Identity()});
  skeleton.add("LeftFoot", 0, {Vec3(0.1, 0.1, 0), Quat::Identity()});
  skeleton.add("Right\"Foot\xC3\xA9", 0, {Vec3(-0.1, 0.1, 0), Quat::Identity()});
  return skeleton;
}

MotionKeys walk() {
  MotionKeys keys;
  keys.contacts = {{1, 0.1, 0.75, Vec3(0.1, 0.08, -1.23456)},
                   {2, 0.4833333333, 1.25, Vec3(-0.1, 0.08, 1e-9)}};
  keys.keytimes = {{0.1, "left_strike"}, {0.75, "left_off"}, {1.25, "right_off"}};
  return keys;
}

TEST(Keys, ComeBackAsWritten) {
  const Skeleton skeleton = feet();
  const MotionKeys keys = walk();
  const std::string text = write(keys, skeleton, 2);
  const auto back = read(text, "walk.keys.json", skeleton, 2);
  ASSERT_TRUE(back.ok()) << back.error().message;
  ASSERT_EQ(back->contacts.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->contacts[i].joint, keys.contacts[i].joint);
    EXPECT_NEAR(back->contacts[i].start, keys.contacts[i].start, 5e-7);
    EXPECT_NEAR(back->contacts[i].end, keys.contacts[i].end, 5e-7);
    EXPECT_LT((back->contacts[i].place - keys.contacts[i].place).norm(), 1e-5);
  }
  ASSERT_EQ(back->keytimes.size(), 3U);
  EXPECT_EQ(back->keytimes[2].name, "right_off");
  EXPECT_NEAR(back->keytimes[2].time, 1.25, 5e-7);
  EXPECT_EQ(write(*back, skeleton, 2), text);
  EXPECT_TRUE(check(*back, skeleton, 2).ok());
}

// Another JSON library, which we did not write, must take it too.
TEST(Keys, AreJson) {
  const auto json = nlohmann::json::parse(write(walk(), feet(), 2));
  EXPECT_EQ(json["schema"], "krok.keys/1");
  EXPECT_EQ(json["contacts"][1]["joint"], "Right\"Foot\xC3\xA9");
  EXPECT_EQ(json["contacts"][1]["place"][2], 0);
  EXPECT_EQ(json["keytimes"][0]["name"], "left_strike");
}

TEST(Keys, NothingFoundIsAFileToo) {
  const std::string text = write({}, feet(), 0);
  const auto back = read_sidecar(text, "p", feet(), 0);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(back->keys.empty());
  EXPECT_FALSE(back->edited);
}

TEST(Keys, AreReadInAnyOrder) {
  const auto back = read(R"({"schema": "krok.keys/1", "keytimes": [
      {"name": "b", "time": 1}, {"name": "a", "time": 0.5}], "contacts": [
      {"joint": "LeftFoot", "start": 1, "end": 2, "place": [0, 0, 0]},
      {"joint": "LeftFoot", "start": 0.5, "end": 0.5, "place": [1, 2, 3]}]})",
                         "p", feet(), 2);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->keytimes[0].name, "a");
  EXPECT_EQ(back->contacts[0].place, Vec3(1, 2, 3));
}

// Keytimes a microsecond apart are sound, and rounding must not put them together.
TEST(Keys, CloseKeytimesStayApart) {
  MotionKeys keys;
  keys.keytimes = {{0.5000004, "a"}, {0.50000141, "b"}, {0.50000242, "c"}};
  ASSERT_TRUE(check(keys, feet(), 1).ok());
  const auto back = read_sidecar(write(keys, feet(), 1), "p", feet(), 1);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->keys.keytimes.size(), 3U);
  EXPECT_FALSE(back->edited);
}

// The last frame of a third of a second is written beyond the clip's end by rounding.
TEST(Keys, TheEndOfTheMotionIsWithinIt) {
  const double duration = 2.0 / 3;
  MotionKeys keys;
  keys.contacts = {{1, 0, duration, Vec3::Zero()}};
  const auto back = read_sidecar(write(keys, feet(), duration), "p", feet(), duration);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_FALSE(back->edited);
}

TEST(Keys, EditsByHandAreNoticed) {
  const Skeleton skeleton = feet();
  const std::string text = write(walk(), skeleton, 2);
  const auto edited = [&](const std::string& changed) {
    const auto sidecar = read_sidecar(changed, "p", skeleton, 2);
    EXPECT_TRUE(sidecar.ok()) << (sidecar.ok() ? "" : sidecar.error().message);
    return sidecar.ok() && sidecar->edited;
  };
  EXPECT_FALSE(edited(text));
  EXPECT_FALSE(edited(nlohmann::json::parse(text).dump())) << "layout is no edit";
  EXPECT_TRUE(edited(test::replaced(text, "0.483333", "0.49")));
  EXPECT_TRUE(edited(test::replaced(text, "left_off", "left_lift")));
  EXPECT_TRUE(edited(test::replaced(text, ",\n    {\"name\": \"right_off\", \"time\": 1.25}", "")));
  EXPECT_TRUE(edited(test::replaced(text, "-1.23456", "-1.2")));
  EXPECT_TRUE(edited(test::replaced(text, "\"edited\": false", "\"edited\": true")));
  EXPECT_TRUE(edited(R"({"schema": "krok.keys/1"})")) << "no tool wrote this";
}

TEST(Keys, MarksOfTheHandComeBack) {
  Sidecar sidecar{walk(), {0, 1}, {1, 0, 0}, true, 2};
  const std::string text = write_sidecar(sidecar, feet());
  const auto back = read_sidecar(text, "p", feet(), 2);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->contacts_by_hand, sidecar.contacts_by_hand);
  EXPECT_EQ(back->keytimes_by_hand, sidecar.keytimes_by_hand);
  EXPECT_TRUE(back->edited);
  EXPECT_TRUE(back->has_edits());
  EXPECT_EQ(back->duration, 2);
  EXPECT_EQ(write_sidecar(*back, feet()), text);
}

TEST(Keys, MarksAloneAreEditsThatAToolCanKeep) {
  const auto found = read_sidecar(write(walk(), feet(), 2), "p", feet(), 2);
  ASSERT_TRUE(found.ok());
  EXPECT_FALSE(found->has_edits());
  Sidecar sidecar{walk(), {0, 0}, {1, 0, 0}, false, 2};
  const auto back = read_sidecar(write_sidecar(sidecar, feet()), "p", feet(), 2);
  ASSERT_TRUE(back.ok());
  EXPECT_FALSE(back->edited);
  EXPECT_TRUE(back->has_edits());
}

TEST(Keys, EveryMistakeIsToldWithItsPlace) {
  const std::string good = R"({
  "schema": "krok.keys/1",
  "duration": 2,
  "edited": false,
  "contacts": [
    {"joint": "LeftFoot", "start": 0.1, "end": 0.75, "place": [0.1, 0.08, -1]}
  ],
  "keytimes": [
    {"name": "left_strike", "time": 0.1},
    {"name": "left_off", "time": 0.75, "by": "hand"}
  ]
})";
  ASSERT_TRUE(read(good, "p", feet(), 2).ok());
  const test::Mistake mistakes[] = {
      {"keys/1", "keys/2", "keys-structure 2:13", "krok.keys/2"},
      {"\"duration\": 2", "\"duration\": -2", "keys-value 3:15", "negative"},
      {"\"edited\": false", "\"edited\": 0", "keys-value 4:13", "a number"},
      {"\"edited\"", "\"edit\"", "keys-structure 4:3", "edit"},
      {"\"LeftFoot\"", "\"LeftHoof\"", "keys-joint 6:15", "LeftHoof"},
      {"\"LeftFoot\"", "7", "keys-value 6:15", "a number"},
      {"\"start\": 0.1, ", "", "keys-structure 6:5", "start"},
      {"\"start\": 0.1", "\"start\": -0.1", "keys-time 6:36", "outside"},
      {"\"start\": 0.1", "\"start\": 0.8", "keys-time 6:48", "before it starts"},
      {"\"end\": 0.75", "\"end\": 2.01", "keys-time 6:48", "outside"},
      {"\"end\": 0.75", "\"end\": null", "keys-value 6:48", "null"},
      {"-1]", "-1, 4]", "keys-value 6:63", "three numbers"},
      {"-1]", "\"-1\"]", "keys-value 6:63", "three numbers"},
      {"-1]", "1e300]", "keys-value 6:63", "three numbers"},
      {"\"place\"", "\"at\"", "keys-structure 6:54", "at"},
      {"\"time\": 0.1", "\"time\": 3", "keys-time 9:37", "outside"},
      {"\"left_strike\"", "\"\"", "keys-value 9:14", "not a valid keytime name"},
      {"left_strike", "left\\nstrike", "keys-value 9:14", "not a valid keytime name"},
      {"\"time\": 0.75", "\"time\": 0.1", "keys-time 10:5", "both at 0.1"},
      {"\"hand\"", "\"foot\"", "keys-value 10:46", "foot"},
      {"[\n    {\"name\"", "{\n    {\"name\"", "json-syntax 9:5", ""},
      {"\"keytimes\": [", "\"contacts\": [", "json-syntax 8:3", "duplicate"},
  };
  test::expect_told(
      good, mistakes, [](const std::string& text) { return read(text, "p.keys.json", feet(), 2); },
      "p.keys.json");
}

// Hostile: every cut of a sound file is an error, never a crash, and no value is believed.
TEST(Keys, DamagedTextIsAnError) {
  const std::string text = write(walk(), feet(), 2);
  for (std::size_t size = 0; size + 2 < text.size(); ++size) {
    EXPECT_FALSE(read(text.substr(0, size), "p", feet(), 2).ok()) << size;
  }
  for (const char* hostile : {"", "[]", "null", "{}", "\"krok.keys/1\"", "{\"schema\": 1}",
                              R"({"schema": "krok.keys/1", "contacts": {}})",
                              R"({"schema": "krok.keys/1", "keytimes": [[]]})",
                              R"({"schema": "krok.keys/1", "duration": 1e999})"}) {
    EXPECT_FALSE(read(hostile, "p", feet(), 2).ok()) << hostile;
  }
  std::string flipped = text;
  for (std::size_t i = 0; i < text.size(); ++i) {
    flipped[i] = static_cast<char>(text[i] ^ 0x11);
    const auto result = read(flipped, "p", feet(), 2);
    flipped[i] = text[i];
    if (!result.ok()) {
      EXPECT_FALSE(result.error().code.empty());
      continue;
    }
    EXPECT_TRUE(check(*result, feet(), 2).ok()) << i;
  }
}

// The schema file must name every key that is written, and be JSON itself.
TEST(Keys, TheSchemaKnowsWhatIsWritten) {
  std::ifstream file(test::source_folder() + "/formats/keys/keys.schema.json");
  const auto schema = nlohmann::json::parse(file);
  Sidecar sidecar{walk(), {1, 1}, {1, 1, 1}, true, 2};
  const auto written = nlohmann::json::parse(write_sidecar(sidecar, feet()));
  for (const auto& [key, value] : written.items()) {
    EXPECT_TRUE(schema["properties"].contains(key)) << key;
  }
  for (const char* list : {"contacts", "keytimes"}) {
    for (const auto& [key, value] : written[list][0].items()) {
      EXPECT_TRUE(schema["properties"][list]["items"]["properties"].contains(key)) << key;
    }
    EXPECT_EQ(schema["properties"][list]["items"]["additionalProperties"], false);
  }
}

}  // namespace
}  // namespace krok::keys

// If these fail, a damaged timeline crashes or hangs a program, or is read wrongly. Run with the
// address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "formats/timeline/timeline_file.h"
#include "timeline/mix.h"
#include "unit/blend/blended_walks.h"

namespace krok::timeline_file {
namespace {

const std::string kText =
    "{\"schema\":\"krok.timeline/1\",\"rate\":20,\"sources\":{\"a\":\"a\",\"b\":{\"file\":\"b\","
    "\"sequences\":\"s\"}},\"base\":[{\"source\":\"a\",\"from\":\"0.2s\",\"to\":1,\"loop\":2,"
    "\"marks\":[{\"name\":\"m\",\"source_at\":\"9f\"}]},{\"source\":\"b\",\"sequence\":\"p\","
    "\"speed\":1.5,\"change\":{\"kind\":\"crossfade\",\"duration\":\"0.3s\",\"easing\":\"back\","
    "\"align\":\"stance\"}},{\"source\":\"a\",\"loop\":true,\"until\":\"4s\",\"place\":{\"x\":1,"
    "\"heading\":\"9deg\"},\"change\":{\"kind\":\"smooth\",\"duration\":0.2}},{\"source\":\"b\","
    "\"to\":\"20f\",\"speed\":-1,\"change\":{\"kind\":\"inertial\",\"duration\":0.2}}],\"layers\":"
    "[{\"mode\":\"modifier\",\"reference\":\"0.1s\",\"mask\":[{\"below\":\"LeftArm\",\"soft\":1},"
    "{\"joints\":\"Spine*\",\"weight\":0.5}],\"items\":[{\"source\":\"b\",\"at\":0.5,\"weight\":"
    "[[0,1],[1,3]],\"fade_in\":0.1,\"fade_out\":{\"duration\":0.1}}]},{\"space\":\"model\","
    "\"mask\":[{\"below\":\"RightArm\"}],\"items\":[{\"source\":\"a\",\"loop\":3}]}]}";

const blend::KeyedWalk& walk() {
  static const blend::KeyedWalk made = [] {
    samples::WalkOptions options = blend::slow_walk();
    options.steps = 3;
    return blend::keyed_walk(options);
  }();
  return made;
}

// Reads a text and mixes its timeline. The result must be consistent.
bool read_and_play(const std::string& text) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  std::copy(text.begin(), text.end(), copy.get());
  const auto document = read({copy.get(), text.size()}, "t.json");
  if (!document.ok()) {
    EXPECT_FALSE(document.error().code.empty());
    EXPECT_FALSE(document.error().message.empty());
    EXPECT_GT(document.error().where.line, 0) << document.error().message;
    return false;
  }
  // High frame rates are valid, but too slow for this test.
  if (document->timeline.rate > 100) return false;
  std::vector<timeline::Source> sources;
  for (const SourceFile& file : document->sources) {
    sources.push_back({file.name, &walk().clip, &walk().keys, {{"p", {0, false}, {1, false}}}});
  }
  const auto mixed =
      timeline::mix(document->timeline, sources, find_roles(walk().clip.skeleton), {.jobs = 1});
  if (!mixed.ok()) {
    EXPECT_FALSE(mixed.error().code.empty());
    return false;
  }
  EXPECT_TRUE(check(mixed->clip).ok()) << text;
  const Status status = check(mixed->keys, mixed->clip.skeleton, mixed->clip.duration());
  EXPECT_TRUE(status.ok()) << text << status.error().message;
  return true;
}

TEST(DamagedTimelines, TheWholeOneIsPlayed) {
  EXPECT_TRUE(read_and_play(kText));
}

TEST(DamagedTimelines, EveryTruncationIsRefused) {
  for (std::size_t size = 0; size < kText.size(); ++size) {
    EXPECT_FALSE(read_and_play(kText.substr(0, size))) << size;
  }
}

TEST(DamagedTimelines, OtherBytesAnywhereAreHandled) {
  for (std::size_t at = 0; at < kText.size(); ++at) {
    for (const char byte : {'\0', '"', '{', ']', ',', '-', '9', 'e', '\\', '\xFF'}) {
      std::string text = kText;
      text[at] = byte;
      (void)read_and_play(text);
    }
  }
}

// Replaces whole tokens by other values.
TEST(DamagedTimelines, OtherValuesAreHandled) {
  std::vector<std::pair<std::size_t, std::size_t>> tokens;
  for (std::size_t at = kText.find("base"); at < kText.size(); ++at) {
    if (kText[at] != ':' && kText[at] != '[' && kText[at] != ',') continue;
    std::size_t end = at + 1;
    if (kText[end] == '"') {
      end = kText.find('"', end + 1) + 1;
    } else {
      while (end < kText.size() &&
             std::string("0123456789.-true").find(kText[end]) != std::string::npos) {
        ++end;
      }
    }
    if (end > at + 1) tokens.emplace_back(at + 1, end - at - 1);
  }
  ASSERT_GT(tokens.size(), 50u);
  int played = 0;
  for (const auto& [at, size] : tokens) {
    for (const char* value : {"0",        "-1",      "1e-9",  "1e9",  "1e308", "-1e308", "0.05",
                              "1",        "3",       "true",  "null", "\"\"",  "\"1f\"", "\"-3s\"",
                              "\"1e9s\"", "\"nan\"", "\"*\"", "[]",   "{}",    "[[0,0]]"}) {
      std::string text = kText;
      text.replace(at, size, value);
      played += read_and_play(text) ? 1 : 0;
    }
  }
  EXPECT_GT(played, 50);
}

TEST(DamagedTimelines, RandomPiecesAreHandled) {
  std::mt19937 random(11);
  for (int i = 0; i < 1500; ++i) {
    std::string text = kText;
    for (unsigned k = 0; k < 1 + random() % 3; ++k) {
      const std::size_t from = random() % text.size(), size = random() % 30;
      const std::string piece = kText.substr(random() % kText.size(), random() % 30);
      text.replace(from, std::min(size, text.size() - from), piece);
    }
    (void)read_and_play(text);
  }
}

}  // namespace
}  // namespace krok::timeline_file

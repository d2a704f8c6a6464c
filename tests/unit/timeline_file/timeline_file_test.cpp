// If these fail, a timeline says something else than its author wrote, or the author is not told
// where a mistake is.

#include "formats/timeline/timeline_file.h"
#include "support/this_build.h"

#include <gtest/gtest.h>

#include <fstream>

namespace krok::timeline_file {
namespace {

using timeline::ChangeKind;
using timeline::Curve;
using timeline::Ease;
using timeline::LayerMode;

const std::string kBegin =
    "{\"schema\": \"krok.timeline/1\",\n \"rate\": 50,\n"
    " \"sources\": {\"walk\": \"w.anim\", \"run\": {\"file\": \"r.bvh\", "
    "\"sequences\": \"r.json\"}},\n";

Document good(const std::string& text) {
  auto read = timeline_file::read(text, "t.json");
  EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().message);
  return read.ok() ? std::move(*read) : Document();
}

Error bad(const std::string& text) {
  const auto read = timeline_file::read(text, "t.json");
  EXPECT_FALSE(read.ok()) << text;
  return read.ok() ? Error() : read.error();
}

std::string base(const std::string& items) {
  return kBegin + " \"base\": [" + items + "]}";
}
std::string layers(const std::string& list) {
  return kBegin + " \"base\": [{\"source\": \"walk\"}],\n \"layers\": [" + list + "]}";
}

TEST(TimelineFile, TheSpecificationsExampleReads) {
  std::ifstream file(test::source_folder() + "/formats/timeline/SPEC.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const std::size_t begin = page.find("```json\n") + 8;
  const Document document = good(page.substr(begin, page.find("```", begin) - begin));
  ASSERT_EQ(document.sources.size(), 3u);
  EXPECT_EQ(document.sources[1].name, "run");
  EXPECT_EQ(document.sources[1].path, "captures/run.bvh");
  EXPECT_EQ(document.sources[2].sequences, "take_07.json");
  const auto& [rate, items, on_top] = document.timeline;
  EXPECT_EQ(rate, 60);
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[0].play.source, 0);
  EXPECT_EQ(items[0].play.to->value, 2.5);
  ASSERT_EQ(items[0].marks.size(), 1u);
  EXPECT_EQ(items[0].marks[0].name, "look");
  EXPECT_FALSE(items[0].marks[0].of_source);
  EXPECT_EQ(items[1].play.rounds, 0);
  EXPECT_EQ(items[1].change.kind, ChangeKind::crossfade);
  EXPECT_EQ(items[1].change.duration, 0.5);
  EXPECT_EQ(items[1].change.easing.curve, Curve::sine);
  EXPECT_EQ(items[1].change.easing.ease, Ease::in_out);
  EXPECT_TRUE(items[2].play.from->in_frames);
  EXPECT_EQ(items[2].play.from->value, 60);
  EXPECT_EQ(items[2].change.kind, ChangeKind::inertial);
  EXPECT_TRUE(items[2].change.guard);
  ASSERT_EQ(on_top.size(), 1u);
  EXPECT_EQ(on_top[0].name, "arm");
  EXPECT_EQ(on_top[0].mode, LayerMode::override);
  ASSERT_EQ(on_top[0].mask.size(), 1u);
  EXPECT_EQ(on_top[0].mask[0].below, "LeftShoulder");
  EXPECT_EQ(on_top[0].mask[0].soft, 2);
  const timeline::LayerItem& item = on_top[0].items.at(0);
  EXPECT_EQ(item.name, "wave:wave left");
  EXPECT_EQ(item.play.part, "wave left");
  EXPECT_EQ(item.play.rounds, 3);
  EXPECT_EQ(item.fade_in.duration, 0.3);
  EXPECT_EQ(item.fade_out.duration, 0.5);
  EXPECT_EQ(item.fade_out.easing.curve, Curve::quad);
  EXPECT_EQ(item.fade_out.easing.ease, Ease::out);
}

TEST(TimelineFile, UnitsAndAllElse) {
  const Document document = good(
      base("{\"source\": \"walk\", \"name\": \"a\", \"speed\": -1.5, \"loop\": 4, \"comment\": [1],"
           "\"marks\": [{\"name\": \"m\", \"source_at\": \"12f\"}], "
           "\"place\": {\"x\": \"50cm\", \"z\": -2, \"heading\": \"90deg\"}},"
           "{\"source\": \"run\", \"sequence\": \"jog\", \"at\": \"100f\", \"until\": 9, \"loop\": "
           "false, "
           "\"change\": {\"kind\": \"smooth\", \"duration\": \"250ms\", \"align\": \"root\"}},"
           "{\"source\": \"run\", \"change\": {\"kind\": \"crossfade\", \"duration\": \"25f\", "
           "\"sync\": "
           "\"keytimes\", \"align\": \"stance\"}},"
           "{\"source\": \"run\", \"change\": {\"kind\": \"inertial\", \"duration\": 1, \"guard\": "
           "false}}, {\"source\": \"run\", \"change\": \"cut\"}"));
  const auto& items = document.timeline.base;
  ASSERT_EQ(items.size(), 5u);
  EXPECT_EQ(items[0].name, "a");
  EXPECT_EQ(items[0].play.speed, -1.5);
  EXPECT_EQ(items[0].play.rounds, 4);
  EXPECT_TRUE(items[0].marks.at(0).of_source);
  EXPECT_TRUE(items[0].marks.at(0).at.in_frames);
  EXPECT_DOUBLE_EQ(items[0].place->x, 0.5);
  EXPECT_DOUBLE_EQ(items[0].place->z, -2);
  EXPECT_DOUBLE_EQ(items[0].place->heading, kPi / 2);
  EXPECT_EQ(items[1].name, "run:jog");
  EXPECT_TRUE(items[1].at->in_frames);
  EXPECT_EQ(items[1].play.until->value, 9);
  EXPECT_EQ(items[1].play.rounds, 1);
  EXPECT_DOUBLE_EQ(items[1].change.duration, 0.25);
  EXPECT_EQ(items[1].change.align, timeline::Align::root);
  EXPECT_DOUBLE_EQ(items[2].change.duration, 0.5);  // 25 frames at 50 a second
  EXPECT_EQ(items[2].change.sync, timeline::Sync::keytimes);
  EXPECT_FALSE(items[3].change.guard);
  EXPECT_EQ(items[4].change.kind, ChangeKind::cut);
  EXPECT_EQ(items[4].where.file, "t.json");
  EXPECT_EQ(items[0].where.line, 4);
  EXPECT_EQ(items[0].where.column, 11);

  const Document on_top = good(layers(
      "{\"mode\": \"modifier\", \"reference\": \"pose\", \"mask\": [{\"joints\": \"*Arm\", "
      "\"weight\": 0.5}],\r\n \"items\": [{\"source\": \"run\", \"at\": 1, \"weight\": [[0, 0], "
      "[\"1s\", 2.5]]}]},\n{\"space\": \"model\", \"items\": []}, {\"mode\": \"additive\", "
      "\"reference\": \"3f\", \"items\": []}"));
  const auto& list = on_top.timeline.layers;
  ASSERT_EQ(list.size(), 3u);
  EXPECT_TRUE(list[0].reference_pose);
  EXPECT_EQ(list[0].mask[0].weight, 0.5);
  EXPECT_EQ(list[0].items[0].weight.weights, (std::vector<double>{0, 2.5}));
  EXPECT_EQ(list[0].items[0].where.line, 6);
  EXPECT_EQ(list[1].space, timeline::Space::model);
  EXPECT_EQ(list[1].name, "layer 2");
  EXPECT_EQ(list[1].where.line, 7);
  EXPECT_TRUE(list[2].reference->in_frames);
}

struct Mistake {
  std::string text, code, words;
};

TEST(TimelineFile, MistakesAreToldWithTheirPlace) {
  const auto item = [](const std::string& rest) {
    return base("{\"source\": \"walk\"},\n{\"source\": \"walk\", " + rest + "}");
  };
  const auto change = [&](const std::string& rest) {
    return item("\"change\": {\"kind\": " + rest + "}");
  };
  const auto layer = [](const std::string& rest) {
    return layers("\n\n{\"items\": [], " + rest + "}");
  };
  const auto on_top = [](const std::string& rest) {
    return layers("\n\n{\"items\": [{\"source\": \"run\", " + rest + "}]}");
  };
  const std::string structure = "timeline-structure", value = "timeline-value";
  const Mistake mistakes[] = {
      {"", "json-syntax", ""},
      {"[]", structure, "expected an object"},
      {"{}", structure, "schema"},
      {"{\"schema\": \"krok.timeline/2\"}", structure, "krok.timeline/2"},
      {"{\"schema\": \"krok.timeline/1\"}", structure, "sources"},
      {kBegin + "\"bse\": []}", structure, "'bse'"},
      {kBegin + "\"base\": 1}", value, "base"},
      {base("1"), structure, "expected an object"},
      {base("{}"), structure, "source"},
      {base("{\"source\": \"wakl\"}"), value, "wakl"},
      {base("{\"source\": \"walk\", \"change\": \"cut\"}"), value, "first item"},
      {item("\"sped\": 1"), structure, "'sped'"},
      {item("\"speed\": \"fast\""), value, "'fast'"},
      {item("\"loop\": 0"), value, "an integer from 1"},
      {item("\"loop\": 2.5"), value, "2.5"},
      {item("\"loop\": 1e9"), value, "an integer"},
      {item("\"from\": \"1.5 parsecs\""), value, "parsecs"},
      {item("\"from\": \"\""), value, "number"},
      {item("\"from\": 1e300"), value, "a number within"},
      {item("\"from\": \"1e300s\""), value, "a time within"},
      {item("\"from\": null"), value, "null"},
      {item("\"sequence\": \"a\", \"to\": 1"), value, "own"},
      {item("\"sequence\": \"\""), value, "1 to 200 bytes"},
      {item("\"name\": \"a\\u0007\""), value, "1 to 200 bytes"},
      {item("\"name\": \"" + std::string(201, 'x') + "\""), value, "1 to 200 bytes"},
      {item("\"place\": {\"y\": 1}"), structure, "'y'"},
      {item("\"place\": {\"heading\": \"1m\"}"), value, "1m"},
      {item("\"marks\": [{\"at\": 1}]"), structure, "name"},
      {item("\"marks\": [{\"name\": \"a\"}]"), value, "either"},
      {item("\"marks\": [{\"name\": \"a\", \"at\": 1, \"source_at\": 1}]"), value, "either"},
      {item("\"change\": \"fade\""), value, "'fade'"},
      {item("\"change\": \"smooth\""), value, "duration"},
      {item("\"change\": {}"), structure, "kind"},
      {change("\"dissolve\""), value, "dissolve"},
      {change("\"smooth\""), value, "duration"},
      {change("\"smooth\", \"duration\": 0"), value, "more than 0"},
      {change("\"smooth\", \"duration\": -1"), value, "0 s or more"},
      {change("\"cut\", \"duration\": 1"), value, "cut has no"},
      {change("\"inertial\", \"duration\": 1, \"easing\": \"sine\""), value, "no \"easing\""},
      {change("\"smooth\", \"duration\": 1, \"sync\": \"clock\""), value, "no \"sync\""},
      {change("\"smooth\", \"duration\": 1, \"guard\": true"), value, "no \"guard\""},
      {change("\"smooth\", \"duration\": 1, \"easing\": \"cubic-inout\""), value, "cubic-inout"},
      {change("\"crossfade\", \"duration\": 1, \"sync\": \"keytime\""), value, "keytime"},
      {change("\"inertial\", \"duration\": 1, \"guard\": 1"), value, "true or false"},
      {layers("{}"), structure, "items"},
      {layer("\"mode\": \"add\""), value, "'add'"},
      {layer("\"mode\": \"additive\", \"space\": \"model\""), value, "override"},
      {layer("\"reference\": 1"), value, "additive"},
      {layer("\"mask\": [{}]"), value, "either"},
      {layer("\"mask\": [{\"below\": \"a\", \"joints\": \"b\"}]"), value, "either"},
      {layer("\"mask\": [{\"below\": \"a\", \"weight\": 2}]"), value, "0 to 1"},
      {layer("\"mask\": [{\"joints\": \"a\", \"soft\": 2}]"), value, "below"},
      {layer("\"mask\": [{\"below\": \"a\", \"soft\": -1}]"), value, "an integer"},
      {on_top("\"fade_in\": -1"), value, "0 s or more"},
      {on_top("\"fade_in\": {\"dur\": 1}"), structure, "'dur'"},
      {on_top("\"weight\": []"), value, "points"},
      {on_top("\"weight\": [[0, 1, 2]]"), value, "[time, weight]"},
      {on_top("\"weight\": [[0, 1], [0, 2]]"), value, "after the previous one"},
      {on_top("\"change\": \"cut\""), structure, "'change'"},
      {"{\"schema\": \"krok.timeline/1\", \"rate\": 0}", value, "0.001"},
      {"{\"schema\": \"krok.timeline/1\", \"sources\": {\"\": \"a\"}, \"base\": []}", value,
       "name"},
      {"{\"schema\": \"krok.timeline/1\", \"sources\": {\"a\": {}}, \"base\": []}", structure,
       "file"},
      {"{\"schema\": \"krok.timeline/1\", \"sources\": {\"a\": 3}, \"base\": []}", structure,
       "expected an object"},
      {"{\"schema\": \"krok.timeline/1\", \"sources\": {\"a\": \"a\"}, \"base\": [{\"source\": "
       "\"a\"}, {\"source\": \"a\", \"change\": {\"kind\": \"smooth\", \"duration\": \"5f\"}}]}",
       value, "seconds"},
  };
  for (const Mistake& mistake : mistakes) {
    const Error error = bad(mistake.text);
    EXPECT_EQ(error.code, mistake.code) << mistake.text << "\n" << error.message;
    EXPECT_NE(error.message.find(mistake.words), std::string::npos) << mistake.text << "\n"
                                                                    << error.message;
    EXPECT_EQ(error.where.file, "t.json");
    EXPECT_GE(error.where.line, 1) << mistake.text;
    EXPECT_GE(error.where.column, 1) << mistake.text;
    if (mistake.text.find("\n\n") != std::string::npos) {
      EXPECT_EQ(error.where.line, 7) << mistake.text;
    }
  }
}

TEST(TimelineFile, NearMissesAreGuessed) {
  EXPECT_EQ(bad(base("{\"source\": \"wakl\"}")).hint, "did you mean 'walk'?");
  const Error key = bad(base("{\"source\": \"walk\", \"lop\": 2}"));
  EXPECT_EQ(key.hint, "did you mean 'loop'?");
  EXPECT_EQ(key.where.line, 4);
  EXPECT_EQ(key.where.column, 30);
  const Error easing =
      bad(base("{\"source\": \"walk\"}, {\"source\": \"walk\", \"change\": {\"kind\": \"smooth\", "
               "\"duration\": 1, \"easing\": \"sinus-in\"}}"));
  EXPECT_EQ(easing.hint, "did you mean 'sine-in'?");
  EXPECT_NE(bad(base("{\"source\": \"xyzzy\"}")).hint.find("expected one of walk, run"),
            std::string::npos);
}

TEST(TimelineFile, ListsHaveTheirLimit) {
  std::string many = "{\"source\": \"walk\"}";
  for (int i = 0; i < 10'000; ++i) many += ",{\"source\": \"walk\"}";
  const Error error = bad(base(many));
  EXPECT_EQ(error.code, "timeline-value");
  EXPECT_NE(error.message.find("10001"), std::string::npos) << error.message;
  many.resize(many.size() - std::string(",{\"source\": \"walk\"}").size());
  EXPECT_EQ(good(base(many)).timeline.base.size(), 10'000u);
}

TEST(TimelineFile, AByteOrderMarkDoesNotMovePlaces) {
  const Document document = good("\xEF\xBB\xBF" + base("{\"source\": \"walk\"}"));
  EXPECT_EQ(document.timeline.base[0].where.line, 4);
  EXPECT_EQ(document.timeline.base[0].where.column, 11);
}

}  // namespace
}  // namespace krok::timeline_file

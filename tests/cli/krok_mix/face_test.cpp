// Faces, eyes and sockets in krok-mix and krok-ik. Would fail if weights were not written beside
// the motion, lips did not close, or eyes did not turn.

#include <cmath>

#include "cli/hero_character.h"

namespace krok::test {
namespace {

class Face : public HeroCharacter {
 protected:
  void SetUp() override {
    HeroCharacter::SetUp();
    put("mouth.character",
        R"({"schema": "krok.character/1", "model": "in.model", "morphs": "bent.exr",
            "eyes": [{"name": "left", "joint": "Head", "position": [0.03, 1.8, 0.1]},
                     {"name": "right", "joint": "Head", "position": [-0.03, 1.8, 0.1]}],
            "sockets": [{"name": "brow", "joint": "Head", "offset": [0, 0.1, 0.1]}],
            "expressions": [{"name": "lips", "target": "bent"}, {"name": "jaw", "target": "bent"},
                            {"name": "lids", "target": "bent", "weight": 0.25}]})");
    put("talk.csv", "start,end,label\n0.1,0.2,M\n0.2,0.4,AA1\n0.4,0.5,P\n");
  }

  std::string timeline(const std::string& rest) {
    return put("t.json", R"({"schema": "krok.timeline/1", "sources": {"in": "in.anim"},
                 "character": "mouth.character", "base": [{"source": "in"}], )" +
                             rest + "}");
  }

  // By frame, of the targets lips, jaw and lids.
  std::vector<std::array<double, 3>> weights() {
    std::vector<std::array<double, 3>> rows;
    std::istringstream text(get(path("out.weights.csv")));
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line, "frame,time,lips,jaw,lids");
    while (std::getline(text, line)) {
      auto& row = rows.emplace_back();
      double frame = 0, time = 0;
      char comma = 0;
      std::istringstream(line) >> frame >> comma >> time >> comma >> row[0] >> comma >> row[1] >>
          comma >> row[2];
    }
    return rows;
  }
};

TEST_F(Face, SpeechExpressionsAndBlinksBecomeWeights) {
  timeline(R"("face": [{"phonemes": "talk.csv", "shapes": {"PP": {"lips": 1}, "aa": {"jaw": 0.9}}},
      {"expression": "lids", "at": "0.3s", "mode": "additive", "weight": 0.5}])");
  tool("krok-mix", {"t.json", "-o", "out.anim"});
  const auto rows = weights();
  ASSERT_EQ(rows.size(), 20u);
  EXPECT_NEAR(rows[4][0], 1, 1e-6);  // closed at 0.15 s, within a frame
  EXPECT_NEAR(rows[13][0], 1, 1e-6);
  EXPECT_GT(rows[9][1], 0.5);
  EXPECT_NEAR(rows[0][2], 0.25, 1e-6);
  EXPECT_NEAR(rows[15][2], 0.75, 1e-6);
  tool("krok-skin", {"mouth.character", "out.anim", "--weights", "out.weights.csv", "-o", "o.glb"});
}

TEST_F(Face, MistakesAreToldWithTheirPlace) {
  const auto error_of = [&](const std::string& rest) {
    timeline(rest);
    return tool("krok-mix", {"t.json", "-o", "x.anim"}, 2).err;
  };
  EXPECT_THAT(error_of(R"("face": [{"phonemes": "talk.csv"}])"),
              AllOf(HasSubstr("t.json:2:"), HasSubstr("[timeline-shape]")));
  EXPECT_THAT(error_of(R"("face": [{"expression": "grin"}])"), HasSubstr("[timeline-target]"));
  EXPECT_THAT(error_of(R"("face": [{"expression": "lids", "seed": 3}])"),
              HasSubstr("is for blinks"));
  EXPECT_THAT(error_of(R"("face": [{"blinks": 20}])"), HasSubstr("need a \"target\""));
  put("talk.csv", "start,end,label\n0.1,0.2,M\n0.2,0.4,QQ\n");
  EXPECT_THAT(error_of(R"("face": [{"phonemes": "talk.csv", "alphabet": "arpabet",
                        "shapes": {"PP": {"lips": 1}}}])"),
              AllOf(HasSubstr("talk.csv:3:"), HasSubstr("[face-phoneme]")));
  EXPECT_FALSE(std::filesystem::exists(path("x.anim")));
}

TEST_F(Face, EyesTurnAndAreJointsAfterwards) {
  timeline(R"("gaze": [{"at": "0.1s", "target": [0.3, 1.8, 1]}])");
  tool("krok-mix", {"t.json", "-o", "out.anim"});
  const std::string info = tool("krok-info", {"out.anim", "-v"}).out;
  EXPECT_THAT(info, AllOf(HasSubstr("left_eye"), HasSubstr("right_eye")));
  const json made =
      json::parse(tool("krok-ik", {"in.anim", "--character", "mouth.character", "--look-at",
                                   "eyes=0.3m,1.8m,1m@0.1s..2s", "-o", "ik.anim", "--json"})
                      .out);
  EXPECT_LT(made["result"]["gaze"][0]["missed"].get<double>(), 2);
  const json exported = [&] {
    tool("krok-skin", {"mouth.character", "ik.anim", "-o", "o.gltf"});
    return json::parse(get(path("o.gltf")));
  }();
  int eyes = 0;
  for (const json& node : exported["nodes"]) eyes += node["name"] == "left_eye" ? 1 : 0;
  EXPECT_EQ(eyes, 1);
}

TEST_F(Face, ASocketMayBeAGoal) {
  tool("krok-ik", {"in.anim", "--character", "mouth.character", "--reach",
                   "brow=0.1m,1.7m,0.3m@0.3s", "-o", "ik.anim", "-v"});
  put("goals.json", R"({"schema": "krok.goals/1", "goals": [{"joint": "brow",
       "keys": [{"time": 0.3, "target": [0.1, 1.7, 0.3]}], "fade_in": 0.5, "fade_out": 0.5}]})");
  tool("krok-ik",
       {"in.anim", "--character", "mouth.character", "--goals", "goals.json", "-o", "goals.anim"});
  tool("krok-diff", {"ik.anim", "goals.anim"});
}

}  // namespace
}  // namespace krok::test

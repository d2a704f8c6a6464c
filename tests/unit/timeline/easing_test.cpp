// If these fail, changes and fades do not follow the curve that their name promises.

#include "timeline/easing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace krok::timeline {
namespace {

// Penner's functions in the form he gave them (t, b, c, d), evaluated by Python at 0.1, 0.3, 0.45,
// 0.7 and 0.95.
struct Row {
  const char* name;
  double values[5];
};
constexpr double kTimes[5] = {0.1, 0.3, 0.45, 0.7, 0.95};
// clang-format off
constexpr Row kPenner[] = {
    {"quad-in", {0.0100000000, 0.0900000000, 0.2025000000, 0.4900000000, 0.9025000000}},
    {"quad-out", {0.1900000000, 0.5100000000, 0.6975000000, 0.9100000000, 0.9975000000}},
    {"quad-in-out", {0.0200000000, 0.1800000000, 0.4050000000, 0.8200000000, 0.9950000000}},
    {"cubic-in", {0.0010000000, 0.0270000000, 0.0911250000, 0.3430000000, 0.8573750000}},
    {"cubic-out", {0.2710000000, 0.6570000000, 0.8336250000, 0.9730000000, 0.9998750000}},
    {"cubic-in-out", {0.0040000000, 0.1080000000, 0.3645000000, 0.8920000000, 0.9995000000}},
    {"quart-in", {0.0001000000, 0.0081000000, 0.0410062500, 0.2401000000, 0.8145062500}},
    {"quart-out", {0.3439000000, 0.7599000000, 0.9084937500, 0.9919000000, 0.9999937500}},
    {"quart-in-out", {0.0008000000, 0.0648000000, 0.3280500000, 0.9352000000, 0.9999500000}},
    {"sine-in", {0.0123116594, 0.1089934758, 0.2395940344, 0.5460095003, 0.9215409043}},
    {"sine-out", {0.1564344650, 0.4539904997, 0.6494480483, 0.8910065242, 0.9969173337}},
    {"sine-in-out", {0.0244717419, 0.2061073739, 0.4217827675, 0.7938926261, 0.9938441703}},
    {"expo-in", {0.0019531250, 0.0078125000, 0.0220970869, 0.1250000000, 0.7071067812}},
    {"expo-out", {0.5000000000, 0.8750000000, 0.9558058262, 0.9921875000, 0.9986189321}},
    {"expo-in-out", {0.0019531250, 0.0312500000, 0.2500000000, 0.9687500000, 0.9990234375}},
    {"circ-in", {0.0050125629, 0.0460607986, 0.1069714450, 0.2858571571, 0.6877501001}},
    {"circ-out", {0.4358898944, 0.7141428429, 0.8351646544, 0.9539392014, 0.9987492178}},
    {"circ-in-out", {0.0101020514, 0.1000000000, 0.2820550528, 0.9000000000, 0.9974937186}},
    {"back-in", {-0.0143142200, -0.0801995400, -0.0983884725, 0.0928677400, 0.7805912025}},
    {"back-out", {0.4088279800, 0.9071322600, 1.0652525775, 1.0801995400, 1.0039162525}},
    {"back-in-out", {-0.0375185520, -0.0788334840, 0.2594061652, 1.0788334840, 1.0111770928}},
    {"elastic-in", {0.0019531250, -0.0039062500, 0.0110485435, 0.1250000000, 0.3535533906}},
    {"elastic-out", {1.2500000000, 0.8750000000, 1.0441941738, 1.0039062500, 0.9993094660}},
    {"elastic-in-out", {0.0003391566, 0.0239388888, 0.0434120444, 0.9760611112, 0.9990234375}},
    {"bounce-in", {0.0118750000, 0.0693750000, 0.2498437500, 0.3193750000, 0.9810937500}},
    {"bounce-out", {0.0756250000, 0.6806250000, 0.8189062500, 0.9306250000, 0.9845312500}},
    {"bounce-in-out", {0.0300000000, 0.0450000000, 0.4621875000, 0.9550000000, 0.9940625000}},
};
// clang-format on

TEST(Easing, IsPenners) {
  for (const Row& row : kPenner) {
    const auto easing = parse_easing(row.name);
    ASSERT_TRUE(easing) << row.name;
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(easing->at(kTimes[i]), row.values[i], 1e-9) << row.name << " at " << kTimes[i];
    }
  }
}

TEST(Easing, BeginsAtNothingAndEndsAtAll) {
  for (const std::string& name : easing_names()) {
    const Easing easing = *parse_easing(name);
    for (const double before : {0.0, -0.0, -1.0, -HUGE_VAL, std::nan("")}) {
      EXPECT_EQ(easing.at(before), 0) << name;
    }
    for (const double after : {1.0, 1.5, HUGE_VAL}) EXPECT_EQ(easing.at(after), 1) << name;
    // Without a jump to speak of: expo begins at 2^-10.
    EXPECT_NEAR(easing.at(1e-9), 0, 1.1e-3) << name;
    EXPECT_NEAR(easing.at(1 - 1e-9), 1, 1.1e-3) << name;
  }
}

TEST(Easing, OutIsInMirroredAndInOutIsSymmetric) {
  for (const auto curve :
       {Curve::linear, Curve::smooth, Curve::smoother, Curve::quad, Curve::cubic, Curve::quart,
        Curve::sine, Curve::expo, Curve::circ, Curve::back, Curve::elastic, Curve::bounce}) {
    for (int i = 1; i < 100; ++i) {
      const double u = i / 100.0;
      EXPECT_NEAR((Easing{curve, Ease::out}.at(u)), 1 - (Easing{curve, Ease::in}.at(1 - u)), 1e-12);
      EXPECT_NEAR((Easing{curve, Ease::in_out}.at(u)), 1 - (Easing{curve, Ease::in_out}.at(1 - u)),
                  1e-12);
    }
    EXPECT_NEAR((Easing{curve, Ease::in_out}.at(0.5)), 0.5, 1e-12);
  }
}

TEST(Easing, RisesButForThoseThatSwing) {
  for (const std::string& name : easing_names()) {
    const Easing easing = *parse_easing(name);
    const bool swings = easing.curve == Curve::back || easing.curve == Curve::elastic;
    double least = 0, most = 1;
    for (int i = 1; i <= 1000; ++i) {
      const double now = easing.at(i / 1000.0), before = easing.at((i - 1) / 1000.0);
      if (!swings && easing.curve != Curve::bounce) {
        EXPECT_GE(now, before - 1e-12) << name << " at " << i;
      }
      least = std::min(least, now);
      most = std::max(most, now);
    }
    EXPECT_EQ(least < -1e-3 || most > 1 + 1e-3, swings) << name;
  }
}

TEST(Easing, SmoothOnesRestAtTheirEnds) {
  const double h = 1e-4;
  for (const Curve curve : {Curve::smooth, Curve::smoother}) {
    EXPECT_NEAR((Easing{curve}.at(h)) / h, 0, 1e-3);
  }
  EXPECT_NEAR((Easing{Curve::smoother}.at(h)) / (h * h), 0, 2e-3);
}

TEST(Easing, NamesReadBack) {
  for (const std::string& name : easing_names()) EXPECT_EQ(easing_name(*parse_easing(name)), name);
  EXPECT_EQ(easing_names().size(), 3u + 9u * 3u);
  EXPECT_EQ(easing_name(*parse_easing("cubic")), "cubic-in-out");
  for (const char* none : {"", "cubic-", "cubic-outin", "linear-in", "Cubic", "cubic in", "-in"}) {
    EXPECT_FALSE(parse_easing(none)) << none;
  }
}

}  // namespace
}  // namespace krok::timeline

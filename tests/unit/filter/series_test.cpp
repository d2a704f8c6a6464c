// If these fail, the filters are not those that the rest of the world calls by these names: another
// cutoff, another shape, another treatment of the ends. The reference figures come from
// scipy.signal 1.10.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "filter/smooth_clip.h"

namespace krok::filter {
namespace {

// t = numpy.arange(n); x = sin(0.3 t) + 0.5 cos(1.7 t) + 0.01 t^2
std::vector<double> wave(int n) {
  std::vector<double> x;
  for (int t = 0; t < n; ++t) {
    x.push_back(std::sin(0.3 * t) + 0.5 * std::cos(1.7 * t) + 0.01 * t * t);
  }
  return x;
}

void expect_at(const std::vector<double>& y, std::initializer_list<int> places,
               std::initializer_list<double> expected) {
  auto value = expected.begin();
  for (const int place : places) {
    // scipy's fits to high degrees are themselves no more exact than this.
    EXPECT_NEAR(y[static_cast<std::size_t>(place)], *value++, 1e-9) << "at " << place;
  }
}

std::vector<double> low_passed(const Butterworth& filter, double rate, int padding,
                               std::vector<double> x) {
  const auto sections = design(filter, rate);
  EXPECT_TRUE(sections.ok());
  if (sections) filter_both_ways(*sections, padding, x);
  return x;
}

// cut = arctan(tan(pi * 6 / 60) * (sqrt(2) - 1) ** (-1 / order)) * 60 / pi
// sosfiltfilt(butter(order / 2, cut, fs=60, output="sos"), x, padlen=12)
TEST(Butterworth, AgreesWithScipyForEveryOrder) {
  const auto places = {0, 1, 7, 20, 38, 39};
  expect_at(low_passed({6, 2}, 60, 12, wave(40)), places,
            {0.49999988209790736, 0.4212645377570232, 1.3665960827693746, 3.6934463061635787,
             13.442501185825042, 13.974439299041347});
  expect_at(low_passed({6, 4}, 60, 12, wave(40)), places,
            {0.49977925128152184, 0.5251568839794615, 1.3381260005122715, 3.7192031067157165,
             13.369171788003422, 13.973881377228873});
  expect_at(low_passed({6, 6}, 60, 12, wave(40)), places,
            {0.4987403136857697, 0.5645788330035686, 1.346450107064691, 3.721070034847925,
             13.336067168235399, 13.971023106686705});
  expect_at(low_passed({6, 8}, 60, 12, wave(40)), places,
            {0.4977620865830319, 0.5803001713339224, 1.3468297502638684, 3.7204667957713653,
             13.31648952622559, 13.959454136217467});
}

TEST(Butterworth, HalvesThePowerAtTheCutoffAndShiftsNothing) {
  for (const int order : {2, 4, 6, 8}) {
    for (const double hertz : {1.0, 6.0, 12.0}) {
      const double rate = 60, step = 2 * M_PI * hertz / rate;
      std::vector<double> x;
      for (int t = 0; t < 1200; ++t) x.push_back(std::sin(step * t));
      const auto y = low_passed({6, order}, rate, 60, x);
      // Amplitude and phase at the middle, over whole periods.
      std::complex<double> sum = 0;
      for (int t = 300; t < 900; ++t) {
        sum += y[static_cast<std::size_t>(t)] * std::polar(1.0, -step * t);
      }
      sum *= std::complex<double>(0, 2.0 / 600);
      EXPECT_NEAR(sum.imag(), 0, 1e-9) << order << " " << hertz;
      if (hertz == 6) {
        EXPECT_NEAR(sum.real(), std::sqrt(0.5), 1e-9) << order;
      }
      if (hertz == 1) {
        EXPECT_GT(sum.real(), 0.97) << order;
      }
      if (hertz == 12) {
        EXPECT_LT(sum.real(), 0.35) << order;
      }
    }
  }
}

TEST(Butterworth, ShortSeriesAndConstants) {
  for (const int n : {0, 1, 2, 3, 5}) {
    const std::vector<double> constant(static_cast<std::size_t>(n), 3.25);
    for (const double value : low_passed({6, 4}, 60, 30, constant)) EXPECT_NEAR(value, 3.25, 1e-12);
  }
  const auto two = low_passed({6, 4}, 60, 30, {1.0, 2.0});
  for (const double value : two) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(low_passed({6, 4}, 60, 30, {7.0}), std::vector<double>{7.0});
}

TEST(Butterworth, RefusesWhatCannotBe) {
  for (const double cutoff : {0.0, -1.0, 30.0, 31.0, std::nan(""), HUGE_VAL}) {
    const auto result = design({cutoff, 4}, 60);
    ASSERT_FALSE(result.ok()) << cutoff;
    EXPECT_EQ(result.error().code, "filter-cutoff");
  }
  for (const int order : {-2, 0, 1, 3, 10}) {
    const auto result = design({6, order}, 60);
    ASSERT_FALSE(result.ok()) << order;
    EXPECT_EQ(result.error().code, "filter-order");
  }
  EXPECT_TRUE(design({29.9, 8}, 60).ok());
  EXPECT_TRUE(design({0.01, 8}, 1000).ok());
}

// savgol_filter(x, window, degree)
TEST(SavitzkyGolay, AgreesWithScipyEndsIncluded) {
  const auto places = {0, 1, 4, 20, 35, 39};
  const auto smoothed = [](const SavitzkyGolay& filter) {
    auto x = wave(40);
    PolynomialSmoother(filter).smooth(x);
    return x;
  };
  expect_at(smoothed({9, 3}), places,
            {0.3364070159526314, 0.4023542463794626, 0.9770499443220978, 3.8266485474227556,
             11.498486851587622, 14.099999863415427});
  expect_at(smoothed({5, 2}), places,
            {0.47356531693750875, 0.22369712940380862, 1.3361807536701154, 3.4818603866585205,
             11.094436165979058, 13.923534279298147});
  expect_at(smoothed({21, 6}), places,
            {0.3975645804645157, 0.33663752050776524, 1.0252971098123296, 3.731315279087423,
             11.436623977321021, 14.025980905727947});
}

TEST(SavitzkyGolay, KeepsPolynomialsOfItsDegreeToTheEnds) {
  std::vector<double> x;
  for (int t = 0; t < 30; ++t) x.push_back(2 - 0.3 * t + 0.02 * t * t - 0.001 * t * t * t);
  auto y = x;
  PolynomialSmoother({11, 3}).smooth(y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(y[i], x[i], 1e-12);
}

TEST(SavitzkyGolay, LeavesWhatIsShorterThanTheWindow) {
  for (const int n : {0, 1, 2, 8}) {
    auto x = wave(n);
    PolynomialSmoother({9, 3}).smooth(x);
    EXPECT_EQ(x, wave(n));
  }
}

TEST(SavitzkyGolay, RefusesWhatCannotBe) {
  for (const int window : {-1, 0, 2, 8, 100'001}) {
    EXPECT_EQ(check(SavitzkyGolay{window, 1}).error().code, "filter-window") << window;
  }
  for (const int degree : {-1, 9, 13}) {
    EXPECT_EQ(check(SavitzkyGolay{9, degree}).error().code, "filter-degree") << degree;
  }
  EXPECT_TRUE(check(SavitzkyGolay{1, 0}).ok());
}

}  // namespace
}  // namespace krok::filter

// If these fail, numbers of captures come out other than they are printed, or what is no number is
// taken for one, only because a row is parsed by vectors.

#include "formats/bvh/number_kernel.h"

#include <fast_float/fast_float.h>
#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <string>
#include <vector>

#include "core/simd.h"

namespace krok::bvh {
namespace {

// A row with the surroundings that the kernel asks for.
struct Row {
  std::string text;
  std::size_t begin = 0, end = 0;

  explicit Row(const std::vector<std::string>& words, const std::string& between = " ")
      : text(std::string(number_kernel::kBefore - 1, '7') + "\n") {
    begin = text.size();
    for (const std::string& word : words) text += word + between;
    text += "\n";
    end = text.size();
    text += std::string(number_kernel::kAfter, '9');
  }

  bool parse(std::size_t count, std::size_t stride, std::vector<double>& values) const {
    std::vector<std::uint32_t> edges(number_kernel::edges_for(count));
    const auto parse_it = [&] {
      values.assign(count * stride, -1);
      return number_kernel::parse_plain_row(text.data() + begin, text.data() + end, count,
                                            values.data(), stride, edges.data());
    };
    const bool has_wide_vectors = limit_simd(Simd::avx2) == Simd::avx512;
    const bool parsed = parse_it();
    if (!has_wide_vectors || !parsed) {
      limit_simd(Simd::avx512);
      if (has_wide_vectors) {
        EXPECT_FALSE(parse_it());
      }
      return parsed;
    }
    const std::vector<double> narrow = values;
    limit_simd(Simd::avx512);
    EXPECT_TRUE(parse_it());
    EXPECT_EQ(narrow, values);
    return true;
  }
};

bool machine_has_vectors() {
  std::vector<double> values;
  return Row({"1"}).parse(1, 1, values);
}

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

double by_fast_float(const std::string& word) {
  double value = 0;
  const auto parsed = fast_float::from_chars(word.data(), word.data() + word.size(), value);
  EXPECT_TRUE(parsed.ec == std::errc() && parsed.ptr == word.data() + word.size()) << word;
  return value;
}

class Words {
 public:
  // [-]digits[.digits] of up to 16 characters.
  std::string plain() {
    const int length = 1 + below(16);
    std::string word;
    if (length > 1 && below(2) == 0) word = "-";
    const int digits = length - static_cast<int>(word.size());
    // One character for the dot, which has a digit on both sides.
    const int dot = digits >= 3 && below(4) != 0 ? 1 + below(digits - 2) : -1;
    for (int i = 0; i < digits; ++i) {
      word += i == dot ? '.' : static_cast<char>('0' + (below(5) == 0 ? 9 * below(2) : below(10)));
    }
    if (word.size() == 16 && word.find_first_of("-.") == std::string::npos) word[0] = '0';
    return word;
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

 private:
  std::mt19937 engine_{7};
};

TEST(NumberKernel, GivesTheBitsOfFastFloat) {
  if (!machine_has_vectors()) GTEST_SKIP() << "skipped: no vectors of 32 bytes on this machine";
  Words make;
  std::vector<double> values;
  for (int round = 0; round < 20000; ++round) {
    const auto count = static_cast<std::size_t>(1 + make.below(70));
    std::vector<std::string> words;
    for (std::size_t i = 0; i < count; ++i) words.push_back(make.plain());
    const Row row(words, round % 3 == 0 ? "\t " : " ");
    const std::size_t stride = round % 2 == 0 ? 1 : 16;
    ASSERT_TRUE(row.parse(count, stride, values)) << row.text;
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(bits(values[i * stride]), bits(by_fast_float(words[i]))) << words[i];
    }
  }
}

TEST(NumberKernel, GivesTheBitsOfFastFloatForPrintedNumbers) {
  if (!machine_has_vectors()) GTEST_SKIP() << "skipped: no vectors of 32 bytes on this machine";
  std::vector<double> values;
  for (const char* format : {"%.0f", "%.1f", "%.2f", "%.4f", "%.6f", "%.10f", "%.12f"}) {
    std::vector<std::string> words;
    for (int i = -2000; i <= 2000; ++i) {
      char word[40];
      std::snprintf(word, sizeof word, format, i * 0.0898765432101);
      if (std::string(word).size() <= 16) words.emplace_back(word);
    }
    const Row row(words);
    ASSERT_TRUE(row.parse(words.size(), 1, values));
    for (std::size_t i = 0; i < words.size(); ++i) {
      ASSERT_EQ(bits(values[i]), bits(by_fast_float(words[i]))) << words[i];
    }
  }
}

TEST(NumberKernel, TakesNumbersWithoutDigitsBeforeTheDot) {
  if (!machine_has_vectors()) GTEST_SKIP() << "skipped: no vectors of 32 bytes on this machine";
  std::vector<double> values;
  ASSERT_TRUE(Row({".5", "-.25", "-0", "-0.000"}).parse(4, 1, values));
  EXPECT_EQ(values[0], 0.5);
  EXPECT_EQ(values[1], -0.25);
  EXPECT_EQ(bits(values[2]), bits(-0.0));
  EXPECT_EQ(bits(values[3]), bits(-0.0));
}

TEST(NumberKernel, LeavesWhatIsNotPlainToTheParserOfAnyNumber) {
  const std::vector<std::string> others = {"-",
                                           ".",
                                           "-.",
                                           "5.",

                                           "1.2.3",
                                           "1..2",
                                           "--1",
                                           "1-",
                                           "1-2",
                                           "+1",
                                           "1e5",
                                           "1E-5",
                                           "nan",
                                           "inf",
                                           "1,5",
                                           "0x10",
                                           "1a",
                                           "a1",
                                           "1.5f",
                                           "1.-",
                                           "-1.-2",
                                           "..",
                                           "1.2.",
                                           "-1.",
                                           "\xFF",
                                           "\xCF",
                                           "1\xCF",
                                           "\x01",
                                           "1\x08",
                                           "/",
                                           ":",
                                           "1:2",
                                           "12345678901234567",
                                           "1.23456789012345678",
                                           "9999999999999999",
                                           "-123456.1234567890",
                                           std::string(1, '\0'),
                                           std::string("1\0", 2)};
  std::vector<double> values;
  for (const std::string& word : others) {
    for (const std::size_t place : {0u, 1u, 4u, 7u, 8u, 12u}) {
      std::vector<std::string> words(13, "1.5");
      words[place] = word;
      EXPECT_FALSE(Row(words).parse(13, 1, values)) << word;
    }
  }
}

TEST(NumberKernel, CountsTheWordsOfARow) {
  if (!machine_has_vectors()) GTEST_SKIP() << "skipped: no vectors of 32 bytes on this machine";
  std::vector<double> values;
  for (const std::size_t count : {1u, 7u, 8u, 9u, 31u, 32u, 33u, 200u}) {
    for (const char* word : {"0", "1.25", "-1234567.8901234"}) {
      const Row row(std::vector<std::string>(count, word), "  ");
      EXPECT_TRUE(row.parse(count, 1, values));
      EXPECT_FALSE(row.parse(count + 1, 1, values));
      if (count > 1) {
        EXPECT_FALSE(row.parse(count - 1, 1, values));
      }
    }
  }
}

}  // namespace
}  // namespace krok::bvh

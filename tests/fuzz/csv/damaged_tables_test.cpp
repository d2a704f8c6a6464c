// If these fail, a damaged table crashes a program or is read wrongly. Run with the address and
// undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "formats/csv/table.h"

namespace krok::csv {
namespace {

const std::string kTable =
    "\xEF\xBB\xBF"
    "time [s],\"na\"\"me\",x_mm,y\r\n0,\"a, b\",1.5,nan\r\n\r\n0.1,c,-2e3,\r\n"
    "0.2,\"two\nlines\",+3,inf\r\n";

// Reads a text and queries all of the table, which must be consistent.
void read_and_check(const std::string& text) {
  // An exact-size copy, so that the sanitizer detects reads past the end.
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  std::copy(text.begin(), text.end(), copy.get());
  const auto table = Table::read({copy.get(), text.size()}, "t.csv");
  if (!table.ok()) {
    EXPECT_EQ(table.error().code.rfind("csv-", 0), 0U);
    EXPECT_FALSE(table.error().message.empty());
    return;
  }
  ASSERT_GT(table->row_count(), 0U);
  ASSERT_FALSE(table->columns().empty());
  ASSERT_EQ(table->numeric().size(), table->columns().size());
  for (std::size_t c = 0; c < table->columns().size(); ++c) {
    EXPECT_EQ(table->texts(c).size(), table->row_count());
    const auto values = table->numbers(std::vector<std::size_t>{c});
    if (table->numeric()[c] != 0) {
      ASSERT_TRUE(values.ok()) << text;
    }
    if (!values.ok()) {
      EXPECT_EQ(values.error().code, "csv-number");
      EXPECT_GT(values.error().where.line, 0);
      continue;
    }
    ASSERT_EQ((*values)[0].size(), table->row_count());
    for (const double value : (*values)[0]) EXPECT_FALSE(std::isinf(value));
  }
}

TEST(DamagedTables, EveryTruncationIsHandled) {
  for (std::size_t size = 0; size <= kTable.size(); ++size) read_and_check(kTable.substr(0, size));
}

TEST(DamagedTables, AnyByteAnywhereIsHandled) {
  for (std::size_t at = 0; at < kTable.size(); ++at) {
    for (int byte = 0; byte < 256; ++byte) {
      std::string text = kTable;
      text[at] = static_cast<char>(byte);
      read_and_check(text);
    }
  }
}

TEST(DamagedTables, RandomTextIsHandled) {
  std::mt19937 random(7);
  const std::string letters = ",;\t\"\r\n 01.e-naif#[]()_s\xC3\xEF";
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    const auto size = random() % 60;
    while (text.size() < size) text += letters[random() % letters.size()];
    read_and_check(text);
  }
}

}  // namespace
}  // namespace krok::csv

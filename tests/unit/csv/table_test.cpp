// If these fail, a plot of a table shows other numbers than the file has, or a faulty table is
// drawn as if it were whole.

#include "formats/csv/table.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "formats/csv/csv_writer.h"
#include "support/test_scenes.h"

namespace krok::csv {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

Result<Table> read(std::string_view text) {
  return Table::read(text, "t.csv");
}

std::vector<std::string> labels_of(const Table& table) {
  std::vector<std::string> labels;
  for (const ColumnName& name : table.columns()) labels.push_back(name.label);
  return labels;
}

std::vector<double> column(const Table& table, std::size_t index) {
  const auto values = table.numbers(std::vector<std::size_t>{index});
  EXPECT_TRUE(values.ok());
  return values.ok() ? (*values)[0] : std::vector<double>();
}

void expect_fault(std::string_view text, const char* code, int line, int at) {
  const auto table = read(text);
  ASSERT_FALSE(table.ok()) << text;
  EXPECT_EQ(table.error().code, code) << text;
  EXPECT_EQ(table.error().where.file, "t.csv");
  EXPECT_EQ(table.error().where.line, line) << text;
  EXPECT_EQ(table.error().where.column, at) << text;
}

TEST(Table, ReadsWhatTheWriterWrote) {
  Clip clip;
  clip.skeleton.add("hips", Skeleton::kNoParent, {});
  clip.skeleton.add("arm, \"left\"", 0, {});
  clip.rate = 30;
  clip.resize(2);
  for (Quatf& orientation : clip.orientations) orientation = Quatf::Identity();
  clip.positions = {{0, 1, -2.5f}, {0.1f, -0.0f, 1e-7f}, {5e8f, 16777216, 3}, {1, 2, 3}};
  const std::string path = testing::TempDir() + "krok_table_" + std::to_string(getpid());
  {
    auto file = OutputFile::create(path);
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(write(frames_of(clip), *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }
  const auto input = InputFile::open(path);
  ASSERT_TRUE(input.ok());
  const auto table = Table::read(input->text(), path);
  ASSERT_TRUE(table.ok());
  EXPECT_THAT(labels_of(*table), ElementsAre("frame", "time", "joint", "x", "y", "z"));
  EXPECT_THAT(table->numeric(), ElementsAre(1, 1, 0, 1, 1, 1));
  ASSERT_EQ(table->row_count(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(static_cast<float>(column(*table, 3)[i]), clip.positions[i].x());
    EXPECT_EQ(static_cast<float>(column(*table, 5)[i]), clip.positions[i].z());
  }
  EXPECT_THAT(table->texts(2), ElementsAre("hips", "arm, \"left\"", "hips", "arm, \"left\""));
  std::filesystem::remove(path);
}

TEST(Table, TakesTheDelimiterThatTheHeaderHas) {
  for (const char* text : {"a,b\n1,2\n3,4\n", "a;b\r\n1;2\r\n3;4", "a\tb\r1\t2\r\r3\t4\r",
                           "\xEF\xBB\xBF"
                           "a,b\n\n 1 , 2\n3,4",
                           "# a,b\n1,2\n3,4\n", "\"a\",\"b\"\n\"1\",2\n3,\"4\"\n"}) {
    const auto table = read(text);
    ASSERT_TRUE(table.ok()) << text << table.error().message;
    EXPECT_THAT(labels_of(*table), ElementsAre("a", "b")) << text;
    EXPECT_THAT(column(*table, 0), ElementsAre(1, 3)) << text;
    EXPECT_THAT(column(*table, 1), ElementsAre(2, 4)) << text;
  }
}

TEST(Table, QuotedCellsHoldDelimitersQuotesAndLineEnds) {
  const auto table = read("name,v\n\"a, \"\"b\"\"\nc\",1\n\"\",2\n");
  ASSERT_TRUE(table.ok());
  EXPECT_THAT(table->texts(0), ElementsAre("a, \"b\"\nc", ""));
  EXPECT_THAT(column(*table, 1), ElementsAre(1, 2));
}

TEST(Table, WithoutAHeaderColumnsAreNumbered) {
  const auto table = read("0,1.5\n1,2.5\n");
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(table->row_count(), 2U);
  ASSERT_TRUE(table->find("2").ok());
  EXPECT_THAT(column(*table, *table->find("2")), ElementsAre(1.5, 2.5));
}

TEST(Table, CellsWithoutANumberAreGaps) {
  const auto table = read("a,b\n1,\n,NaN\n3,-inf\nna,7\n");
  ASSERT_TRUE(table.ok());
  const auto a = column(*table, 0), b = column(*table, 1);
  EXPECT_TRUE(std::isnan(a[1]) && std::isnan(a[3]));
  EXPECT_TRUE(std::isnan(b[0]) && std::isnan(b[1]) && std::isnan(b[2]));
  EXPECT_EQ(b[3], 7);
  EXPECT_THAT(table->numeric(), ElementsAre(1, 1));
}

TEST(Table, SaysWhereACellIsNoNumber) {
  const std::string text = "time_s,height [m]\n0,1\n0.1,\"1,25\"\n";
  const auto table = read(text);
  ASSERT_TRUE(table.ok());
  EXPECT_THAT(table->numeric(), ElementsAre(1, 0));
  const auto values = table->numbers(std::vector<std::size_t>{0, 1});
  ASSERT_FALSE(values.ok());
  EXPECT_EQ(values.error().code, "csv-number");
  EXPECT_EQ(values.error().where.line, 3);
  EXPECT_EQ(values.error().where.column, 6);
  EXPECT_THAT(values.error().message, HasSubstr("'1,25' in the column 'height [m]'"));
  EXPECT_THAT(values.error().hint, HasSubstr("decimal point"));
}

TEST(Table, SaysWhereItIsFaulty) {
  expect_fault("", "csv-empty", 0, 0);
  expect_fault(" \n\n", "csv-empty", 0, 0);
  expect_fault("a,b\n", "csv-empty", 0, 0);
  expect_fault("a,b\n1,2\n3\n", "csv-ragged", 3, 1);
  expect_fault("a,b\n1,2,3\n", "csv-ragged", 2, 1);
  expect_fault("a,b\n1,\"2\n3,4\n", "csv-quote", 2, 3);
  expect_fault("a,b\n\"1\"x,2\n", "csv-quote", 2, 4);
}

TEST(Table, ColumnsAreFoundByHeaderOrByLabel) {
  const auto table = read("time_s,knee [deg],knee (m)\n0,1,2\n");
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(*table->find("time"), 0U);
  EXPECT_EQ(*table->find("time_s"), 0U);
  EXPECT_EQ(*table->find("knee (m)"), 2U);
  EXPECT_THAT(table->find("knee").error().message, HasSubstr("several"));
  EXPECT_EQ(table->find("hip").error().code, "csv-column");
  EXPECT_THAT(table->find("hip").error().hint, HasSubstr("time_s, knee [deg]"));
}

TEST(Table, AMillionColumnsAndAHugeCellAreReadInTime) {
  std::string header, row;
  for (int i = 0; i < 1'000'000; ++i) {
    header += i == 0 ? "c0" : ",c" + std::to_string(i);
    row += i == 0 ? "0" : "," + std::to_string(i);
  }
  const std::string wide = header + "\n" + row + "\n" + row + "\n";
  const auto table = read(wide);
  ASSERT_TRUE(table.ok());
  EXPECT_THAT(table->columns(), SizeIs(1'000'000));
  EXPECT_THAT(column(*table, 999'999), ElementsAre(999'999, 999'999));

  const std::string huge = "a,b\n" + std::string(50'000'000, '7') + ",1\n";
  const auto long_cell = read(huge);
  ASSERT_TRUE(long_cell.ok());
  const auto values = long_cell->numbers(std::vector<std::size_t>{0});
  ASSERT_FALSE(values.ok());
  EXPECT_LT(values.error().message.size(), 200U);
}

TEST(ColumnName, HoldsAUnit) {
  const auto expect = [](const char* header, const char* label, const char* unit) {
    const ColumnName name = parse_column_name(header);
    EXPECT_EQ(name.header, header);
    EXPECT_EQ(name.label, label) << header;
    EXPECT_EQ(name.unit, unit) << header;
  };
  expect("time [s]", "time", "s");
  expect("time (s)", "time", "s");
  expect("time_s", "time", "s");
  expect("left_knee_deg", "left knee", "\u00B0");
  expect("knee [deg]", "knee", "\u00B0");
  expect("foot_speed_m_s", "foot speed", "m/s");
  expect("Speed_M_per_S", "Speed", "m/s");
  expect("error_mm", "error", "mm");
  expect("time", "time", "");
  expect("angle_min", "angle_min", "");  // the least, not minutes
  expect("frames_max", "frames_max", "");
  expect("_s", "_s", "");
  expect("()", "()", "");
  expect("(s)", "(s)", "");
  expect("", "", "");
}

}  // namespace
}  // namespace krok::csv

// What the reader works out for each BVH of the corpus against facts.tsv, which was drawn up from
// the files' text by another program with other criteria (feet on the ground, toes, a standing
// height) and by hand. Would break: a unit or an axis taken wrongly, a warning that is missing or
// too many, a rest frame overlooked.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "capture/convention_choice.h"
#include "core/numbers.h"
#include "formats/bvh/bvh_reader.h"
#include "roles/roles.h"
#include "support/this_build.h"

namespace krok {
namespace {

using Facts = std::map<std::string, std::string>;  // column to value

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

std::vector<Facts> read_facts() {
  std::ifstream in(test::source_folder() + "/tests/corpus/bvh/facts.tsv");
  std::vector<Facts> facts;
  std::vector<std::string> columns;
  for (std::string line; std::getline(in, line);) {
    const auto values = split(line, '\t');
    if (columns.empty()) {
      columns = values;
      continue;
    }
    EXPECT_EQ(values.size(), columns.size()) << line;
    Facts row;
    for (std::size_t i = 0; i < std::min(values.size(), columns.size()); ++i) {
      row[columns[i]] = values[i];
    }
    facts.push_back(std::move(row));
  }
  return facts;
}

bvh::Capture read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  auto capture = bvh::read(text.str(), path);
  EXPECT_TRUE(capture.ok()) << path << ": " << capture.error().message;
  return capture.ok() ? std::move(*capture) : bvh::Capture();
}

std::string warnings_of(const bvh::Capture& capture) {
  std::set<std::string> codes;
  for (const Diagnostic& told : capture.diagnostics) {
    if (told.severity == Severity::warning) codes.insert(told.code);
  }
  std::string list;
  for (const std::string& code : codes) list += (list.empty() ? "" : ",") + code;
  return list.empty() ? "-" : list;
}

void expect_facts(const Facts& facts, const bvh::Capture& capture) {
  const auto fact = [&](const char* column) { return facts.at(column); };
  const Skeleton& skeleton = capture.clip.skeleton;
  const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
  EXPECT_EQ(std::to_string(capture.clip.joint_count() - ends), fact("joints"));
  EXPECT_EQ(std::to_string(ends), fact("end_sites"));
  EXPECT_EQ(std::to_string(capture.clip.frame_count()), fact("frames"));
  EXPECT_EQ(std::to_string(capture.frames_announced), fact("announced"));
  EXPECT_NEAR(capture.clip.rate, *parse_finite(fact("rate")), 1e-3);
  EXPECT_EQ(capture.positions.choice, fact("positions"));
  const Conventions& found = capture.conventions;
  EXPECT_EQ(found.unit.name, fact("unit"));
  EXPECT_EQ(direction_name(found.up), fact("up"));
  EXPECT_EQ(direction_name(found.forward), fact("forward"));
  EXPECT_EQ(direction_name(found.reference_up), fact("reference_up"));
  EXPECT_EQ(direction_name(found.reference_forward), fact("reference_forward"));
  EXPECT_EQ(find_roles(skeleton).humanoid ? "yes" : "no", fact("humanoid"));
  EXPECT_EQ(capture.rest_frame_found ? "yes" : "no", fact("rest_frame"));
  EXPECT_EQ(warnings_of(capture), fact("warnings"));
  const auto exporter = recognise_exporter(skeleton, {});
  const std::string name = exporter ? exporter->name : "-";
  EXPECT_NE(name.find(fact("exporter")), std::string::npos) << name;
  // The tallest of some frames, hands above the head included.
  if (fact("humanoid") == "yes") {
    const double tall = *parse_finite(fact("extent")) * found.unit.metres;
    EXPECT_GT(tall, 1.1);
    EXPECT_LT(tall, 2.4);
  }
}

TEST(Facts, AreWhatTheReaderFinds) {
  const std::string folder = test::corpus_folder() + "/bvh/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no corpus at " << folder;
  const auto all = read_facts();
  ASSERT_EQ(all.size(), 89u);
  for (const Facts& facts : all) {
    SCOPED_TRACE(facts.at("file"));
    expect_facts(facts, read_file(folder + facts.at("file")));
  }
}

}  // namespace
}  // namespace krok

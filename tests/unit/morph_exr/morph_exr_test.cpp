// If these fail, morph targets come back from a texture changed, a shader that follows SPEC.md
// finds other vertices than those written, or a damaged texture crashes a tool or takes its memory.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>

#include "formats/morph_exr/morph_exr.h"

namespace krok::test {
namespace {

MorphSet set_of(int targets, int vertices, bool normals = true) {
  MorphSet set;
  set.vertex_count = vertices;
  for (int t = 0; t < targets; ++t) {
    set.names.push_back("target " + std::to_string(t) + " \xc5\x99");
    for (int v = 0; v < vertices; ++v) {
      const auto n = static_cast<float>(t * vertices + v);
      set.positions.emplace_back(n, -0.1f * n, 1e-30f * n);
      if (normals) set.normals.emplace_back(0.0f, 1.0f, 1e-7f * n);
    }
  }
  set.provenance.tool = "test";
  set.provenance.warnings = {"a \"word\""};
  return set;
}

std::string written(const MorphSet& set) {
  const auto path =
      std::filesystem::temp_directory_path() / ("krok-morph-" + std::to_string(getpid()) + ".exr");
  auto file = OutputFile::create(path.string());
  EXPECT_TRUE(file.ok());
  const Status status = morph_exr::write(set, *file);
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().message);
  EXPECT_TRUE(file->commit().ok());
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  return bytes;
}

Result<MorphSet> read(const std::string& bytes) {
  // A copy of exactly the size, so that a sanitizer sees a read past the end.
  const std::unique_ptr<char[]> copy(new char[bytes.size() + 1]);
  std::memcpy(copy.get(), bytes.data(), bytes.size());
  return morph_exr::read(std::as_bytes(std::span<const char>(copy.get(), bytes.size())));
}

TEST(MorphTexture, ComesBackBitForBit) {
  for (const auto& [targets, vertices] :
       {std::pair<int, int>{1, 1}, {1, 2}, {3, 7}, {2, 1000}, {52, 333}}) {
    for (const bool normals : {true, false}) {
      const MorphSet set = set_of(targets, vertices, normals);
      const auto back = read(written(set));
      ASSERT_TRUE(back.ok()) << back.error().message;
      EXPECT_EQ(back->names, set.names);
      EXPECT_EQ(back->vertex_count, vertices);
      EXPECT_EQ(back->positions, set.positions);
      EXPECT_EQ(back->normals, set.normals);
      EXPECT_EQ(back->provenance.warnings, set.provenance.warnings);
    }
  }
}

TEST(MorphTexture, TheSameTargetsGiveTheSameBytes) {
  EXPECT_EQ(written(set_of(3, 100)), written(set_of(3, 100)));
}

TEST(MorphTexture, WhatCannotBeWrittenIsSaid) {
  auto file =
      OutputFile::create((std::filesystem::temp_directory_path() / "krok-none.exr").string());
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(morph_exr::write(MorphSet(), *file).error().code, "exr-morphs");
  MorphSet twice = set_of(2, 3);
  twice.names[1] = twice.names[0];
  EXPECT_EQ(morph_exr::write(twice, *file).error().code, "morph-name");
  MorphSet short_one = set_of(2, 3);
  short_one.positions.pop_back();
  EXPECT_EQ(morph_exr::write(short_one, *file).error().code, "morph-shape");
}

TEST(MorphTexture, OtherFilesAreRefused) {
  for (const std::string& bytes : {std::string(), std::string("glTF"), std::string(1000, '\0')}) {
    const auto back = read(bytes);
    ASSERT_FALSE(back.ok());
    EXPECT_EQ(back.error().code, "exr-header");
    EXPECT_FALSE(back.error().hint.empty());
  }
}

TEST(MorphTexture, ASizeThatTheBytesCannotHoldIsRefused) {
  std::string bytes = written(set_of(1, 4));
  const std::size_t window = bytes.find("dataWindow");
  ASSERT_NE(window, std::string::npos);
  const std::int32_t large = 1'000'000;
  std::memcpy(bytes.data() + window + 11 + 6 + 4 + 8, &large, 4);
  std::memcpy(bytes.data() + window + 11 + 6 + 4 + 12, &large, 4);
  const auto back = read(bytes);
  ASSERT_FALSE(back.ok());
  EXPECT_EQ(back.error().code, "exr-header");
  EXPECT_NE(back.error().message.find("are not possible in"), std::string::npos)
      << back.error().message;
}

TEST(MorphTexture, EveryTruncationIsAnError) {
  const std::string whole = written(set_of(2, 40));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read(whole.substr(0, size)).ok()) << size;
  }
}

TEST(MorphTexture, EveryChangedByteIsSurvived) {
  const std::string whole = written(set_of(2, 40));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const unsigned value : {static_cast<unsigned>(whole[i]) ^ 1u,
                                 static_cast<unsigned>(whole[i]) ^ 0x80u, 0u, 0xFFu, 0x7Fu}) {
      std::string changed = whole;
      changed[i] = static_cast<char>(value);
      const auto back = read(changed);
      EXPECT_TRUE(!back.ok() || check(*back).ok());
    }
  }
}

TEST(MorphTexture, ManyChangedBytesAreSurvived) {
  std::mt19937 random(3);
  const std::string whole = written(set_of(5, 300));
  for (int round = 0; round < 500; ++round) {
    std::string changed = whole;
    for (int k = 0; k < 6; ++k) changed[random() % changed.size()] = static_cast<char>(random());
    const auto back = read(changed);
    EXPECT_TRUE(!back.ok() || check(*back).ok());
  }
}

}  // namespace
}  // namespace krok::test

// If these fail, a damaged material or character file crashes a program, or is read as data that
// cannot be written again. Run with the address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "formats/character/character_format.h"
#include "formats/material/material_format.h"
#include "golden/samples/samples.h"

namespace krok {
namespace {

template <typename Value>
void expect_told(const Result<Value>& found) {
  EXPECT_FALSE(found.error().code.empty());
  EXPECT_FALSE(found.error().message.empty());
  EXPECT_GT(found.error().where.line, 0) << found.error().message;
}

// What was read is written and read back unchanged. The text is an exact-size copy.
bool survives_as_material(const std::string& text) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  std::copy(text.begin(), text.end(), copy.get());
  const auto materials = material::read({copy.get(), text.size()});
  if (!materials) return expect_told(materials), false;
  EXPECT_TRUE(check(*materials).ok()) << text;
  const auto written = material::write(*materials);
  EXPECT_TRUE(written.ok()) << text;
  if (!written) return false;
  EXPECT_EQ(*material::write(*material::read(*written)), *written) << text;
  return true;
}

bool survives_as_character(const std::string& text) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  std::copy(text.begin(), text.end(), copy.get());
  const auto character = character_file::read({copy.get(), text.size()});
  if (!character) return expect_told(character), false;
  EXPECT_TRUE(check(*character).ok()) << text;
  const auto written = character_file::write(*character);
  EXPECT_TRUE(written.ok()) << text;
  if (!written) return false;
  EXPECT_EQ(*character_file::write(*character_file::read(*written)), *written) << text;
  return true;
}

struct Kind {
  std::string text;
  bool (*survives)(const std::string&);
};

std::vector<Kind> kinds() {
  return {{*material::write(samples::materials()), survives_as_material},
          {*character_file::write(samples::character()), survives_as_character}};
}

TEST(DamagedLooks, WholeOnesAreRead) {
  for (const Kind& kind : kinds()) EXPECT_TRUE(kind.survives(kind.text));
}

TEST(DamagedLooks, EveryTruncationIsRefused) {
  for (const Kind& kind : kinds()) {
    for (std::size_t size = 0; size + 1 < kind.text.size(); ++size) {
      EXPECT_FALSE(kind.survives(kind.text.substr(0, size))) << size;
    }
  }
}

TEST(DamagedLooks, OtherBytesAnywhereAreHandled) {
  for (const Kind& kind : kinds()) {
    for (std::size_t at = 0; at < kind.text.size(); ++at) {
      for (const char byte : {'\0', '"', '{', ']', ',', '-', '9', 'e', '\\', '.', '/', '\xFF'}) {
        std::string text = kind.text;
        text[at] = byte;
        kind.survives(text);
      }
    }
  }
}

TEST(DamagedLooks, PiecesMovedAboutAreHandled) {
  std::mt19937 random(7);
  for (const Kind& kind : kinds()) {
    for (int round = 0; round < 2000; ++round) {
      std::string text = kind.text;
      const std::size_t from = random() % text.size();
      const std::string piece = text.substr(from, 1 + random() % 60);
      if (random() % 2 == 0) text.erase(from, piece.size());
      text.insert(random() % (text.size() + 1), piece);
      kind.survives(text);
    }
  }
}

}  // namespace
}  // namespace krok

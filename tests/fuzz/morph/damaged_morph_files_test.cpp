// If these fail, a damaged shape, weights file or key shapes file crashes a program, or is read as
// inconsistent data. Run with the address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "formats/key_shapes/key_shapes.h"
#include "formats/obj/obj_reader.h"
#include "formats/weights/weights.h"

namespace krok {
namespace {

const std::vector<std::string> kTargets = {"smile", "blink"};

const std::string kObj =
    "o a\nv 0 0 0\nv 1.5 -2e1 3\nv 0 1 0\nv 1 1 1\nvt .5 1\nvn 0 0 1\nusemtl m\n"
    "f 1/1/1 2/1/1 3/1/1 4/1/1\ng b\\\n c\nf -1 -2 1\nl 1 2\n# end\n";
const std::string kKeys =
    "{\"schema\":\"krok.weights/1\",\"rate\":30,\"between\":\"smooth\",\"tension\":0.5,\"curves\":"
    "[{\"target\":\"smile\",\"keys\":[[0,0],[\"9f\",1.5],[\"1.5s\",-1]]},"
    "{\"target\":\"blink\",\"between\":\"monotone\",\"keys\":[[1,0]]}]}";
const std::string kTable = "frame,time,smile,\"blink\"\n0,0,1,0\n1,0.5,,1e-2\n2,1,nan,-3\n";
const std::string kShapes =
    "{\"schema\":\"krok.key-shapes/1\",\"rate\":30,\"between\":\"hermite\",\"tension\":0.5,"
    "\"keys\":[{\"time\":0,\"shape\":\"a.obj\"},{\"time\":\"9f\",\"shape\":\"b/c.glb\"}]}";

// An exact-size copy, so that the sanitizer detects reads past the end.
struct Copy {
  explicit Copy(const std::string& text) : bytes(new char[text.size()]), size(text.size()) {
    std::copy(text.begin(), text.end(), bytes.get());
  }
  std::string_view view() const { return {bytes.get(), size}; }
  std::unique_ptr<char[]> bytes;
  std::size_t size;
};

template <typename T>
bool has_error(const Result<T>& result) {
  if (result.ok()) return false;
  EXPECT_FALSE(result.error().code.empty());
  EXPECT_FALSE(result.error().message.empty());
  return true;
}

bool read_obj(const std::string& text) {
  const Copy copy(text);
  const auto shape = obj::read(copy.view(), "s.obj");
  if (has_error(shape)) return false;
  EXPECT_TRUE(check(shape->model).ok()) << text;
  return true;
}

bool read_weights(const std::string& text) {
  const Copy copy(text);
  const auto file = weights::read(copy.view(), "w", kTargets);
  if (has_error(file)) return false;
  EXPECT_TRUE(check(file->curves).ok()) << text;
  // Long ones are valid, but too slow for this test.
  if (file->curves.duration() > 1000 || file->rate.value_or(30) > 1000) return true;
  MorphSet morphs;
  morphs.names = kTargets;
  EXPECT_TRUE(weights::read_weights(copy.view(), "w", morphs).ok()) << text;
  return true;
}

bool read_shapes(const std::string& text) {
  const Copy copy(text);
  const auto file = key_shapes::read(copy.view());
  if (has_error(file)) return false;
  EXPECT_FALSE(file->times.empty());
  EXPECT_EQ(file->times.size(), file->shapes.size());
  for (std::size_t i = 1; i < file->times.size(); ++i) {
    EXPECT_GT(file->times[i], file->times[i - 1]) << text;
  }
  return true;
}

using Read = bool (*)(const std::string&);
class DamagedMorphFiles : public testing::TestWithParam<std::pair<const std::string*, Read>> {
 protected:
  const std::string& whole() const { return *GetParam().first; }
  bool read(const std::string& text) const { return GetParam().second(text); }
};

TEST_P(DamagedMorphFiles, TheWholeOneIsRead) {
  EXPECT_TRUE(read(whole()));
}

TEST_P(DamagedMorphFiles, TruncationsAreHandled) {
  for (std::size_t size = 0; size < whole().size(); ++size) (void)read(whole().substr(0, size));
}

TEST_P(DamagedMorphFiles, OtherBytesAnywhereAreHandled) {
  int refused = 0;
  for (std::size_t at = 0; at < whole().size(); ++at) {
    for (const char byte : {'\0', '"', '{', ']', ',', '-', '9', 'e', '\\', '\n', '/', '\xFF'}) {
      std::string text = whole();
      text[at] = byte;
      refused += read(text) ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 50);
}

TEST_P(DamagedMorphFiles, RandomPiecesAreHandled) {
  std::mt19937 random(17);
  for (int i = 0; i < 4000; ++i) {
    std::string text = whole();
    for (unsigned k = 0; k < 1 + random() % 3; ++k) {
      const std::size_t from = random() % text.size(), size = random() % 20;
      const std::string piece = whole().substr(random() % whole().size(), random() % 20);
      text.replace(from, std::min(size, text.size() - from), piece);
    }
    (void)read(text);
  }
}

INSTANTIATE_TEST_SUITE_P(All, DamagedMorphFiles,
                         testing::Values(std::pair(&kObj, Read(read_obj)),
                                         std::pair(&kKeys, Read(read_weights)),
                                         std::pair(&kTable, Read(read_weights)),
                                         std::pair(&kShapes, Read(read_shapes))));

}  // namespace
}  // namespace krok

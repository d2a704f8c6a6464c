// Arrays of numpy. If these fail, numbers come out of a file that numpy does not see in it, a
// pickle is opened, or a header that lies takes memory or is read beyond its end.

#include "formats/npy/npy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/npy/array_reader.h"
#include "formats/npy/npz_motion.h"
#include "formats/registry/registry.h"
#include "formats/zip/zip_archive.h"

namespace {

using namespace std::string_literals;
using krok::npy::Array;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

krok::Result<Array> parsed(const std::string& file) {
  const auto bytes = bytes_of(file);
  return krok::npy::parse({bytes.begin(), bytes.end()});
}

std::string npy_file(const std::string& header, const std::string& data, char version = 1) {
  const auto length = static_cast<char>(header.size());
  const std::string size = version == 1 ? ""s + length + '\0' : ""s + length + "\0\0\0"s;
  return "\x93NUMPY"s + version + '\0' + size + header + data;
}

std::string header_of(const std::string& type, const std::string& shape, bool fortran = false) {
  return "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
         ", 'shape': " + shape + ", }\n";
}

std::vector<double> numbers(const std::string& type, const std::string& shape,
                            const std::string& data, bool fortran = false, char version = 1) {
  const std::string file = npy_file(header_of(type, shape, fortran), data, version);
  const auto array = parsed(file);
  EXPECT_TRUE(array.ok()) << array.error().message;
  return array.ok() ? array->numbers() : std::vector<double>();
}

std::string error_code(const std::string& file) {
  const auto array = parsed(file);
  EXPECT_FALSE(array.ok());
  return array.ok() ? "" : array.error().code;
}

TEST(Npy, elements_of_all_sizes_and_orders) {
  using Numbers = std::vector<double>;
  EXPECT_EQ(numbers("<f4", "(1,)", "\0\0\x80\x3f"s), Numbers{1});
  EXPECT_EQ(numbers(">f4", "(1,)", "\x3f\x80\0\0"s, false, 2), Numbers{1});
  EXPECT_EQ(numbers("<f2", "(3,)", "\0\x3c\1\0\0\xfc"s, false, 3),
            (Numbers{1, std::ldexp(1, -24), -HUGE_VAL}));
  EXPECT_EQ(numbers("<i2", "(2,)", "\xff\xff\2\0"s), (Numbers{-1, 2}));
  EXPECT_EQ(numbers("|u1", "(2,)", "\xff\2"s), (Numbers{255, 2}));
  EXPECT_EQ(numbers("|b1", "(2,)", "\1\0"s), (Numbers{1, 0}));
  EXPECT_EQ(numbers("|u1", "()", "\7"s), Numbers{7});
  EXPECT_EQ(numbers("|u1", "(2, 3)", "\1\4\2\5\3\6"s, true), (Numbers{1, 2, 3, 4, 5, 6}));
}

TEST(Npy, a_part_in_either_order_of_axes) {
  for (const bool fortran : {false, true}) {
    const std::string file =
        npy_file(header_of("|u1", "(2, 3)", fortran), fortran ? "\1\4\2\5\3\6" : "\1\2\3\4\5\6");
    const auto array = parsed(file);
    ASSERT_TRUE(array.ok());
    EXPECT_EQ(array->numbers(2, 3), (std::vector<double>{3, 4, 5}));
    EXPECT_EQ(array->numbers(5), std::vector<double>{6});
  }
}

TEST(Npy, objects_are_never_opened) {
  EXPECT_EQ(error_code(npy_file(header_of("|O", "(1,)"), "\x80\4cos\nsystem\n.")), "npy-objects");
}

TEST(Npy, shapes_that_lie_are_refused) {
  for (const char* shape : {"(2,)", "(4294967296, 4294967296, 4294967296)",
                            "(18446744073709551615,)", "(0,)", "(-1,)", "(1", "(1,,)", "1"}) {
    EXPECT_EQ(error_code(npy_file(header_of("<f4", shape), "\0\0\x80\x3f"s)), "npy-damaged")
        << shape;
  }
  EXPECT_EQ(error_code("\x93NUMPY\1\0\xff\xff{"s), "npy-damaged");
  EXPECT_EQ(error_code(npy_file(header_of("<c8", "(1,)"), "12345678")), "npy-type");
  EXPECT_EQ(error_code(npy_file(
                "{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1,), }", "1234")),
            "npy-type");
}

// 40 MB of zeros in 40 KB.
TEST(Npy, a_bomb_is_refused) {
  const std::string data(std::size_t{40} << 20, '\0');
  const std::string file = npy_file(header_of("|u1", "(41943040,)"), data);
  const auto inside = bytes_of(file);
  const krok::zip::FileToPack bomb = {
      "positions.npy", inside.size(), [&inside, done = std::size_t{0}](auto bytes) mutable {
        std::ranges::copy(inside.subspan(done, bytes.size()), bytes.begin());
        done += bytes.size();
        return krok::Status();
      }};
  const auto packed = krok::zip::pack(std::span(&bomb, 1));
  ASSERT_TRUE(packed.ok());
  ASSERT_LT(packed->size(), 100U << 10);
  EXPECT_EQ(krok::registry::kind_of_content(*packed), krok::registry::Kind::npz);
  const auto read = krok::npy::read(*packed, "bomb.npz");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, "file-too-large");
}

TEST(Npy, texts_and_numbers_come_back) {
  const std::vector<std::string> names = {"Hips", "Č\U0001F9B6", ""};
  const std::vector<double> values = {1, -2.5};
  const std::vector<std::pair<std::string, Array>> arrays = {
      {"names", krok::npy::array_of_texts(names)}, {"x", krok::npy::array_of(values, {2, 1})}};
  const auto file = krok::npy::write(arrays);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(*file, *krok::npy::write(arrays));
  const auto read = krok::npy::Arrays::open(*file);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->read("names")->texts(), names);
  EXPECT_EQ(read->read("x")->numbers(), values);
  EXPECT_EQ(read->read("x")->shape, (std::vector<std::size_t>{2, 1}));
}

std::string hint_for(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  const auto file = krok::npy::write(krok::npy::array_of(std::vector<float>(count, 1), shape));
  const auto read = krok::npy::read(file, "a.npy");
  EXPECT_FALSE(read.ok());
  return read.ok() ? "" : read.error().hint;
}

TEST(Npy, axes_in_another_order_are_explained) {
  EXPECT_NE(hint_for({40, 3, 22}).find("moveaxis(a, 1, -1)"), std::string::npos);
  EXPECT_NE(hint_for({22, 40, 3}).find("swapaxes"), std::string::npos);
  EXPECT_NE(hint_for({2, 22, 3, 40}).find("transpose(0, 3, 1, 2)"), std::string::npos);
  EXPECT_NE(hint_for({40, 66}).find("reshape(-1, 22, 3)"), std::string::npos);
  EXPECT_NE(hint_for({22, 3, 40}).find("transpose(2, 0, 1)"), std::string::npos);
  EXPECT_NE(hint_for({22, 3}).find("a[None]"), std::string::npos);
  EXPECT_NE(hint_for({40, 263}).find("recover_from_ric()"), std::string::npos);
  EXPECT_NE(hint_for({40, 17, 3}).find("h36m17 or coco17"), std::string::npos);
  EXPECT_NE(hint_for({40, 22, 4}).find("a[..., :3]"), std::string::npos);
}

// Landmarks that begin at the hips: half of the body is below 0.
TEST(Npy, feet_far_below_the_ground_lead_to_on_ground) {
  const auto named = krok::named_skeleton("smpl22");
  ASSERT_TRUE(named.has_value());
  for (const float height : {0.0F, 1.0F}) {
    const auto arranged = krok::arrange(*named);
    ASSERT_TRUE(arranged.ok());
    std::vector<float> values;
    for (int f = 0; f < 10; ++f) {
      for (const auto& joint : named->joints) {
        const int j = arranged->skeleton.find(joint.name);
        const krok::Vec3& place = arranged->skeleton.reference[std::size_t(j)].position;
        for (const int axis : {0, 1, 2}) {
          values.push_back(static_cast<float>(place[axis]) + (axis == 1 ? height : 0));
        }
      }
    }
    const auto file = krok::npy::write(krok::npy::array_of(values, {10, 22, 3}));
    const auto read = krok::npy::read(file, "a.npy");
    ASSERT_TRUE(read.ok()) << read.error().message;
    const bool warned = std::ranges::any_of(read->diagnostics, [](const krok::Diagnostic& d) {
      return d.code == "npy-ground" && d.hint.find("--on-ground") != std::string::npos;
    });
    EXPECT_EQ(warned, height == 0);
  }
}

TEST(Npy, published_orders_make_people) {
  for (const std::string& name : krok::skeleton_names()) {
    const auto arranged = krok::arrange(*krok::named_skeleton(name));
    ASSERT_TRUE(arranged.ok()) << name << ": " << arranged.error().message;
    EXPECT_TRUE(check(arranged->skeleton).ok()) << name;
    // The robot has no head.
    EXPECT_EQ(arranged->roles.humanoid, name != "g1_34") << name;
    const int head = arranged->roles.joint(krok::Role::head);
    EXPECT_TRUE(head < 0 || arranged->skeleton.names[std::size_t(head)] != "nose") << name;
  }
}

}  // namespace

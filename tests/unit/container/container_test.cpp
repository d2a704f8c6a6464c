// If these fail, Krok's files are not laid out as SPEC.md says, cannot be written to a pipe, or a
// file that cannot be read gets a message that does not help.

#include "formats/container/container.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <thread>

#include "formats/anim/anim.h"
#include "formats/container/sections.h"
#include "golden/samples/samples.h"

namespace krok {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr ContainerFormat kFormat = {registry::Kind::anim, registry::kAnimMagic, 1,
                                     kFlagFourComponents};

Bytes bytes_from(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

template <typename T>
T at(const Bytes& file, std::size_t offset) {
  T value;
  std::memcpy(&value, &file[offset], sizeof value);
  return value;
}

template <typename T>
void set(Bytes& file, std::size_t offset, T value) {
  std::memcpy(&file[offset], &value, sizeof value);
}

Status write_two_sections(OutputFile& file) {
  ContainerWriter writer(file, kFormat, 1, 2);
  if (Status status = writer.section("FIRST", bytes_from("abc")); !status) return status;
  if (Status status = writer.begin("SECONDLY"); !status) return status;
  for (const char* part : {"de", "", "fgh"}) {
    if (Status status = writer.append(bytes_from(part)); !status) return status;
  }
  return writer.finish();
}

Bytes two_sections() {
  return samples::bytes_of(write_two_sections);
}

Error error_of(const Bytes& file) {
  const auto opened = ContainerReader::open(file, kFormat);
  EXPECT_FALSE(opened.ok());
  return opened.ok() ? Error() : opened.error();
}

// Would fail if a long file were in memory as a whole once, while its checksum is taken.
TEST(Container, LongFilesAreReleasedAsTheyAreHashed) {
  const Bytes large(std::size_t{20} << 20);
  const Bytes file = samples::bytes_of([&](OutputFile& out) -> Status {
    ContainerWriter writer(out, kFormat, 0, 1);
    if (Status status = writer.section("LARGE", large); !status) return status;
    return writer.finish();
  });
  std::vector<std::size_t> released;
  ASSERT_TRUE(
      ContainerReader::open(file, kFormat, [&](std::size_t end) { released.push_back(end); }).ok());
  ASSERT_GE(released.size(), 3U);
  EXPECT_TRUE(std::ranges::is_sorted(released));
  EXPECT_EQ(released.back(), file.size());
}

TEST(Container, IsLaidOutAsSpecified) {
  const Bytes file = two_sections();
  EXPECT_EQ(std::memcmp(file.data(), "KROKANIM", 8), 0);
  EXPECT_EQ(at<std::uint32_t>(file, 8), 1u) << "version";
  EXPECT_EQ(at<std::uint32_t>(file, 12), 1u) << "flags";
  EXPECT_EQ(at<std::uint64_t>(file, 16), file.size());
  EXPECT_EQ(at<std::uint32_t>(file, 32), 2u) << "sections";
  EXPECT_EQ(std::memcmp(&file[64], "FIRST\0\0\0", 8), 0);
  EXPECT_EQ(at<std::uint64_t>(file, 72), 128u);
  EXPECT_EQ(at<std::uint64_t>(file, 80), 3u);
  EXPECT_EQ(std::memcmp(&file[96], "SECONDLY", 8), 0);
  EXPECT_EQ(at<std::uint64_t>(file, 104), 192u);
  EXPECT_EQ(at<std::uint64_t>(file, 112), 5u);
  EXPECT_EQ(file.size(), 197u);
  EXPECT_EQ(std::memcmp(&file[128], "abc\0", 4), 0);
  EXPECT_EQ(std::memcmp(&file[192], "defgh", 5), 0);

  Bytes hashed(file.begin() + 128, file.end());
  hashed.insert(hashed.end(), file.begin(), file.begin() + 128);
  std::fill_n(hashed.begin() + static_cast<std::ptrdiff_t>(file.size()) - 128 + 24, 8,
              std::byte{0});
  EXPECT_EQ(at<std::uint64_t>(file, 24), xxh3(hashed));
}

TEST(Container, SectionsComeBack) {
  const Bytes file = two_sections();
  const auto container = ContainerReader::open(file, kFormat);
  ASSERT_TRUE(container.ok());
  EXPECT_EQ(container->flags(), 1u);
  EXPECT_EQ(container->section("SECONDLY")->bytes.size(), 5u);
  EXPECT_EQ(container->section("SECONDLY")->offset, 192u);
  EXPECT_FALSE(container->find("THIRD").has_value());
  EXPECT_EQ(container->section("THIRD").error().code, "container-section");
  EXPECT_TRUE(container->section("FIRST", 3, 1).ok());
  EXPECT_FALSE(container->section("FIRST", 1, 2).ok());
  EXPECT_FALSE(container->section("FIRST", 0x5555555555555556, 3).ok()) << "the product overflows";
  EXPECT_EQ(container->section("FIRST", 4, 1).error().where.byte_offset, 128);
}

TEST(Container, SaysWhatAForeignFileSeemsToBe) {
  const Error bvh = error_of(bytes_from("HIERARCHY\nROOT Hips\n"));
  EXPECT_EQ(bvh.code, "container-magic");
  EXPECT_EQ(bvh.message, "is a BVH text file, not a .anim file");
  EXPECT_EQ(bvh.hint, "import it with krok-import");
  EXPECT_EQ(bvh.where.byte_offset, 0);
  EXPECT_THAT(error_of({}).message, HasSubstr("an empty file"));
  EXPECT_THAT(error_of(samples::bytes_of(samples::model())).message, HasSubstr("a Krok model"));
  EXPECT_THAT(error_of(bytes_from("glTF\2\0\0\0")).message, HasSubstr("a binary glTF file"));
}

TEST(Container, SaysThatAFileIsNewer) {
  Bytes file = two_sections();
  set<std::uint32_t>(file, 8, 2);
  samples::repair_header(file);
  const Error error = error_of(file);
  EXPECT_EQ(error.code, "container-version");
  EXPECT_THAT(error.message, HasSubstr("version 2"));
  EXPECT_EQ(error.hint, "use a newer Krok");
  EXPECT_EQ(error.where.byte_offset, 8);
}

TEST(Container, SaysThatAFileIsCut) {
  Bytes file = two_sections();
  file.resize(150);
  EXPECT_EQ(error_of(file).code, "container-truncated");
  EXPECT_THAT(error_of(file).message, HasSubstr("has 150 bytes, expected 197"));
  file.resize(20);
  EXPECT_EQ(error_of(file).code, "container-truncated");
}

TEST(Container, SaysThatAFileIsDamaged) {
  Bytes file = two_sections();
  file[195] = std::byte{'x'};
  const Error error = error_of(file);
  EXPECT_EQ(error.code, "container-checksum");
  EXPECT_EQ(error.where.byte_offset, 24);
  EXPECT_FALSE(error.hint.empty());
}

TEST(Container, RefusesTablesThatDoNotHold) {
  const auto changed = [](const std::function<void(Bytes&)>& change) {
    Bytes file = two_sections();
    change(file);
    samples::repair_header(file);
    return error_of(file);
  };
  const auto flags = changed([](Bytes& file) { set<std::uint32_t>(file, 12, 6); });
  EXPECT_EQ(flags.code, "container-flags");
  const auto unaligned = changed([](Bytes& file) { set<std::uint64_t>(file, 104, 193); });
  EXPECT_EQ(unaligned.code, "container-table");
  EXPECT_EQ(unaligned.where.byte_offset, 96) << "the entry";
  const auto overlapping = changed([](Bytes& file) { set<std::uint64_t>(file, 80, 65); });
  EXPECT_THAT(overlapping.message, HasSubstr("overlaps what is before it"));
  const auto in_table = changed([](Bytes& file) { set<std::uint64_t>(file, 72, 64); });
  EXPECT_THAT(in_table.message, HasSubstr("overlaps what is before it"));
  const auto outside = changed([](Bytes& file) { set<std::uint64_t>(file, 112, 6); });
  EXPECT_THAT(outside.message, HasSubstr("exceeds the file"));
  const auto overflowing =
      changed([](Bytes& file) { set<std::uint64_t>(file, 112, 0xFFFFFFFFFFFFFF40); });
  EXPECT_THAT(overflowing.message, HasSubstr("exceeds the file"));
  const auto twice = changed([](Bytes& file) { std::memcpy(&file[96], "FIRST\0\0\0", 8); });
  EXPECT_THAT(twice.message, HasSubstr("section FIRST appears twice"));
  const auto nameless = changed([](Bytes& file) { file[64] = std::byte{0}; });
  EXPECT_EQ(nameless.code, "container-table");
}

TEST(Container, IgnoresSectionsThatItDoesNotKnow) {
  Bytes file = two_sections();
  std::memcpy(&file[64], "NOVELTY\0", 8);
  samples::repair_header(file);
  const auto container = ContainerReader::open(file, kFormat);
  ASSERT_TRUE(container.ok());
  EXPECT_TRUE(container->section("SECONDLY").ok());
}

TEST(Container, WritesTheSameBytesToAPipe) {
  const std::string path = testing::TempDir() + "krok-pipe-" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  Bytes received;
  std::thread reader([&] {
    const auto file = InputFile::open(path);
    if (file) received.assign(file->bytes().begin(), file->bytes().end());
  });
  auto file = OutputFile::create(path);
  ASSERT_TRUE(file.ok());
  EXPECT_FALSE(file->can_overwrite());
  EXPECT_TRUE(write_two_sections(*file).ok());
  EXPECT_TRUE(file->commit().ok());
  reader.join();
  std::filesystem::remove(path);
  EXPECT_EQ(received, two_sections());
}

TEST(Container, AFullDiskIsAnError) {
  auto file = OutputFile::create("/dev/full");
  if (!file) GTEST_SKIP() << "skipped: no /dev/full";
  Status status = write_two_sections(*file);
  if (status) status = file->commit();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "file-unwritable");
}

// --- sections ---

TEST(Sections, ProvenanceComesBackWithOddTexts) {
  Clip clip = samples::clip();
  clip.provenance.conversions = {"", "line\nbreak\t\"quoted\" \\ \xE2\x82\xAC"};
  const auto back = anim::read(samples::bytes_of(clip));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->provenance.conversions, clip.provenance.conversions);
}

TEST(Sections, AFileNameThatIsNoUtf8DoesNotStopTheWriter) {
  Clip clip = samples::clip();
  clip.provenance.sources = {{"caf\xE9.bvh", ""}};
  const auto back = anim::read(samples::bytes_of(clip));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->provenance.sources[0].name, "caf\xEF\xBF\xBD.bvh");
}

Error error_with_provenance(std::string_view text) {
  Bytes file = samples::bytes_of(samples::clip());
  const auto meta = static_cast<std::size_t>(at<std::uint64_t>(file, 64 + 5 * 32 + 8));
  file.resize(meta);
  const Bytes replacement = bytes_from(text);
  file.insert(file.end(), replacement.begin(), replacement.end());
  set<std::uint64_t>(file, 64 + 5 * 32 + 16, replacement.size());
  samples::repair_header(file);
  const auto read = anim::read(file);
  return read ? Error() : read.error();
}

TEST(Sections, ProvenanceThatIsNoneIsAnError) {
  EXPECT_EQ(error_with_provenance("").code, "") << "an empty section is allowed";
  EXPECT_EQ(error_with_provenance("{}").code, "");
  EXPECT_EQ(error_with_provenance(R"({"future": [1, {}], "tool": "x"})").code, "");
  for (const char* bad :
       {"{", "[]", "nonsense", R"({"tool": 3})", R"({"warnings": "x"})", R"({"sources": ["x"]})",
        R"({"options": [{"name": []}]})", "{\"tool\": \"\xFF\"}", R"({"conversions": [1]})"}) {
    EXPECT_EQ(error_with_provenance(bad).code, "container-provenance") << bad;
  }
  EXPECT_EQ(error_with_provenance(std::string(100000, '[')).code, "container-provenance");
}

TEST(Sections, Utf8IsCheckedAsTheStandardSays) {
  for (const char* good : {"", "Hips", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x95\xBA",
                           "\xEF\xBF\xBD", "\xED\x9F\xBF", "\xF4\x8F\xBF\xBF", "a:b#c 'd'"}) {
    EXPECT_TRUE(is_storable_text(good)) << good;
  }
  for (const char* bad : {"\x80", "\xC3", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
                          "\xF5\x80\x80\x80", "\xF4\x90\x80\x80", "\xE2\x82", "\xFF", "a\xC3z"}) {
    EXPECT_FALSE(is_storable_text(bad)) << bad;
  }
  EXPECT_FALSE(is_storable_text(std::string_view("a\0b", 3)));
}

TEST(Sections, NamesThatAFileCannotHoldAreRefused) {
  Clip clip = samples::clip();
  const auto refused = [&](std::string name) {
    clip.skeleton.names[1] = std::move(name);
    auto file = OutputFile::create("/dev/null");
    const Status status = anim::write(clip, {}, *file);
    return status.ok() ? std::string() : status.error().code;
  };
  EXPECT_EQ(refused("Kn\xE4"), "skeleton-name");
  EXPECT_EQ(refused(std::string("a\0b", 3)), "skeleton-name");
  EXPECT_EQ(refused(""), "skeleton-name");
  EXPECT_EQ(refused("Hips"), "skeleton-name") << "twice";
  EXPECT_EQ(refused("Knee"), "");
}

}  // namespace
}  // namespace krok

// If these fail, scenes as shops hand them out, zipped with their textures, are not read, or an
// archive makes a program write, crash or take memory out of proportion.

#include <gtest/gtest.h>
#include <zip.h>

#include <random>

#include "core/file.h"
#include "formats/io/inputs.h"
#include "formats/io/open_scene.h"
#include "formats/zip/zip_archive.h"
#include "support/folder_test.h"
#include "support/glb_builder.h"
#include "support/small_images.h"

namespace krok {
namespace {

using test::GlbBuilder;
using Json = nlohmann::ordered_json;

class ZippedScene : public test::FolderTest {
 protected:
  struct Entry {
    std::string name, content;
  };

  void zip(const std::string& name, const std::vector<Entry>& entries) const {
    int error = 0;
    zip_t* archive = zip_open(path(name).c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
    ASSERT_NE(archive, nullptr);
    for (const Entry& entry : entries) {
      zip_source_t* source =
          zip_source_buffer(archive, entry.content.data(), entry.content.size(), 0);
      ASSERT_GE(zip_file_add(archive, entry.name.c_str(), source, ZIP_FL_ENC_UTF_8), 0);
    }
    ASSERT_EQ(zip_close(archive), 0);
  }

  Result<nodes::Scene> read(const std::string& name) const {
    io::PlainInputs inputs;
    const auto file = inputs.open_input(path(name));
    if (!file) return file.error();
    return io::open_scene(*file, inputs, true);
  }

  // A scene with a buffer and an image beside it.
  static std::vector<Entry> scene(const std::string& folder) {
    GlbBuilder builder = test::rig();
    Json json = builder.json;
    json["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", "the%20data.bin"}}};
    json["images"] = {{{"uri", "textures/skin.png"}}};
    json["textures"] = {{{"source", 0}}};
    json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    json["meshes"][0]["primitives"][0]["material"] = 0;
    const auto png = test::png();
    const auto text = [](const auto& bytes) {
      return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    return {{folder + "license.txt", "free"},
            {folder + "scene.gltf", json.dump()},
            {folder + "the data.bin", text(builder.bin)},
            {folder + "textures/skin.png", text(png)}};
  }
};

TEST_F(ZippedScene, IsReadWithItsBuffersAndImages) {
  for (const std::string folder : {"", "hero/v2/"}) {
    zip("hero.zip", scene(folder));
    const auto found = read("hero.zip");
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_EQ(found->meshes.at(0).primitives.at(0).vertex_count(), 4U);
    ASSERT_EQ(found->materials.size(), 1U);
    ASSERT_TRUE(found->materials[0].base_color_texture);
    EXPECT_TRUE(found->files.empty());
    EXPECT_EQ(listing(), std::vector<std::string>{"hero.zip"}) << "nothing is unpacked to disk";
  }
}

TEST_F(ZippedScene, WhatIsNoSceneIsSaid) {
  const auto code = [&](const std::vector<Entry>& entries) {
    zip("a.zip", entries);
    const auto found = read("a.zip");
    return found.ok() ? "read" : found.error().code;
  };
  EXPECT_EQ(code({{"walk.bvh", "HIERARCHY"}}), "zip-scene");
  EXPECT_EQ(code({{"a.gltf", "{}"}, {"b.glb", "{}"}}), "zip-scene");
  auto entries = scene("");
  entries.erase(entries.begin() + 2);
  EXPECT_EQ(code(entries), "file-missing");
  entries = scene("");
  entries[1].content.replace(entries[1].content.find("the%20data"), 10, "../thedata");
  EXPECT_EQ(code(entries), "gltf-buffer");
}

// 300 MB of zeros are 300 KB in an archive.
TEST_F(ZippedScene, DoesNotGrowOutOfProportion) {
  auto entries = scene("");
  entries[2].content.resize(std::size_t{300} << 20);
  zip("bomb.zip", entries);
  const auto found = read("bomb.zip");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "file-too-large");
}

TEST_F(ZippedScene, SurvivesDamage) {
  zip("good.zip", scene(""));
  const auto file = InputFile::open(path("good.zip"));
  ASSERT_TRUE(file.ok());
  const std::vector<std::byte> good(file->bytes().begin(), file->bytes().end());
  std::mt19937 random(11);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<std::byte> bytes = good;
    if (round % 3 == 0) bytes.resize(random() % bytes.size());
    for (int k = 0; k < 3 && !bytes.empty(); ++k) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
    const auto archive = zip::Archive::open(bytes);
    if (!archive) {
      ++refused;
      continue;
    }
    for (const std::string& name : archive->names()) (void)archive->read(name, 1 << 20);
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace krok

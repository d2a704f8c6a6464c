// Characters of the corpus as .character files. If this fails, a material or a byte of a texture of
// a real character is lost on the way, or what is written does not hold together.

#include <gtest/gtest.h>

#include <algorithm>

#include "cli/fixture.h"
#include "formats/character/character_format.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/material/material_format.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> characters() {
  std::vector<fs::path> found;
  const fs::path folder = test::corpus_folder() + "/other";
  if (!fs::exists(folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string end = extension(entry.path().string());
    const std::vector<std::string> known = {".glb", ".gltf", ".fbx", ".dae", ".smd", ".ms3d"};
    if (std::ranges::find(known, end) != known.end()) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

class CharactersOfTheCorpus : public CliTest {};

TEST_F(CharactersOfTheCorpus, KeepTheirMaterialsAndTextures) {
  const auto files = characters();
  if (files.empty()) GTEST_SKIP() << "skipped: no corpus in " << test::corpus_folder();
  int textures_compared = 0;
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    const ToolRun run = run_tool("krok-import", {file, "--save-character", path("a.character")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run_tool("krok-info", {path("a.character")}).exit_code, 0);
    const auto character = character_file::read(get(path("a.character")));
    ASSERT_TRUE(character.ok()) << character.error().message;
    if (file.extension() != ".glb" && file.extension() != ".gltf") continue;
    gltf::ReadOptions options;
    options.with_materials = true;
    const auto scene = gltf::read_file(file, options);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    if (scene->materials.empty()) continue;
    const auto materials = material::read(get(path("a.material")));
    ASSERT_TRUE(materials.ok()) << materials.error().message;
    for (const Material& written : *materials) {
      const Material* const original = find_material(scene->materials, written.name);
      ASSERT_NE(original, nullptr) << written.name;
      EXPECT_EQ(written.base_color, original->base_color);
      EXPECT_EQ(written.metallic, original->metallic);
      EXPECT_EQ(written.roughness, original->roughness);
      EXPECT_EQ(written.double_sided, original->double_sided);
      const auto textures = textures_of(written), originals = textures_of(*original);
      for (std::size_t t = 0; t < textures.size(); ++t) {
        ASSERT_EQ(static_cast<bool>(*textures[t]), static_cast<bool>(*originals[t]));
        if (!*textures[t]) continue;
        const std::string bytes = get(path(textures[t]->image->path));
        EXPECT_TRUE(
            std::ranges::equal(std::as_bytes(std::span(bytes)), originals[t]->image->bytes));
        ++textures_compared;
      }
    }
  }
  EXPECT_GT(textures_compared, 0);
}

}  // namespace
}  // namespace krok::test

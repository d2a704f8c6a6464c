// If these fail, a character of FBX or COLLADA comes in with other materials or textures than its
// file has, or a file from anyone makes the reader open what it must not.

#include <gtest/gtest.h>

#include "reading.h"
#include "sample_fbx.h"
#include "support/small_images.h"

namespace krok::test {
namespace {

nodes::Scene read_with_materials(const std::string& path) {
  auto scene = assimp::read_file(path, {.with_materials = true});
  EXPECT_TRUE(scene.ok()) << (scene ? "" : scene.error().message);
  return scene ? std::move(*scene) : nodes::Scene();
}

const Material& only_material(const nodes::Scene& scene) {
  EXPECT_EQ(scene.materials.size(), 1u);
  static const Material none;
  return scene.materials.empty() ? none : scene.materials[0];
}

// A triangle whose diffuse colour is a picture.
std::string textured_collada(const std::string& image, const std::string& wrap = "") {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
         "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n"
         "<asset><unit name=\"meter\" meter=\"1\"/><up_axis>Y_UP</up_axis></asset>\n"
         "<library_images><image id=\"img\"><init_from>" +
         image +
         "</init_from></image></library_images>\n"
         "<library_effects><effect id=\"fx\"><profile_COMMON>"
         "<newparam sid=\"surf\"><surface type=\"2D\"><init_from>img</init_from></surface>"
         "</newparam><newparam sid=\"samp\"><sampler2D><source>surf</source></sampler2D>"
         "</newparam><technique sid=\"common\"><phong>"
         "<emission><color>0.5 0.25 0 1</color></emission>"
         "<diffuse><texture texture=\"samp\" texcoord=\"UV\">" +
         wrap +
         "</texture></diffuse></phong></technique></profile_COMMON></effect></library_effects>\n"
         "<library_materials><material id=\"mat\" name=\"Skin\"><instance_effect url=\"#fx\"/>"
         "</material></library_materials>\n"
         "<library_geometries><geometry id=\"geo\" name=\"body\"><mesh>"
         "<source id=\"pos\"><float_array id=\"pos-a\" count=\"9\">0 0 0 1 0 0 0 1 0</float_array>"
         "<technique_common><accessor source=\"#pos-a\" count=\"3\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<source id=\"uv\"><float_array id=\"uv-a\" count=\"6\">0 0 1 0 0 1</float_array>"
         "<technique_common><accessor source=\"#uv-a\" count=\"3\" stride=\"2\">"
         "<param name=\"S\" type=\"float\"/><param name=\"T\" type=\"float\"/></accessor>"
         "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
         "source=\"#pos\"/></vertices><triangles material=\"sym\" count=\"1\"><input "
         "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><input semantic=\"TEXCOORD\" "
         "source=\"#uv\" offset=\"1\" set=\"0\"/><p>0 0 1 1 2 2</p></triangles></mesh></geometry>"
         "</library_geometries>\n<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\" "
         "name=\"n\"><instance_geometry url=\"#geo\"><bind_material><technique_common>"
         "<instance_material symbol=\"sym\" target=\"#mat\"><bind_vertex_input semantic=\"UV\" "
         "input_semantic=\"TEXCOORD\" input_set=\"0\"/></instance_material></technique_common>"
         "</bind_material></instance_geometry></node></visual_scene></library_visual_scenes>\n"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

TEST(AssimpMaterials, ColladaHasColoursAndImagesBeside) {
  const Folder folder;
  folder.add("tex/skin 1.png", text_of(png()));
  const auto scene =
      read_with_materials(folder.add("in.dae", textured_collada("tex/skin%201.png")));
  const Material& material = only_material(scene);
  EXPECT_EQ(material.name, "Skin");
  EXPECT_EQ(material.base_color, Vec4f::Ones());
  EXPECT_EQ(material.emissive, Vec3f(0.5f, 0.25f, 0));
  ASSERT_TRUE(static_cast<bool>(material.base_color_texture));
  EXPECT_EQ(material.base_color_texture.image->bytes, png());
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).material_index, 0);
  ASSERT_EQ(scene.files.size(), 1u);
  EXPECT_TRUE(scene.files[0].ends_with("tex/skin 1.png"));
}

TEST(AssimpMaterials, ColladaMayHaveBlanksAroundColours) {
  const Folder folder;
  std::string text = textured_collada("skin.png");
  const std::string colour = "<color>0.5 0.25 0 1</color>";
  const auto at = text.find(colour);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, colour.size(), "<color sid=\"emission\">\r\n\t 0.5 0.25 0 1 </color>");
  const auto scene = read_with_materials(folder.add("in.dae", text));
  EXPECT_EQ(only_material(scene).emissive, Vec3f(0.5f, 0.25f, 0));
  // Cut short anywhere around it, it is refused or read, and nothing else.
  for (std::size_t end = at; end < at + 40; ++end) {
    (void)assimp::read_file(folder.add("cut.dae", text.substr(0, end))).ok();
  }
}

TEST(AssimpMaterials, WithoutBeingAskedNothingIsRead) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("in.dae", textured_collada("skin.png")));
  EXPECT_TRUE(scene.materials.empty());
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).material_index, -1);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).material, "Skin");
  EXPECT_FALSE(has_code(scene.diagnostics, "assimp-picture"));
}

TEST(AssimpMaterials, ImagesOutsideOrUnfitAreLeftOutWithAWarning) {
  const Folder folder;
  folder.add("secret.png", text_of(png()));
  folder.add("in/text.png", "no picture");
  const std::string outside = std::filesystem::path(folder.add("x", "")).parent_path().string();
  for (const std::string& image :
       {std::string("../secret.png"), outside + "/secret.png", "file://" + outside + "/secret.png",
        std::string("missing.png"), std::string("text.png"), std::string("*7"),
        std::string("*99999999999999999999")}) {
    SCOPED_TRACE(image);
    const auto scene = read_with_materials(folder.add("in/in.dae", textured_collada(image)));
    EXPECT_FALSE(static_cast<bool>(only_material(scene).base_color_texture));
    EXPECT_TRUE(has_code(scene.diagnostics, "assimp-picture"));
    EXPECT_TRUE(scene.files.empty());
  }
}

// The sample with a material, whose diffuse colour is a picture if `texture` is not empty.
std::string dressed_fbx(const std::string& texture, const std::string& video = "") {
  std::string text = FbxSample().text();
  const auto insert_behind = [&](const std::string& place, const std::string& more) {
    const auto at = text.find(place);
    ASSERT_NE(at, std::string::npos);
    text.insert(at + place.size(), more);
  };
  insert_behind(
      "Objects:  {\n",
      "Material: 8000, \"Material::Skin\", \"\" {\nVersion: 102\nShadingModel: \"phong\"\n"
      "MultiLayer: 0\nProperties70:  {\n"
      "P: \"DiffuseColor\", \"Color\", \"\", \"A\",0.5,0.25,0.125\n"
      "P: \"EmissiveColor\", \"Color\", \"\", \"A\",0,0.5,0\n"
      "P: \"ShininessExponent\", \"double\", \"Number\", \"\",30\n}\n}\n" +
          texture + video);
  insert_behind("Layer: 0 {\nVersion: 100\n",
                "LayerElement:  {\nType: \"LayerElementMaterial\"\nTypedIndex: 0\n}\n");
  insert_behind("GeometryVersion: 124\n",
                "LayerElementMaterial: 0 {\nVersion: 101\nName: \"\"\n"
                "MappingInformationType: \"AllSame\"\nReferenceInformationType: "
                "\"IndexToDirect\"\nMaterials: *1 {\na: 0\n}\n}\n");
  std::string links = "C: \"OO\",8000,5000\n";
  if (!texture.empty()) links += "C: \"OP\",8001,8000, \"DiffuseColor\"\n";
  if (!video.empty()) links += "C: \"OO\",8002,8001\n";
  insert_behind("Connections:  {\n", links);
  return text;
}

constexpr const char* kFbxTexture =
    "Texture: 8001, \"Texture::Map\", \"\" {\nType: \"TextureVideoClip\"\nVersion: 202\n"
    "TextureName: \"Texture::Map\"\nFileName: \"C:\\Users\\someone\\maps\\skin.png\"\n"
    "RelativeFilename: \"..\\maps\\skin.png\"\nModelUVTranslation: 0,0\nModelUVScaling: 1,1\n}\n";

TEST(AssimpMaterials, FbxHasColours) {
  const Folder folder;
  const auto scene = read_with_materials(folder.add("in.fbx", dressed_fbx("")));
  const Material& material = only_material(scene);
  EXPECT_EQ(material.name, "Skin");
  EXPECT_EQ(material.base_color, Vec4f(0.5f, 0.25f, 0.125f, 1));
  EXPECT_EQ(material.emissive, Vec3f(0, 0.5f, 0));
  // As Blender has it, a Phong exponent of 30 is a roughness of 1 - sqrt(30) / 10.
  EXPECT_NEAR(material.roughness, 0.4522774f, 1e-6f);
  EXPECT_EQ(material.metallic, 0);
  EXPECT_EQ(material.alpha, Material::Alpha::opaque);
}

TEST(AssimpMaterials, AnotherMachinesPathIsLookedForByItsName) {
  const Folder folder;
  folder.add("textures/Skin.PNG", text_of(png()));
  const auto scene = read_with_materials(folder.add("in.fbx", dressed_fbx(kFbxTexture)));
  const Material& material = only_material(scene);
  ASSERT_TRUE(static_cast<bool>(material.base_color_texture));
  EXPECT_EQ(material.base_color_texture.image->bytes, png());
  EXPECT_EQ(material.base_color, Vec4f::Ones());
}

TEST(AssimpMaterials, WhereTheImageIsLostTheColourRemains) {
  const Folder folder;
  const auto scene = read_with_materials(folder.add("in.fbx", dressed_fbx(kFbxTexture)));
  const Material& material = only_material(scene);
  EXPECT_FALSE(static_cast<bool>(material.base_color_texture));
  EXPECT_EQ(material.base_color, Vec4f(0.5f, 0.25f, 0.125f, 1));
}

TEST(AssimpMaterials, FbxHoldsImagesItself) {
  const Folder folder;
  // The picture of small_images.h, in base64.
  const std::string video =
      "Video: 8002, \"Video::Map\", \"Clip\" {\nType: \"Clip\"\n"
      "FileName: \"C:\\Users\\someone\\maps\\skin.png\"\n"
      "RelativeFilename: \"..\\maps\\skin.png\"\nContent: ,\n\""
      "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mP4z8DA8J+BkYHh"
      "////DAAe9gT9CzF8CQAAAABJRU5ErkJggg=="
      "\"\n}\n";
  const auto scene = read_with_materials(folder.add("in.fbx", dressed_fbx(kFbxTexture, video)));
  const Material& material = only_material(scene);
  ASSERT_TRUE(static_cast<bool>(material.base_color_texture));
  EXPECT_EQ(material.base_color_texture.image->bytes, png());
  EXPECT_TRUE(scene.files.empty());
}

}  // namespace
}  // namespace krok::test

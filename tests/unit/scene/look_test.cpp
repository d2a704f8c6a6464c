// If these fail, materials or characters that no file can hold pass for good ones.

#include <gtest/gtest.h>

#include <cmath>

#include "scene/character.h"
#include "scene/material.h"
#include "support/special_values.h"

namespace krok {
namespace {

using test::kNanF;

template <typename Change>
std::string material_fault(Change change) {
  std::vector<Material> materials(2);
  materials[0].name = "a";
  materials[1].name = "b";
  EXPECT_TRUE(check(materials).ok());
  change(materials[1]);
  const Status status = check(materials);
  return status ? "" : status.error().code;
}

TEST(CheckMaterials, FindsEachFault) {
  EXPECT_EQ(material_fault([](Material& m) { m.name.clear(); }), "material-name");
  EXPECT_EQ(material_fault([](Material& m) { m.name = "a"; }), "material-name");
  EXPECT_EQ(material_fault([](Material& m) { m.name = "\xFF"; }), "material-name");
  EXPECT_EQ(material_fault([](Material& m) { m.name = std::string("a\0b", 3); }), "material-name");
  EXPECT_EQ(material_fault([](Material& m) { m.name.assign(1001, 'a'); }), "material-name");
  EXPECT_EQ(material_fault([](Material& m) { m.base_color.w() = 1.5f; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.base_color.x() = kNanF; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.metallic = -0.1f; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.roughness = kNanF; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.occlusion_strength = 2; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.emissive.z() = 2; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.alpha_cutoff = kNanF; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.normal_scale = kNanF; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.normal_scale = 1001; }), "material-value");
  EXPECT_EQ(material_fault([](Material& m) { m.shaders = {"\xFF"}; }), "material-value");
  EXPECT_TRUE(check(std::vector<Material>()).ok());
}

template <typename Change>
bool is_good(Change change) {
  Character character;
  character.model = "a.model";
  character.morphs = "a.exr";
  character.parts = {{"body", "skin"}};
  character.eyes = {{"left", "Head", {0, 1, 0}}};
  character.expressions = {{"smile", "", 1}};
  EXPECT_TRUE(check(character).ok());
  change(character);
  const Status status = check(character);
  EXPECT_TRUE(status.ok() || status.error().code == "character-value");
  return status.ok();
}

TEST(CheckCharacter, FindsEachFault) {
  EXPECT_FALSE(is_good([](Character& c) { c.model.clear(); }));
  EXPECT_FALSE(is_good([](Character& c) { c.name = "\xFF"; }));
  EXPECT_FALSE(is_good([](Character& c) { c.morphs.clear(); }));
  EXPECT_FALSE(is_good([](Character& c) { c.parts.push_back(c.parts[0]); }));
  EXPECT_FALSE(is_good([](Character& c) { c.parts[0].material = "\xFF"; }));
  EXPECT_FALSE(is_good([](Character& c) { c.eyes.push_back(c.eyes[0]); }));
  EXPECT_FALSE(is_good([](Character& c) { c.eyes[0].joint.clear(); }));
  EXPECT_FALSE(is_good([](Character& c) { c.eyes[0].position.y() = kNanF; }));
  EXPECT_FALSE(is_good([](Character& c) { c.eyes[0].position.y() = 2e6f; }));
  EXPECT_FALSE(is_good([](Character& c) { c.expressions[0].name.clear(); }));
  EXPECT_FALSE(is_good([](Character& c) { c.expressions[0].target = "\xFF"; }));
  EXPECT_FALSE(is_good([](Character& c) { c.expressions[0].weight = kNanF; }));
  EXPECT_TRUE(is_good([](Character& c) { c.expressions.clear(); }));
}

}  // namespace
}  // namespace krok

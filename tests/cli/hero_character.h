#pragma once

#include <string>

#include "cli/bent_body.h"
#include "cli/fixture.h"
#include "support/small_images.h"

namespace krok::test {

// hero.character is in.model with the material Skin, an eye, and the expression "bow", which is the
// target "bent" and shows at rest.
class HeroCharacter : public BentBody {
 protected:
  void SetUp() override {
    BentBody::SetUp();
    put("skin.png", text_of(png()));
    put_material(R"("base_color_texture": "skin.png", "roughness": 0.25)");
    put_character(kBowing);
  }

  static constexpr const char* kBowing = R"([{"name": "bow", "target": "bent", "weight": 1}])";
  static constexpr const char* kUpright = R"([{"name": "bow", "target": "bent"}])";

  void put_material(const std::string& members) {
    put("in.material", R"({"schema": "krok.material/1", "materials": [
             {"name": "Skin", )" +
                           members + "}]}");
  }

  void put_character(const std::string& expressions, const std::string& model = "in.model") {
    put("hero.character", R"({"schema": "krok.character/1", "model": ")" + model +
                              R"(", "materials": ["in.material"],
             "parts": [{"name": "body", "material": "Skin"}],
             "eyes": [{"name": "left", "joint": "Head", "position": [0.1, 1.8, 0.1]}],
             "morphs": "bent.exr", "expressions": )" +
                              expressions + "}\n");
  }
};

}  // namespace krok::test

// If these fail, a published JSON Schema no longer says what the reader of its format accepts. With
// KROK_UPDATE_SCHEMAS in the environment the files are written instead; tests/golden/update.sh
// does.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/alignment/alignment_format.h"
#include "formats/camera_keys/camera_keys.h"
#include "formats/character/character_format.h"
#include "formats/correctives/correctives_format.h"
#include "formats/goals/goals.h"
#include "formats/height_field/height_image.h"
#include "formats/key_shapes/key_shapes.h"
#include "formats/keys/keys.h"
#include "formats/library/library_description.h"
#include "formats/limits/limits_format.h"
#include "formats/material/material_format.h"
#include "formats/path/path_format.h"
#include "formats/prints/prints.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "formats/sequences/sequences.h"
#include "formats/timeline/timeline_file.h"
#include "formats/weights/weights.h"
#include "support/this_build.h"

namespace krok {
namespace {

const std::pair<const char*, std::string (*)()> kSchemas[] = {
    {"alignment/alignment", alignment::schema},
    {"camera_keys/camera_keys", camera_keys::schema},
    {"character/character", character_file::schema},
    {"correctives/corrective_poses", corrective_poses::schema},
    {"correctives/correctives", correctives_file::schema},
    {"goals/goals", goals::schema},
    {"height_field/ground", height_field::schema},
    {"keys/keys", keys::schema},
    {"library/library", library::schema},
    {"path/path", path_file::schema},
    {"prints/prints", prints::schema},
    {"key_shapes/key_shapes", key_shapes::schema},
    {"limits/limits", limits::schema},
    {"material/material", material::schema},
    {"ragdoll/ragdoll", ragdoll_file::schema},
    {"sequences/sequences", sequences::schema},
    {"timeline/timeline", timeline_file::schema},
    {"weights/weights", weights::schema},
};

TEST(Schemas, AreWhatTheFieldTablesSay) {
  for (const auto& [name, schema] : kSchemas) {
    const std::string path = test::source_folder() + "/formats/" + name + ".schema.json";
    const std::string made = nlohmann::ordered_json::parse(schema()).dump(1) + '\n';
    if (std::getenv("KROK_UPDATE_SCHEMAS") != nullptr) std::ofstream(path) << made;
    std::stringstream published;
    published << std::ifstream(path).rdbuf();
    EXPECT_EQ(published.str(), made) << path << "; tests/golden/update.sh renews it";
  }
}

}  // namespace
}  // namespace krok

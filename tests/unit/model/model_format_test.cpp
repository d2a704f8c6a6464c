// If these fail, models do not survive being stored, or invalid ones are stored or read.

#include "formats/model/model_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "golden/samples/samples.h"

namespace krok {
namespace {

using testing::ElementsAreArray;

Model read_back(const Model& model) {
  auto back = model::read(samples::bytes_of(model));
  EXPECT_TRUE(back.ok()) << back.error().message;
  return *std::move(back);
}

TEST(ModelFormat, EveryNumberOfInfluencesComesBack) {
  for (int influences = 1; influences <= Model::kMaxInfluences; ++influences) {
    Model model = samples::plain_model();
    model.influences_per_vertex = influences;
    model.influence_joints.clear();
    model.influence_weights.clear();
    for (int v = 0; v < model.vertex_count(); ++v) {
      for (int k = 0; k < influences; ++k) {
        model.influence_joints.push_back(static_cast<std::uint16_t>((v + k) % 3));
        model.influence_weights.push_back(1.0f / static_cast<float>(influences));
      }
    }
    const Model back = read_back(model);
    EXPECT_EQ(back.influences_per_vertex, influences);
    EXPECT_EQ(back.influence_joints, model.influence_joints);
    EXPECT_EQ(back.influence_weights, model.influence_weights);
  }
}

TEST(ModelFormat, EveryChoiceOfOptionalDataComesBack) {
  for (int choice = 0; choice < 32; ++choice) {
    Model model = samples::model();
    model.colours = samples::coloured_model().colours;
    model.more_texture_coordinates = samples::coloured_model().more_texture_coordinates;
    if ((choice & 1) == 0) model.normals.clear();
    if ((choice & 2) == 0) model.texture_coordinates.clear();
    if ((choice & 4) == 0) model.tangents.clear();
    if ((choice & 8) == 0) model.colours.clear();
    if ((choice & 16) == 0 || (choice & 2) == 0) model.more_texture_coordinates.clear();
    const Model back = read_back(model);
    EXPECT_THAT(back.normals, ElementsAreArray(model.normals));
    EXPECT_THAT(back.texture_coordinates, ElementsAreArray(model.texture_coordinates));
    EXPECT_THAT(back.tangents, ElementsAreArray(model.tangents));
    EXPECT_EQ(back.more_texture_coordinates, model.more_texture_coordinates);
    EXPECT_THAT(back.colours, ElementsAreArray(model.colours));
  }
}

TEST(ModelFormat, ASkeletonWithoutAMeshIsFine) {
  Model model;
  model.skeleton = samples::clip().skeleton;
  model.influences_per_vertex = 1;
  const Model back = read_back(model);
  EXPECT_EQ(back.vertex_count(), 0);
  EXPECT_EQ(back.parts.size(), 0u);
  EXPECT_EQ(back.skeleton.names, model.skeleton.names);
}

TEST(ModelFormat, WritingWhatWasReadGivesTheSameBytes) {
  const auto bytes = samples::bytes_of(samples::model());
  EXPECT_EQ(samples::bytes_of(*model::read(bytes)), bytes);
}

TEST(ModelFormat, WriterRefusesWhatIsNoModel) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto code = [](const std::function<void(Model&)>& change) {
    Model model = samples::model();
    change(model);
    auto file = OutputFile::create("/dev/null");
    const Status status = model::write(model, {}, *file);
    return status ? std::string() : status.error().code;
  };
  EXPECT_EQ(code([](Model&) {}), "");
  EXPECT_EQ(code([&](Model& m) { m.positions[1].x() = nan; }), "model-value");
  EXPECT_EQ(code([&](Model& m) { m.normals[1].x() = nan; }), "model-value");
  EXPECT_EQ(code([&](Model& m) { m.texture_coordinates[1].x() = nan; }), "model-value");
  EXPECT_EQ(code([&](Model& m) { m.tangents[1].x() = nan; }), "model-value");
  EXPECT_EQ(code([&](Model& m) { m.influence_weights[0] = nan; }), "model-weight");
  EXPECT_EQ(code([](Model& m) { m.influence_weights[0] = 0.5f; }), "model-weight");
  EXPECT_EQ(code([](Model& m) { m.influence_joints[0] = 3; }), "model-index");
  EXPECT_EQ(code([](Model& m) { m.triangles[0][1] = 4; }), "model-index");
  EXPECT_EQ(code([](Model& m) { m.parts[1].first_triangle = 0; }), "model-shape");
  EXPECT_EQ(code([](Model& m) { m.parts[1].material = "\xFF"; }), "model-shape");
  EXPECT_EQ(code([](Model& m) { m.influences_per_vertex = 9; }), "model-shape");
  EXPECT_EQ(code([](Model& m) { m.tangents.pop_back(); }), "model-shape");
}

TEST(ModelFormat, ReaderRefusesWrongCountsWithTheirPlace) {
  const auto whole = samples::bytes_of(samples::model());
  std::uint64_t info = 0;
  std::memcpy(&info, &whole[64 + 8], sizeof info);
  const auto with_word = [&](std::size_t offset, std::uint32_t value) {
    auto file = whole;
    std::memcpy(&file[info + offset], &value, sizeof value);
    samples::repair_header(file);
    const auto read = model::read(file);
    EXPECT_FALSE(read.ok());
    if (read.ok()) return std::string();
    EXPECT_GT(read.error().where.byte_offset, 0);
    return read.error().code;
  };
  EXPECT_EQ(with_word(0, 0), "model-shape");
  EXPECT_EQ(with_word(0, 4), "container-section");
  EXPECT_EQ(with_word(4, 5), "container-section");
  EXPECT_EQ(with_word(4, 0x7FFFFFFF), "container-section");
  EXPECT_EQ(with_word(4, 0xFFFFFFFF), "model-shape");
  EXPECT_EQ(with_word(8, 3), "container-section");
  EXPECT_EQ(with_word(12, 1), "container-section");
  EXPECT_EQ(with_word(16, 9), "model-shape");
  EXPECT_EQ(with_word(16, 4), "container-section");
}

TEST(ModelFormat, OtherFilesAreNamed) {
  const auto clip = model::read(samples::bytes_of(samples::clip()));
  ASSERT_FALSE(clip.ok());
  EXPECT_EQ(clip.error().message, "is a Krok motion (.anim), not a .model file");
  EXPECT_EQ(clip.error().hint, "krok-body makes a model for a motion");
}

}  // namespace
}  // namespace krok

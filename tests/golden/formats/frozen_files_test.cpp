// If these fail, files of version 1 that users have are read differently than before, or the
// writers no longer write what they wrote, or SPEC.md and the library disagree.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/model/model_format.h"
#include "formats/steps/steps.h"
#include "golden/samples/samples.h"
#include "rbf/weight_evaluator.h"
#include "skin/skin.h"
#include "support/this_build.h"

namespace krok {
namespace {

using nlohmann::json;
using testing::ElementsAreArray;

const std::string kFrozen = test::source_folder() + "/tests/golden/v1/";
constexpr auto kXyzw = OrientationEncoding::xyzw;

InputFile open(const std::string& path) {
  auto file = InputFile::open(path);
  EXPECT_TRUE(file.ok()) << path;
  return *std::move(file);
}

std::vector<std::byte> bytes_of_file(const std::string& path) {
  const InputFile file = open(path);
  return {file.bytes().begin(), file.bytes().end()};
}

// What the file holds must be the sample, orientations up to sign. One sample has a tiny w and x,
// y, z in simple ratios, for which no floats nearby give w better than this.
void expect_same(const Quat& found, const Quat& expected) {
  const double sign = found.dot(expected) < 0 ? -1 : 1;
  EXPECT_LT((found.coeffs() * sign - expected.coeffs()).norm(), 1e-5)
      << found.coeffs().transpose() << " instead of " << expected.coeffs().transpose();
}

void expect_same(const Skeleton& found, const Skeleton& expected) {
  EXPECT_EQ(found.names, expected.names);
  EXPECT_EQ(found.parents, expected.parents);
  EXPECT_EQ(found.end_sites, expected.end_sites);
  ASSERT_EQ(found.reference.size(), expected.reference.size());
  for (std::size_t i = 0; i < found.reference.size(); ++i) {
    EXPECT_EQ(found.reference[i].position, expected.reference[i].position);
    expect_same(found.reference[i].orientation, expected.reference[i].orientation);
  }
}

void expect_same(const Provenance& found, const Provenance& expected) {
  EXPECT_EQ(found.tool, expected.tool);
  EXPECT_EQ(found.version, expected.version);
  ASSERT_EQ(found.sources.size(), expected.sources.size());
  for (std::size_t i = 0; i < found.sources.size(); ++i) {
    EXPECT_EQ(found.sources[i].name, expected.sources[i].name);
    EXPECT_EQ(found.sources[i].xxh3, expected.sources[i].xxh3);
  }
  EXPECT_EQ(found.options, expected.options);
  EXPECT_EQ(found.conversions, expected.conversions);
  EXPECT_EQ(found.warnings, expected.warnings);
}

TEST(FrozenFiles, MotionHoldsEveryValue) {
  const Clip expected = samples::clip();
  for (const char* name : {"motion.anim", "motion_xyzw.anim"}) {
    SCOPED_TRACE(name);
    const auto clip = anim::read(open(kFrozen + name).bytes());
    ASSERT_TRUE(clip.ok()) << clip.error().message;
    expect_same(clip->skeleton, expected.skeleton);
    EXPECT_EQ(clip->rate, expected.rate);
    EXPECT_THAT(clip->positions, ElementsAreArray(expected.positions));
    ASSERT_EQ(clip->orientations.size(), expected.orientations.size());
    for (std::size_t i = 0; i < clip->orientations.size(); ++i) {
      expect_same(clip->orientations[i].cast<double>(), expected.orientations[i].cast<double>());
    }
    expect_same(clip->provenance, expected.provenance);
  }
  const auto exact = anim::read(open(kFrozen + "motion_xyzw.anim").bytes());
  for (std::size_t i = 0; i < expected.orientations.size(); ++i) {
    EXPECT_EQ(exact->orientations[i].coeffs(), expected.orientations[i].coeffs());
  }
}

TEST(FrozenFiles, AStretchedMotionHoldsEveryValue) {
  const InputFile file = open(kFrozen + "motion_stretched.anim");
  Stretches stretches;
  const auto clip = anim::read(file.bytes(), &stretches);
  ASSERT_TRUE(clip.ok()) << clip.error().message;
  EXPECT_THAT(clip->positions, ElementsAreArray(samples::clip().positions));
  EXPECT_EQ(stretches, samples::stretches());
  // A caller without a place for them must not show another motion in silence.
  EXPECT_EQ(anim::read(file.bytes()).error().code, "anim-stretch");
  // Nor may a reader that was written before them: to it the flag is unknown, as bit 2 is to ours.
  std::uint32_t flags = 0;
  std::memcpy(&flags, &file.bytes()[12], sizeof flags);
  EXPECT_EQ(flags, 2U);
  auto newer = bytes_of_file(kFrozen + "motion_stretched.anim");
  newer[12] = std::byte{4};
  samples::repair_header(newer);
  EXPECT_EQ(anim::read(newer, &stretches).error().code, "container-flags");
}

TEST(FrozenFiles, ModelsHoldEveryValue) {
  const std::pair<const char*, Model> models[] = {
      {"full.model", samples::model()},
      {"plain_xyzw.model", samples::plain_model()},
      {"coloured_xyzw.model", samples::coloured_model()}};
  for (const auto& [name, expected] : models) {
    SCOPED_TRACE(name);
    const auto model = model::read(open(kFrozen + name).bytes());
    ASSERT_TRUE(model.ok()) << model.error().message;
    expect_same(model->skeleton, expected.skeleton);
    EXPECT_THAT(model->positions, ElementsAreArray(expected.positions));
    EXPECT_THAT(model->normals, ElementsAreArray(expected.normals));
    EXPECT_THAT(model->texture_coordinates, ElementsAreArray(expected.texture_coordinates));
    EXPECT_EQ(model->more_texture_coordinates, expected.more_texture_coordinates);
    EXPECT_THAT(model->tangents, ElementsAreArray(expected.tangents));
    EXPECT_THAT(model->colours, ElementsAreArray(expected.colours));
    EXPECT_EQ(model->influences_per_vertex, expected.influences_per_vertex);
    EXPECT_EQ(model->influence_joints, expected.influence_joints);
    EXPECT_EQ(model->influence_weights, expected.influence_weights);
    EXPECT_EQ(model->triangles, expected.triangles);
    ASSERT_EQ(model->parts.size(), expected.parts.size());
    for (std::size_t i = 0; i < model->parts.size(); ++i) {
      EXPECT_EQ(model->parts[i].name, expected.parts[i].name);
      EXPECT_EQ(model->parts[i].material, expected.parts[i].material);
      EXPECT_EQ(model->parts[i].first_triangle, expected.parts[i].first_triangle);
      EXPECT_EQ(model->parts[i].triangle_count, expected.parts[i].triangle_count);
    }
    expect_same(model->provenance, expected.provenance);
  }
}

TEST(FrozenFiles, CameraHoldsEveryValue) {
  const CameraTrack expected = samples::camera();
  for (const char* name : {"camera.cam", "camera_xyzw.cam"}) {
    SCOPED_TRACE(name);
    const auto camera = cam::read(open(kFrozen + name).bytes());
    ASSERT_TRUE(camera.ok()) << camera.error().message;
    EXPECT_EQ(camera->rate, expected.rate);
    EXPECT_THAT(camera->positions, ElementsAreArray(expected.positions));
    EXPECT_EQ(camera->fields_of_view, expected.fields_of_view);
    ASSERT_EQ(camera->orientations.size(), expected.orientations.size());
    for (std::size_t i = 0; i < camera->orientations.size(); ++i) {
      expect_same(camera->orientations[i].cast<double>(), expected.orientations[i].cast<double>());
    }
    expect_same(camera->provenance, expected.provenance);
  }
}

TEST(FrozenFiles, StepLibrariesHoldEveryValue) {
  const std::pair<const char*, steps::StepsFile> files[] = {
      {"fitted.steps", samples::step_library()},
      {"unfitted_xyzw.steps", samples::unfitted_library()}};
  for (const auto& [name, expected] : files) {
    SCOPED_TRACE(name);
    const auto found = steps::read(open(kFrozen + name).bytes());
    ASSERT_TRUE(found.ok()) << found.error().message;
    const auto &library = found->library, &wanted = expected.library;
    expect_same(library.skeleton, wanted.skeleton);
    EXPECT_EQ(library.swing, wanted.swing);
    EXPECT_EQ(library.keytimes, wanted.keytimes);
    EXPECT_EQ(library.parameters, wanted.parameters);
    EXPECT_EQ(library.rate, wanted.rate);
    for (std::size_t f = 0; f < 2; ++f) {
      EXPECT_EQ(library.feet[f].joint, wanted.feet[f].joint);
      EXPECT_EQ(library.feet[f].heel, wanted.feet[f].heel);
      EXPECT_EQ(library.feet[f].forward, wanted.feet[f].forward);
      EXPECT_EQ(library.feet[f].length, wanted.feet[f].length);
    }
    ASSERT_EQ(library.examples.size(), wanted.examples.size());
    for (std::size_t i = 0; i < wanted.examples.size(); ++i) {
      const auto &example = library.examples[i], &original = wanted.examples[i];
      EXPECT_EQ(example.name, original.name);
      EXPECT_EQ(example.keytimes, original.keytimes);
      EXPECT_EQ(example.parameters, original.parameters);
      EXPECT_EQ(example.mirrored, original.mirrored);
      EXPECT_EQ(example.motion.rate, original.motion.rate);
      EXPECT_THAT(example.motion.positions, ElementsAreArray(original.motion.positions));
      for (std::size_t k = 0; k < original.motion.orientations.size(); ++k) {
        expect_same(example.motion.orientations[k].cast<double>(),
                    original.motion.orientations[k].cast<double>());
      }
      ASSERT_EQ(example.contacts.size(), original.contacts.size());
      for (std::size_t c = 0; c < original.contacts.size(); ++c) {
        EXPECT_EQ(example.contacts[c].joint, original.contacts[c].joint);
        EXPECT_EQ(example.contacts[c].start, original.contacts[c].start);
        EXPECT_EQ(example.contacts[c].end, original.contacts[c].end);
        EXPECT_EQ(example.contacts[c].place, original.contacts[c].place);
      }
    }
    EXPECT_EQ(found->weights, expected.weights);
    EXPECT_EQ(found->report, expected.report);
    expect_same(found->provenance, expected.provenance);
  }
}

TEST(FrozenFiles, WritersStillWriteTheSameBytes) {
  for (const auto& sample : samples::all()) {
    EXPECT_EQ(samples::bytes_of(sample.write), bytes_of_file(kFrozen + sample.file_name))
        << sample.file_name;
  }
}

TEST(FrozenFiles, ReadingAndWritingGivesTheSameBytes) {
  EXPECT_EQ(samples::bytes_of(*anim::read(open(kFrozen + "motion.anim").bytes())),
            bytes_of_file(kFrozen + "motion.anim"));
  EXPECT_EQ(samples::bytes_of(*anim::read(open(kFrozen + "motion_xyzw.anim").bytes()), kXyzw),
            bytes_of_file(kFrozen + "motion_xyzw.anim"));
  EXPECT_EQ(samples::bytes_of(*model::read(open(kFrozen + "full.model").bytes())),
            bytes_of_file(kFrozen + "full.model"));
  EXPECT_EQ(samples::bytes_of(*model::read(open(kFrozen + "plain_xyzw.model").bytes()), kXyzw),
            bytes_of_file(kFrozen + "plain_xyzw.model"));
  EXPECT_EQ(samples::bytes_of(*cam::read(open(kFrozen + "camera.cam").bytes())),
            bytes_of_file(kFrozen + "camera.cam"));
  EXPECT_EQ(samples::bytes_of(*cam::read(open(kFrozen + "camera_xyzw.cam").bytes()), kXyzw),
            bytes_of_file(kFrozen + "camera_xyzw.cam"));
  EXPECT_EQ(samples::bytes_of(*steps::read(open(kFrozen + "fitted.steps").bytes())),
            bytes_of_file(kFrozen + "fitted.steps"));
  EXPECT_EQ(samples::bytes_of(*steps::read(open(kFrozen + "unfitted_xyzw.steps").bytes()), kXyzw),
            bytes_of_file(kFrozen + "unfitted_xyzw.steps"));
}

// --- the reader in Python, written from SPEC.md ---

bool has_python() {
  return std::system("python3 --version >/dev/null 2>&1") == 0;
}

// What a script of this folder prints as JSON; null where it fails.
json run_python(const std::string& call) {
  const std::string command = "python3 '" + test::source_folder() + "'/tests/golden/" + call;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::string text;
  char buffer[4096];
  for (std::size_t count; (count = fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
    text.append(buffer, count);
  }
  if (pclose(pipe) != 0) return {};
  return json::parse(text);
}

json read_by_python(const std::string& path) {
  return run_python("read_krok_files.py '" + path + "'");
}

// Numbers as lists, in doubles, in which floats are exact.
template <typename Vector>
json list(const Vector& values) {
  json all = json::array();
  for (const auto value : values) all.push_back(static_cast<double>(value));
  return all;
}
template <typename Vector>
json lists(const std::vector<Vector>& rows) {
  if (rows.empty()) return nullptr;
  json all = json::array();
  for (const Vector& row : rows) all.push_back(list(row));
  return all;
}

void expect_record(const json& record, const Vec3f& position, const Quatf& orientation) {
  EXPECT_EQ(record["position"], list(position));
  json rounded = json::array();
  for (const double value : record["orientation"]) rounded.push_back(static_cast<float>(value));
  EXPECT_EQ(list(rounded.get<std::vector<float>>()), list(orientation.coeffs()));
}

void expect_skeleton(const json& joints, const Skeleton& skeleton) {
  ASSERT_EQ(joints.size(), skeleton.names.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    EXPECT_EQ(joints[i]["name"], skeleton.names[i]);
    EXPECT_EQ(joints[i]["parent"], skeleton.parents[i]);
    EXPECT_EQ(joints[i]["end_site"], skeleton.end_sites[i] != 0);
    expect_record(joints[i]["reference"], skeleton.reference[i].position.cast<float>(),
                  skeleton.reference[i].orientation.cast<float>());
  }
}

void expect_stretches(const json& found, const Stretches& stretches) {
  if (stretches.empty()) {
    EXPECT_TRUE(found["stretched_joints"].is_null());
    return;
  }
  const std::size_t joints = found["skeleton"].size();
  Stretches all(stretches.size());
  for (std::size_t f = 0; f < found["stretches"].size(); ++f) {
    for (std::size_t k = 0; k < found["stretched_joints"].size(); ++k) {
      const json& u = found["stretches"][f][k];
      all[f * joints + found["stretched_joints"][k].get<std::size_t>()] = {u[0], u[1], u[2],
                                                                           u[3], u[4], u[5]};
    }
  }
  EXPECT_EQ(all, stretches);
}

void expect_anim(const json& found, const Clip& clip) {
  EXPECT_EQ(found["kind"], "anim");
  EXPECT_EQ(found["rate"], clip.rate);
  expect_skeleton(found["skeleton"], clip.skeleton);
  ASSERT_EQ(found["frames"].size(), static_cast<std::size_t>(clip.frame_count()));
  for (int i = 0; i < clip.frame_count(); ++i) {
    for (std::size_t k = 0; k < clip.skeleton.names.size(); ++k) {
      expect_record(found["frames"][static_cast<std::size_t>(i)][k], clip.frame_positions(i)[k],
                    clip.frame_orientations(i)[k]);
    }
  }
}

void expect_model(const json& found, const Model& model) {
  EXPECT_EQ(found["kind"], "model");
  expect_skeleton(found["skeleton"], model.skeleton);
  EXPECT_EQ(found["positions"], lists(model.positions));
  EXPECT_EQ(found["normals"], lists(model.normals));
  EXPECT_EQ(found["texture_coordinates"], lists(model.texture_coordinates));
  json further = json::array();
  for (const auto& set : model.more_texture_coordinates) further.push_back(lists(set));
  EXPECT_EQ(found["more_texture_coordinates"], further);
  EXPECT_EQ(found["tangents"], lists(model.tangents));
  EXPECT_EQ(found["colours"], lists(model.colours));
  std::vector<std::uint16_t> joints;
  for (const json& row : found["joints"]) joints.insert(joints.end(), row.begin(), row.end());
  EXPECT_EQ(joints, model.influence_joints);
  std::vector<float> weights;
  for (const json& row : found["weights"]) weights.insert(weights.end(), row.begin(), row.end());
  EXPECT_EQ(weights, model.influence_weights);
  EXPECT_EQ(found["triangles"], json(model.triangles));
  ASSERT_EQ(found["parts"].size(), model.parts.size());
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const Model::Part& part = model.parts[i];
    EXPECT_EQ(found["parts"][i], (json{{"name", part.name},
                                       {"material", part.material},
                                       {"first_triangle", part.first_triangle},
                                       {"triangle_count", part.triangle_count},
                                       {"mesh", part.mesh}}));
  }
}

void expect_camera(const json& found, const CameraTrack& camera) {
  EXPECT_EQ(found["kind"], "cam");
  EXPECT_EQ(found["rate"], camera.rate);
  ASSERT_EQ(found["frames"].size(), camera.positions.size());
  for (std::size_t i = 0; i < camera.positions.size(); ++i) {
    expect_record(found["frames"][i], camera.positions[i], camera.orientations[i]);
    EXPECT_EQ(found["frames"][i]["field_of_view"], static_cast<double>(camera.fields_of_view[i]));
  }
}

void expect_steps(const json& found, const steps::StepsFile& file) {
  const auto& library = file.library;
  EXPECT_EQ(found["kind"], "steps");
  EXPECT_EQ(found["rate"], library.rate);
  EXPECT_EQ(found["swing"], name_of(library.swing));
  EXPECT_EQ(found["keytimes"], json(library.keytimes));
  expect_skeleton(found["skeleton"], library.skeleton);
  for (std::size_t f = 0; f < 2; ++f) {
    const auto& foot = library.feet[f];
    EXPECT_EQ(found["feet"][f], (json{{"joint", foot.joint},
                                      {"heel", list(foot.heel)},
                                      {"forward", list(foot.forward)},
                                      {"length", foot.length}}));
  }
  ASSERT_EQ(found["parameters"].size(), library.parameters.size());
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const auto& parameter = library.parameters[d];
    EXPECT_EQ(found["parameters"][d], (json{{"quantity", static_cast<int>(parameter.quantity)},
                                            {"keytime", parameter.keytime},
                                            {"joint", parameter.joint},
                                            {"direction", static_cast<int>(parameter.direction)},
                                            {"tolerance", parameter.tolerance}}));
  }
  ASSERT_EQ(found["examples"].size(), library.examples.size());
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    const auto& example = library.examples[i];
    const json& one = found["examples"][i];
    EXPECT_EQ(one["name"], example.name);
    EXPECT_EQ(one["rate"], example.motion.rate);
    EXPECT_EQ(one["mirrored"], example.mirrored);
    EXPECT_EQ(one["keytimes"], json(example.keytimes));
    EXPECT_EQ(one["parameters"], json(example.parameters));
    ASSERT_EQ(one["frames"].size(), static_cast<std::size_t>(example.motion.frame_count()));
    for (int f = 0; f < example.motion.frame_count(); ++f) {
      for (std::size_t k = 0; k < library.skeleton.names.size(); ++k) {
        expect_record(one["frames"][static_cast<std::size_t>(f)][k],
                      example.motion.frame_positions(f)[k],
                      example.motion.frame_orientations(f)[k]);
      }
    }
    ASSERT_EQ(one["contacts"].size(), example.contacts.size());
    for (std::size_t c = 0; c < example.contacts.size(); ++c) {
      EXPECT_EQ(one["contacts"][c], (json{{"joint", example.contacts[c].joint},
                                          {"start", example.contacts[c].start},
                                          {"end", example.contacts[c].end},
                                          {"place", list(example.contacts[c].place)}}));
    }
  }
  if (!file.weights) {
    EXPECT_TRUE(found["weights"].is_null());
    return;
  }
  EXPECT_EQ(found["weights"]["kernel"], static_cast<int>(file.weights->kernel));
  EXPECT_EQ(found["weights"]["coefficients"], json(file.weights->coefficients));
  // The weights that the page's formula gives at each centre.
  const auto evaluator = rbf::WeightEvaluator::create(*file.weights);
  ASSERT_TRUE(evaluator.ok());
  for (int c = 0; c < file.weights->centre_count(); ++c) {
    std::vector<double> weights(static_cast<std::size_t>(file.weights->examples));
    evaluator->weights(file.weights->centre(c), weights);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double by_page = found["weights"]["at_centres"][static_cast<std::size_t>(c)][i];
      EXPECT_NEAR(by_page, weights[i], 1e-12);
    }
  }
}

void expect_python_agrees(const std::string& path) {
  SCOPED_TRACE(path);
  const json found = read_by_python(path);
  ASSERT_FALSE(found.is_null()) << "the reader written from SPEC.md refuses the file";
  const InputFile file = open(path);
  const std::string ending = extension(path);
  if (ending == ".anim") {
    Stretches stretches;
    expect_anim(found, *anim::read(file.bytes(), &stretches));
    expect_stretches(found, stretches);
  }
  if (ending == ".model") expect_model(found, *model::read(file.bytes()));
  if (ending == ".cam") expect_camera(found, *cam::read(file.bytes()));
  if (ending == ".steps") expect_steps(found, *steps::read(file.bytes()));
}

TEST(ReaderFromSpecification, ReadsTheFrozenFiles) {
  if (!has_python()) GTEST_SKIP() << "skipped: there is no python3";
  for (const auto& sample : samples::all()) expect_python_agrees(kFrozen + sample.file_name);
  EXPECT_EQ(read_by_python(kFrozen + "motion.anim")["provenance"]["options"][0]["value"], "cm");
}

TEST(ReaderFromSpecification, ReadsAFreshFile) {
  if (!has_python()) GTEST_SKIP() << "skipped: there is no python3";
  Clip clip = samples::clip();
  clip.resize(200);
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    const double t = 0.1 * static_cast<double>(i);
    clip.positions[i] = Vec3f(static_cast<float>(std::sin(t)), static_cast<float>(t), -1);
    clip.orientations[i] =
        Quat(std::cos(t), 0.6 * std::sin(t), 0, 0.8 * std::sin(t)).normalized().cast<float>();
  }
  const std::string path = testing::TempDir() + "krok-fresh-" + std::to_string(getpid()) + ".anim";
  ASSERT_TRUE(write_file(path, samples::bytes_of(clip)).ok());
  expect_python_agrees(path);
  std::filesystem::remove(path);
}

// What formats/model/SPEC.md says of the three methods, computed from the page alone, against
// Krok's kernels: on joints that twist by more than half a turn, and that are scaled and sheared.
TEST(SkinningFromSpecification, GivesTheVerticesOfTheLibrary) {
  if (!has_python()) GTEST_SKIP() << "skipped: there is no python3";
  Clip clip;
  clip.skeleton = samples::clip().skeleton;
  clip.resize(3);
  Stretches stretches(clip.positions.size());
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    const double t = 0.7 * static_cast<double>(i);
    clip.positions[i] = Vec3f(static_cast<float>(std::sin(t)), static_cast<float>(t), 0.25f);
    clip.orientations[i] =
        Quat(Eigen::AngleAxisd(1.3 * t, Vec3(1, 2, -1).normalized())).cast<float>();
    if (i >= 6) stretches[i] = {1.5f, 0.75f, 1.25f, 0.2f, -0.1f, 0.3f};
  }
  const Model model = samples::model();
  const std::string stem = testing::TempDir() + "krok-skin-" + std::to_string(getpid());
  ASSERT_TRUE(write_file(stem + ".model", samples::bytes_of(model)).ok());
  ASSERT_TRUE(write_file(stem + ".anim", samples::bytes_of([&](OutputFile& file) {
                           return anim::write(
                               clip, {.orientation = kXyzw, .stretches = stretches, .jobs = 1},
                               file);
                         }))
                  .ok());
  const json found = run_python("skin_by_page.py '" + stem + ".model' '" + stem + ".anim'");
  ASSERT_FALSE(found.is_null());
  for (const auto& [name, method] : {std::pair{"linear", SkinMethod::linear},
                                     {"rigid", SkinMethod::rigid},
                                     {"dual-quaternion", SkinMethod::dual_quaternion}}) {
    const SkinBinding binding(model, method);
    for (std::size_t frame = 0; frame < 3; ++frame) {
      SCOPED_TRACE(std::string(name) + ", frame " + std::to_string(frame));
      std::vector<Transform> pose(3);
      clip.get_pose(static_cast<int>(frame), pose);
      SkinPose posed(binding);
      posed.set(pose, std::span(stretches).subspan(3 * frame, 3));
      std::vector<Vec3f> positions(4), normals(4);
      skin(binding, posed, {model.positions, model.normals, {}}, {positions, normals, {}});
      for (std::size_t v = 0; v < 4; ++v) {
        const json& vertex = found[name][frame][v];
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(positions[v].data()[c], vertex[0][c], 2e-6);
          EXPECT_NEAR(normals[v].data()[c], vertex[1][c], 2e-6);
        }
      }
    }
  }
  std::filesystem::remove(stem + ".model");
  std::filesystem::remove(stem + ".anim");
}

TEST(ReaderFromSpecification, RefusesACutFile) {
  if (!has_python()) GTEST_SKIP() << "skipped: there is no python3";
  auto bytes = bytes_of_file(kFrozen + "motion.anim");
  bytes.resize(bytes.size() - 400);
  const std::string path = testing::TempDir() + "krok-cut-" + std::to_string(getpid()) + ".anim";
  ASSERT_TRUE(write_file(path, bytes).ok());
  EXPECT_TRUE(read_by_python(path).is_null());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace krok

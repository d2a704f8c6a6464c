#include "golden/samples/samples.h"

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/hash.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/character/character_format.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"

namespace krok::samples {

namespace {

Skeleton skeleton() {
  Skeleton skeleton;
  skeleton.add("Hips", Skeleton::kNoParent, {Vec3(0, 1, 0), Quat::Identity()});
  skeleton.add(
      "Kn\xC3\xA4"
      "chel 2",
      0, {Vec3(0.125, 0.5, -0.25), Quat(0.5, 0.5, -0.5, 0.5)});
  skeleton.add(
      "Kn\xC3\xA4"
      "chel 2_end",
      1, {Vec3(0.125, 0, 0.0625), Quat(0.5, 0.5, -0.5, 0.5)}, true);
  return skeleton;
}

Provenance provenance(const char* tool) {
  Provenance provenance;
  provenance.tool = tool;
  provenance.version = "0.1.0";
  provenance.sources = {{"walk \"1\".bvh", "0123456789abcdef"}, {"zw\xC3\xB6lf.bvh", ""}};
  provenance.options = {{"unit", "cm"}, {"repair", "true"}};
  provenance.conversions = {"unit: centimetres to metres (detected, certain)", "up: z to y"};
  provenance.warnings = {"2 frames were cut short [bvh-frame-count]"};
  return provenance;
}

}  // namespace

Clip clip() {
  Clip clip;
  clip.skeleton = skeleton();
  clip.rate = 30000.0 / 1001.0;
  clip.resize(2);
  clip.positions = {Vec3f(0, 1, 0),        Vec3f(0.125f, 0.5f, -0.25f), Vec3f(0.125f, 0, 0.0625f),
                    Vec3f(0.5f, 1.5f, -2), Vec3f(0.1f, 0.2f, 0.3f),     Vec3f(-1e-6f, 1e3f, 7)};
  const float tiny = 1.0f / 4096;
  clip.orientations = {Quatf(1, 0, 0, 0),
                       Quatf(0.5f, 0.5f, -0.5f, 0.5f),
                       Quatf(-0.5f, 0.5f, -0.5f, 0.5f),
                       Quatf(0, 0, 1, 0),
                       Quatf(0.8f, -0.6f, 0, 0),
                       Quatf(tiny, 0.48f, 0.64f, std::sqrt(0.36f - tiny * tiny))};
  clip.provenance = provenance("krok-import");
  return clip;
}

Model model() {
  Model model;
  model.skeleton = skeleton();
  model.positions = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0), Vec3f(0, 1, 0.5f)};
  model.normals = {Vec3f(0, 0, 1), Vec3f(0, 0, 1), Vec3f(0, 1, 0), Vec3f(0.6f, 0, 0.8f)};
  model.texture_coordinates = {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0.25f, -0.75f)};
  model.tangents = {Vec4f(1, 0, 0, 1), Vec4f(1, 0, 0, 1), Vec4f(1, 0, 0, -1), Vec4f(0, 1, 0, -1)};
  model.influences_per_vertex = 3;
  model.influence_joints = {0, 0, 0, 0, 1, 0, 1, 2, 0, 2, 1, 0};
  model.influence_weights = {1, 0, 0, 0.75f, 0.25f, 0, 0.5f, 0.25f, 0.25f, 0.5f, 0.5f, 0};
  model.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.parts = {{"body", "skin", 0, 1}, {"Sch\xC3\xBCrze", "", 1, 1}};
  model.provenance = provenance("krok-body");
  return model;
}

Model coloured_model() {
  Model model = plain_model();
  model.texture_coordinates = samples::model().texture_coordinates;
  model.more_texture_coordinates = {
      {Vec2f(0, 0), Vec2f(0.5f, 0), Vec2f(0.5f, 0.5f), Vec2f(0, 0.5f)},
      {Vec2f(2, 0.125f), Vec2f(-1, 0), Vec2f(0.75f, 1), Vec2f(0, 3)}};
  model.colours = {Vec4f(1, 0, 0, 1), Vec4f(0, 0.5f, 0.25f, 1), Vec4f(1, 1, 1, 0.75f),
                   Vec4f(0, 0, 0, 0)};
  return model;
}

Model plain_model() {
  Model model = samples::model();
  model.normals.clear();
  model.texture_coordinates.clear();
  model.tangents.clear();
  model.influences_per_vertex = 1;
  model.influence_joints = {0, 1, 2, 1};
  model.influence_weights = {1, 1, 1, 1};
  model.parts = {{"", "", 0, 2}};
  model.provenance = {};
  return model;
}

CameraTrack camera() {
  CameraTrack camera;
  camera.rate = 25;
  camera.positions = {Vec3f(0, 1.5f, 4), Vec3f(0.1f, 1.5f, 3.75f)};
  camera.orientations = {Quatf(1, 0, 0, 0), Quatf(0.96f, 0, 0.28f, 0)};
  camera.fields_of_view = {0.75f, 0.875f};
  camera.provenance = provenance("krok-cam");
  return camera;
}

steps::StepsFile step_library() {
  steps::StepsFile file;
  parametric::Library& library = file.library;
  library.skeleton = skeleton();
  library.swing = FootSide::right;
  library.feet = {parametric::FootShape{1, Vec3(0, -0.0625, 0.25), Vec3(0, 0.6, 0.8), 0.125},
                  parametric::FootShape{2, Vec3(0.1, 0, 0), Vec3(0, 0, 1), 0}};
  library.keytimes = {"stance_strike", "swing strik\xC3\xA9"};
  library.parameters = {
      {parametric::Quantity::step_length, 1, -1, parametric::Direction::along, 0.001}};
  library.rate = 120;
  for (const bool second : {false, true}) {
    parametric::Example& example = library.examples.emplace_back();
    example.name = second ? "z\xC3\xBCgig" : "slow 1";
    example.motion = clip();
    example.motion.provenance = {};
    example.keytimes = second ? std::vector{0.0, 0.03125} : std::vector{0.0078125, 0.025};
    example.mirrored = second;
    example.parameters = {second ? 0.75 : 0.5};
  }
  library.examples[1].contacts = {{2, 0.015625, 0.03, Vec3(0.125, 0, 0.1)}};
  file.weights = {rbf::Kernel::bspline,       1,           2, {0.5},          {0.75},
                  {0.5, 0.75, 0.625},         {2, 2, 0.5}, 0, {0.625, 0.375}, {1, 0, -1, 1},
                  {0, 0, 0, 0, 0.125, -0.125}};
  file.report = R"({"schema":"krok.fit/1","inserted":1})";
  file.provenance = provenance("krok-fit");
  return file;
}

steps::StepsFile unfitted_library() {
  steps::StepsFile file = step_library();
  file.library.swing = FootSide::left;
  file.library.parameters = {
      {parametric::Quantity::joint, 0, 2, parametric::Direction::across, 0.002},
      {parametric::Quantity::step_turn, 1, -1, parametric::Direction::along, 0.1},
      {parametric::Quantity::duration, 1, -1, parametric::Direction::along, 0.001}};
  for (parametric::Example& example : file.library.examples) {
    example.parameters = {-0.25, 0.1, example.keytimes[1] - example.keytimes[0]};
  }
  file.weights.reset();
  file.report.clear();
  file.provenance = {};
  return file;
}

std::vector<Material> materials() {
  const auto skin = std::make_shared<const EncodedImage>(EncodedImage{{}, "textures/skin.png", {}});
  const auto detail =
      std::make_shared<const EncodedImage>(EncodedImage{{}, "textures/d\xC3\xA9tail 1.jpg", {}});
  Material full;
  full.name = "kov \"1\"";
  full.base_color = {0.1f, 0.25f, 1.0f, 0.5f};
  full.base_color_texture = {skin, Texture::Wrap::clamp, Texture::Wrap::mirror, false};
  full.metallic = 0.125f;
  full.roughness = 0.0f;
  full.metallic_roughness_texture = {detail};
  full.normal_texture = {detail, Texture::Wrap::repeat, Texture::Wrap::clamp};
  full.normal_scale = -2.5f;
  full.occlusion_texture = {detail};
  full.occlusion_strength = 0.75f;
  full.emissive = {0.0f, 1e-5f, 0.3f};
  full.emissive_texture = {skin};
  full.alpha = Material::Alpha::mask;
  full.alpha_cutoff = 0.9f;
  full.double_sided = true;
  full.unlit = true;
  full.shaders = {"skin.vert", "skin.frag"};
  Material glass;
  glass.name = "glass";
  glass.alpha = Material::Alpha::blend;
  glass.metallic = 1.0f;
  Material plain;
  plain.name = "plain";
  Material painted;
  painted.name = "painted";
  painted.base_color = Vec4f::Ones();
  painted.base_color_texture = {skin};
  return {full, glass, plain, painted};
}

Character character() {
  const Model of = model();
  Character character;
  character.name = "\xC5\x98idi\xC4\x8D";
  character.model = "full.model";
  character.materials = {"full.material"};
  character.parts = {{of.parts[0].name, "plain"}, {of.parts[1].name, ""}};
  character.eyes = {{"left", of.skeleton.names[1], {0.031f, 1.5f, -0.0f}},
                    {"right", of.skeleton.names[1], {-0.031f, 1.5f, 1e-7f}}};
  character.morphs = "parts/face.exr";
  character.expressions = {{"smile", "", 0.1f}, {"blink", "Eyes \"closed\"", 0.0f}};
  character.role_map = "full.roles.json";
  return character;
}

Stretches stretches() {
  Stretches all(6);
  all[1] = {1.5f, 0.25f, 1, 0.125f, -0.5f, 0};
  all[4] = {-1, -2, -0.75f, 0, 0.1f, 0.0625f};
  return all;
}

std::vector<Sample> all() {
  constexpr auto kXyz = OrientationEncoding::xyz;
  constexpr auto kXyzw = OrientationEncoding::xyzw;
  return {
      {"motion.anim",
       [](OutputFile& file) { return anim::write(clip(), {.orientation = kXyz}, file); }},
      {"motion_xyzw.anim",
       [](OutputFile& file) { return anim::write(clip(), {.orientation = kXyzw}, file); }},
      {"motion_stretched.anim",
       [](OutputFile& file) { return anim::write(clip(), {.stretches = stretches()}, file); }},
      {"full.model",
       [](OutputFile& file) { return model::write(model(), {.orientation = kXyz}, file); }},
      {"plain_xyzw.model",
       [](OutputFile& file) { return model::write(plain_model(), {.orientation = kXyzw}, file); }},
      {"coloured_xyzw.model",
       [](OutputFile& file) {
         return model::write(coloured_model(), {.orientation = kXyzw}, file);
       }},
      {"camera.cam",
       [](OutputFile& file) { return cam::write(camera(), {.orientation = kXyz}, file); }},
      {"camera_xyzw.cam",
       [](OutputFile& file) { return cam::write(camera(), {.orientation = kXyzw}, file); }},
      {"fitted.steps",
       [](OutputFile& file) { return steps::write(step_library(), {.orientation = kXyz}, file); }},
      {"unfitted_xyzw.steps",
       [](OutputFile& file) {
         return steps::write(unfitted_library(), {.orientation = kXyzw}, file);
       }},
  };
}

std::vector<Sample> texts() {
  return {
      {"full.material", [](OutputFile& file) { return file.write(*material::write(materials())); }},
      {"full.character",
       [](OutputFile& file) { return file.write(*character_file::write(character())); }},
  };
}

std::vector<std::byte> bytes_of(const std::function<Status(OutputFile&)>& write) {
  static std::atomic<int> count{0};
  const std::string path =
      (std::filesystem::temp_directory_path() /
       ("krok-sample-" + std::to_string(getpid()) + "-" + std::to_string(count++)))
          .string();
  std::vector<std::byte> bytes;
  const auto done = [&]() -> Status {
    auto file = OutputFile::create(path);
    if (!file) return file.error();
    if (Status status = write(*file); !status) return status;
    if (Status status = file->commit(); !status) return status;
    const auto back = InputFile::open(path);
    if (!back) return back.error();
    bytes.assign(back->bytes().begin(), back->bytes().end());
    return {};
  }();
  std::filesystem::remove(path);
  if (!done) {
    std::fprintf(stderr, "a sample cannot be written: %s\n", done.error().message.c_str());
    std::abort();
  }
  return bytes;
}

std::vector<std::byte> bytes_of(const Clip& clip, OrientationEncoding encoding) {
  return bytes_of(
      [&](OutputFile& file) { return anim::write(clip, {.orientation = encoding}, file); });
}

std::vector<std::byte> bytes_of(const Model& model, OrientationEncoding encoding) {
  return bytes_of(
      [&](OutputFile& file) { return model::write(model, {.orientation = encoding}, file); });
}

std::vector<std::byte> bytes_of(const CameraTrack& camera, OrientationEncoding encoding) {
  return bytes_of(
      [&](OutputFile& file) { return cam::write(camera, {.orientation = encoding}, file); });
}

std::vector<std::byte> bytes_of(const steps::StepsFile& steps, OrientationEncoding encoding) {
  return bytes_of(
      [&](OutputFile& file) { return steps::write(steps, {.orientation = encoding}, file); });
}

void repair_header(std::vector<std::byte>& file) {
  if (file.size() < 64) return;
  const std::uint64_t size = file.size();
  std::memcpy(&file[16], &size, sizeof size);
  std::memset(&file[24], 0, 8);
  std::uint32_t sections = 0;
  std::memcpy(&sections, &file[32], sizeof sections);
  const std::uint64_t head = 64 + std::uint64_t{32} * sections;
  if (head > size) return;
  Xxh3Stream stream;
  stream.update(std::span(file).subspan(head));
  stream.update(std::span(file).first(head));
  const std::uint64_t checksum = stream.digest();
  std::memcpy(&file[24], &checksum, sizeof checksum);
}

}  // namespace krok::samples

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/fbx_elements_internal.h"

namespace krok::assimp {

using namespace nodes;
using registry::Kind;

namespace {

bool has_skin(const Scene& scene) {
  return !scene.skins.empty();
}

std::string list_of(const std::vector<std::string>& things) {
  std::string list;
  for (std::size_t k = 0; k < things.size(); ++k) {
    if (k > 0) list += k + 1 == things.size() ? " and " : ", ";
    list += things[k];
  }
  return list;
}

// The longest time, in seconds, in which a value changes from one key to the next.
double longest_gap(const Scene& scene) {
  constexpr float kChange = 1e-3f;
  float longest = 0;
  for (const Animation& animation : scene.animations) {
    for (const Channel& channel : animation.channels) {
      const std::vector<float>& times = *channel.times;
      const auto width = static_cast<std::size_t>(channel.width);
      for (std::size_t i = width; i < times.size() * width; ++i) {
        const float before = (*channel.values)[i - width], after = (*channel.values)[i];
        if (std::abs(after - before) <= kChange * std::max(1.0f, std::abs(before))) continue;
        longest = std::max(longest, times[i / width] - times[i / width - 1]);
      }
    }
  }
  return static_cast<double>(longest);
}

}  // namespace

// Assimp identifies nodes by name: bones and curves refer to the first node of a name.
void report_same_names(Conversion& to) {
  std::map<std::string, int> uses;
  for (const Node& node : to.scene.nodes) ++uses[node.name];
  std::set<std::string> doubtful;
  const auto check = [&](const aiString& name) {
    const auto found = uses.find(to_text(name));
    if (found != uses.end() && found->second > 1) doubtful.insert(found->first);
  };
  for (unsigned m = 0; m < to.source.mNumMeshes; ++m) {
    const aiMesh& mesh = *to.source.mMeshes[m];
    for (unsigned b = 0; b < mesh.mNumBones; ++b) check(mesh.mBones[b]->mName);
  }
  for (unsigned a = 0; a < to.source.mNumAnimations; ++a) {
    const aiAnimation& animation = *to.source.mAnimations[a];
    for (unsigned c = 0; c < animation.mNumChannels; ++c) check(animation.mChannels[c]->mNodeName);
  }
  if (doubtful.empty()) return;
  to.warn("assimp-same-name",
          fmt::format("{} names are used by several nodes, such as '{}'; Assimp assigns weights "
                      "and animation to the first, which may be the wrong one",
                      doubtful.size(), *doubtful.begin()),
          "give the joints unique names and export again");
}

// Assimp names nodes by their ids, such as "Armature_Hips"; users and role tables use the names.
void rename_collada_nodes(Conversion& to) {
  if (to.kind != Kind::collada) return;
  const auto names = collada_node_names(to.text);
  std::map<std::string, int> uses;
  const auto new_name = [&](const std::string& old) {
    const auto found = names.find(old);
    return found == names.end() ? old : found->second;
  };
  for (const Node& node : to.scene.nodes) ++uses[new_name(node.name)];
  for (Node& node : to.scene.nodes) {
    const std::string name = new_name(node.name);
    if (uses[name] == 1) node.name = name;
  }
}

void report_takes(Conversion& to) {
  if (to.kind != Kind::fbx) return;
  const std::size_t layers = fbx_object_count(to.text, "AnimationLayer");
  const std::size_t takes = fbx_object_count(to.text, "AnimationStack");
  const std::size_t read = to.scene.animations.size();
  if (read > 0 && read < takes) {
    to.warn("assimp-takes",
            fmt::format("{} of {} takes move nothing and are left out", takes - read, takes));
  }
  if (layers <= takes) return;
  to.warn("assimp-layers",
          fmt::format("{} animation layers for {} takes; Assimp merges their curves and ignores "
                      "their blend modes",
                      layers, takes),
          "if the motion looks wrong, merge the layers before exporting");
}

void report_curves(Conversion& to, const std::optional<Resampling>& resampling) {
  if (resampling && resampling->rate > 0) {
    const bool holds = resampling->degrees <= kCurveDegrees && resampling->metres <= kCurveMetres;
    const std::string message = fmt::format(
        "curves were resampled at {:.6g} keys per second; between them, rotations deviate by up to "
        "{:.2g} degrees and translations by up to {:.2g} mm",
        resampling->rate, resampling->degrees, resampling->metres * 1e3);
    holds ? to.note("assimp-curves", message) : to.warn("assimp-curves", message);
    // Its keys are more than frames: a motion has those that the curves were made for.
    for (nodes::Animation& animation : to.scene.animations) animation.rate = resampling->frames;
  }
  constexpr double kLongGap = 1.0 / 14;  // seconds
  const bool read = resampling ? resampling->gap < kLongGap
                               : to.kind != Kind::fbx && to.kind != Kind::max_3ds &&
                                     (to.kind != Kind::ase ||
                                      (to.text.find("_BEZIER_") == std::string_view::npos &&
                                       to.text.find("_TCB_") == std::string_view::npos));
  const double gap = resampling ? resampling->gap : longest_gap(to.scene);
  if (read || gap < kLongGap) return;
  to.warn("assimp-curves",
          fmt::format("curves between keys up to {:.3g} s apart cannot be read; they are "
                      "interpolated linearly",
                      gap),
          "if the motion looks stiff, export with the animation baked to every frame");
}

void report_what_is_missing(Conversion& to) {
  const Scene& scene = to.scene;
  std::vector<std::string> missing;
  if (scene.meshes.empty()) missing.emplace_back("no mesh");
  if (!has_skin(scene) && !scene.meshes.empty()) missing.emplace_back("no skin weights");
  if (scene.animations.empty()) missing.emplace_back("no animation");
  if (scene.cameras.empty()) missing.emplace_back("no camera");
  if (!missing.empty()) {
    to.note("assimp-missing", fmt::format("the file has {}", list_of(missing)));
  }
  if (to.kind == Kind::max_3ds || (to.kind == Kind::ase && !has_skin(scene))) {
    to.note("assimp-no-skeleton",
            fmt::format("the {} format has no skeletons; its nodes are objects",
                        to.kind == Kind::ase ? "ASE" : "3DS"));
  }
  if (to.kind == Kind::smd && !scene.animations.empty()) {
    to.note("assimp-rate", fmt::format("SMD files do not store their frame rate; {:g} frames per "
                                       "second are assumed",
                                       to.frames_per_second));
  }
}

}  // namespace krok::assimp

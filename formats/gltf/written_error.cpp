#include "formats/gltf/reduce_for_mesh.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "core/index.h"
#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"

namespace krok::gltf {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Where the file has a vertex.
struct Link {
  std::uint32_t instance = kNone, vertex = 0;
};

// [vertices of the original]. Primitives have a range of the model's vertices, or all of them.
Result<std::vector<Link>> links_of(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                   const OriginalRig& original, const WrittenRig& written) {
  std::vector<Link> links(written.model.positions.size());
  std::uint32_t instance = 0;
  const Error other("gltf-mesh", "the written file does not have the triangles of the rig");
  for (const Model::Part& part : written.model.parts) {
    if (part.triangle_count == 0) continue;
    while (instance < evaluator.instances().size() &&  // what joints carry
           scene.nodes[at(evaluator.instances()[instance].node)].skin < 0) {
      ++instance;
    }
    if (instance == evaluator.instances().size()) return other;
    const nodes::Primitive& shape = evaluator.primitive(evaluator.instances()[instance]);
    if (shape.triangles.size() != part.triangle_count) return other;
    std::uint32_t first = kNone, first_there = kNone;
    const auto triangles =
        std::span(written.model.triangles).subspan(part.first_triangle, part.triangle_count);
    for (const auto& triangle : triangles) first = std::min(first, std::ranges::min(triangle));
    for (const auto& triangle : shape.triangles) {
      first_there = std::min(first_there, std::ranges::min(triangle));
    }
    for (const auto& triangle : triangles) {
      for (const std::uint32_t corner : triangle) {
        const std::uint32_t there = corner - first + first_there;
        if (there >= shape.vertex_count()) return other;
        if (links[corner].instance == kNone) links[corner] = {instance, there};
      }
    }
    ++instance;
  }
  if (written.places.empty()) return links;
  std::vector<Link> result(original.model.positions.size());
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = links[written.places[v]];
  return result;
}

}  // namespace

Result<WrittenError> written_error(const std::string& path, const OriginalRig& original,
                                   const WrittenRig& written, int jobs) {
  const auto scene = read_file(path);
  if (!scene) return scene.error();
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return evaluator.error();
  const auto links = links_of(*scene, *evaluator, original, written);
  if (!links) return links.error();
  WrittenError worst;
  std::size_t next = 0;
  for (std::size_t i = 0; i < original.clips.size(); ++i) {
    const NamedTracks& clip = original.clips[i];
    // Clips in which nothing changes are not in the file.
    const bool is_there =
        next < scene->animations.size() && scene->animations[next].name == clip.name;
    const int animation = is_there ? static_cast<int>(next++) : -1;
    const double rate = clip.tracks->times.empty() && clip.weights != nullptr ? clip.weights->rate
                                                                              : clip.tracks->rate;
    const ShownMesh in_file = [&, animation, rate] {
      return [&, animation, rate, shown = std::make_shared<nodes::Evaluation>()](
                 int moment, std::span<Vec3f> positions) {
        evaluator->evaluate(animation, 0.5 * moment / rate, *shown);
        for (std::size_t v = 0; v < positions.size(); ++v) {
          const Link& link = (*links)[v];
          if (link.instance == kNone) {
            positions[v].setConstant(std::numeric_limits<float>::quiet_NaN());
          } else {
            positions[v] = shown->positions[link.instance][link.vertex].cast<float>();
          }
        }
      };
    };
    const bool changes_shape = clip.weights != nullptr && original.morphs.target_count() > 0;
    const MeshError error = mesh_error({original.model, changes_shape ? &original.morphs : nullptr,
                                        changes_shape ? clip.weights : nullptr},
                                       *clip.tracks, in_file, jobs);
    if (i == 0 || error.largest > worst.error.largest) worst = {error, i};
  }
  return worst;
}

}  // namespace krok::gltf

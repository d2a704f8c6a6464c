#include "tools/krok-diff/difference_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/gltf/gltf_writer.h"
#include "tools/cli/output_set.h"

namespace krok::cli::diff {

namespace {

constexpr render::Colour kNotCompared = render::colour(0x3A3F45);

// glTF colours are linear; those of images and of this code are sRGB (IEC 61966-2-1).
float linear(std::uint8_t channel) {
  const double value = channel / 255.0;
  return static_cast<float>(value <= 0.04045 ? value / 12.92
                                             : std::pow((value + 0.055) / 1.055, 2.4));
}

Vec3f linear(render::Colour colour) {
  return {linear(colour.red), linear(colour.green), linear(colour.blue)};
}

// The first scene at the time of the max distance, or at its start.
SceneState pose_of(const Scene& first, const compare::SceneDifference& found) {
  int animation = -1;
  double time = 0;
  if (!first.animations.empty()) {
    const compare::ValueLocation& worst = found.positions.where;
    const bool known = found.positions.largest > 0 && worst.frame >= 0;
    animation = known ? std::max(0, worst.animation) : 0;
    const auto& keys = first.animations[static_cast<std::size_t>(animation)].key_times;
    time = known ? worst.time : keys.empty() ? 0.0 : keys.front();
  }
  SceneState state;
  first.evaluate(animation, time, state);
  return state;
}

// The data of one mesh.
struct MeshColours {
  std::vector<Vec3f> positions, normals, colours;
};

std::vector<Vec3f> floats(const std::vector<Vec3>& vectors) {
  std::vector<Vec3f> result;
  result.reserve(vectors.size());
  for (const Vec3& vector : vectors) result.push_back(vector.cast<float>());
  return result;
}

MeshColours colours_of(std::size_t mesh, const SceneState& state,
                       const compare::SceneDifference& found, const DistanceColours& scale) {
  MeshColours result;
  result.positions = floats(state.positions[mesh]);
  if (mesh < state.normals.size()) result.normals = floats(state.normals[mesh]);
  const auto& distances = found.vertex_largest[mesh];
  if (distances.size() != result.positions.size()) {
    result.colours.assign(result.positions.size(), linear(kNotCompared));
  }
  for (std::size_t v = result.colours.size(); v < result.positions.size(); ++v) {
    result.colours.push_back(linear(scale.at(static_cast<double>(distances[v]))));
  }
  return result;
}

std::string legend_of(const DistanceColours& scale, bool within, bool some_not_compared) {
  // Each in a suitable unit.
  const auto text = [&](double value) {
    const double metres = value / scale.in_a_metre;
    const DistanceColours own = distance_colours(0, metres);
    return readable(metres * own.in_a_metre, 3) + " " + own.key.unit;
  };
  std::string legend =
      within ? fmt::format("distance: grey, all within {}", text(scale.key.low))
             : fmt::format("distance: grey up to {}, then blue, yellow at {}, red at {}",
                           text(scale.key.low), text(0.5 * scale.key.high), text(scale.key.high));
  return legend + (some_not_compared ? "; dark: not compared" : "");
}

}  // namespace

Status write_heatmap(const Scene& first, const compare::SceneDifference& found,
                     const std::string& path, ToolContext& context) {
  const bool compared = std::any_of(found.vertex_largest.begin(), found.vertex_largest.end(),
                                    [](const std::vector<float>& mesh) { return !mesh.empty(); });
  if (!compared) {
    context.warn("diff-heatmap", fmt::format("{} is not written: no mesh was compared", path));
    return {};
  }
  const DistanceColours scale =
      distance_colours(found.positions.tolerance, found.positions.largest);
  const SceneState state = pose_of(first, found);
  std::vector<MeshColours> colours;
  bool some_not_compared = false;
  for (std::size_t mesh = 0; mesh < first.meshes.size(); ++mesh) {
    colours.push_back(colours_of(mesh, state, found, scale));
    some_not_compared =
        some_not_compared || found.vertex_largest[mesh].size() != first.meshes[mesh].vertex_count;
  }
  std::vector<gltf::ColouredMesh> meshes;
  for (std::size_t mesh = 0; mesh < first.meshes.size(); ++mesh) {
    const SceneMesh& from = first.meshes[mesh];
    const std::string name = from.name.empty() ? fmt::format("mesh {}", mesh) : from.name;
    meshes.push_back({name, colours[mesh].positions, colours[mesh].normals, colours[mesh].colours,
                      from.triangles, from.mesh_name});
  }
  const std::string legend = legend_of(scale, found.positions.within(), some_not_compared);
  gltf::WriteOptions options;
  options.binary = extension(path) != ".gltf";
  options.provenance = context.provenance();
  const Status status = write_output(context, path, [&](OutputFile& file) {
    return gltf::write_coloured(meshes, legend, options, file);
  });
  if (status) context.log(fmt::format("{}: {}", path, legend));
  return status;
}

Status write_heatmap(const Scene& first, const Scene& second, const compare::SceneOptions& options,
                     const std::string& path, ToolContext& context) {
  compare::SceneOptions how = options;
  how.keep_vertices = true;
  const auto found = compare::difference(first, second, how, context.jobs, *context.progress);
  if (!found) return found.error();
  return write_heatmap(first, *found, path, context);
}

}  // namespace krok::cli::diff

#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/gltf/document_internal.h"
#include "formats/gltf/joint_tracks.h"
#include "math/vector_arrays.h"

namespace krok::gltf {

namespace {

// Tangent displacements have three components, as w does not change. Packed in place.
void subtract_and_pack(std::span<const Vec4f> base, std::span<Vec4f> tangents) {
  float* to = tangents.empty() ? nullptr : tangents.front().data();
  for (std::size_t v = 0; v < tangents.size(); ++v, to += 3) {
    const Vec3f moved = tangents[v].head<3>() - base[v].head<3>();
    std::copy_n(moved.data(), 3, to);
  }
}

std::span<const std::byte> packed_bytes(std::span<const Vec4f> tangents) {
  return std::as_bytes(tangents).first(tangents.size() * 3 * sizeof(float));
}

// Only its textures show tangents, which take a third of a baked motion.
bool has_normal_texture(const Model& model, std::span<const Material> materials) {
  return std::ranges::any_of(model.parts, [&](const Model::Part& part) {
    const Material* const material = find_material(materials, part.material);
    return part.triangle_count > 0 && material != nullptr && material->normal_texture;
  });
}

Error not_finite(int frame) {
  return Error("gltf-structure", fmt::format("a vertex of frame {} is not finite", frame));
}

// Writes one baked clip.
class BakedClip {
 public:
  BakedClip(const Model& model, const MeshMotion& motion, const WriteOptions& options,
            Progress* progress, int jobs)
      : model_(model),
        motion_(motion),
        options_(options),
        progress_(progress),
        jobs_(jobs),
        document_(options),
        bounds_(static_cast<std::size_t>(motion.frames) - 1) {}

  Status write(std::span<const float> times, OutputFile& file) {
    if (Status status = add_first_frame(); !status) return status;
    if (targets() == 0) return document_.write(file);
    promise_targets(times);
    const bool twice = options_.binary && !file.can_overwrite();
    if (progress_ != nullptr) {
      progress_->begin("baking frames", static_cast<std::uint64_t>(targets()) * (twice ? 2 : 1));
    }
    if (twice) {
      const Status status = go_through([](auto) { return Status(); });
      if (!status) return status;
    }
    std::span<const Document::Bounds> known;
    if (twice) known = bounds_;
    if (Status status = document_.begin(file, known); !status) return status;
    std::vector<std::span<const std::byte>> bytes;
    const Status status = go_through([&](std::span<const ShapeRoom> shapes) {
      bytes.clear();
      for (const ShapeRoom& shape : shapes) {
        bytes.push_back(std::as_bytes(std::span(shape.positions)));
        bytes.push_back(std::as_bytes(std::span(shape.normals)));
        bytes.push_back(packed_bytes(shape.tangents));
      }
      return document_.append(bytes);
    });
    if (!status) return status;
    if (Status step = append_weights(); !step) return step;
    return document_.end(bounds_);
  }

 private:
  std::size_t targets() const { return bounds_.size(); }

  bool with_tangents() const {
    return motion_.tangents && has_normal_texture(model_, options_.materials);
  }

  Status add_first_frame() {
    base_.positions.resize(model_.positions.size());
    base_.normals.resize(model_.normals.size());
    base_.tangents.resize(with_tangents() ? model_.positions.size() : 0);
    motion_.source()(0, base_.place());
    if (!all_finite(base_.positions) || !all_finite(base_.normals) || !all_finite(base_.tangents)) {
      return not_finite(0);
    }
    const auto attributes =
        add_shape(document_, model_, {base_.positions, base_.normals, base_.tangents});
    auto meshes = document_.add_meshes(model_, attributes, -1, mesh_name(options_));
    if (!meshes) return meshes.error();
    meshes_ = *std::move(meshes);
    return {};
  }

  void promise_targets(std::span<const float> times) {
    const int input = document_.add_floats(times, TINYGLTF_TYPE_SCALAR, Document::Use::data, true);
    std::vector<std::map<std::string, int>> morph(targets());
    std::vector<std::string> names;
    for (auto& target : morph) {
      target["POSITION"] = document_.promise_positions(base_.positions.size());
      if (!base_.normals.empty()) {
        target["NORMAL"] = document_.promise_floats(base_.normals.size(), TINYGLTF_TYPE_VEC3,
                                                    Document::Use::vertices);
      }
      if (!base_.tangents.empty()) {
        target["TANGENT"] = document_.promise_floats(base_.tangents.size(), TINYGLTF_TYPE_VEC3,
                                                     Document::Use::vertices);
      }
      names.push_back(fmt::format("frame_{}", names.size() + 1));
    }
    document_.set_targets(meshes_, morph, names);
    const int weights = document_.promise_floats(times.size() * targets(), TINYGLTF_TYPE_SCALAR,
                                                 Document::Use::data);
    document_.add_weight_channels(meshes_, input, weights,
                                  options_.clip_name.empty() ? options_.name : options_.clip_name);
  }

  // Computes all targets and their bounds.
  Status go_through(const std::function<Status(std::span<const ShapeRoom>)>& take) {
    const ShapeRange range{1, motion_.frames, base_.positions.size(), !base_.normals.empty(),
                           !base_.tangents.empty()};
    return make_shapes(
        motion_, range, jobs_, [&](int frame, ShapeRoom& shape) { return prepare(frame, shape); },
        [&](int, std::span<const ShapeRoom> shapes) {
          if (progress_ != nullptr) progress_->advance(shapes.size());
          return take(shapes);
        });
  }

  Status prepare(int frame, ShapeRoom& shape) {
    const VectorBounds positions = subtract(base_.positions, shape.positions);
    const VectorBounds normals = subtract(base_.normals, shape.normals);
    const bool tangents_finite = all_finite(shape.tangents);
    if (!positions.finite || !normals.finite || !tangents_finite) return not_finite(frame);
    subtract_and_pack(base_.tangents, shape.tangents);
    bounds_[static_cast<std::size_t>(frame) - 1] = {positions.least, positions.most};
    return {};
  }

  // At each frame's time, only that frame's target has weight 1.
  Status append_weights() {
    std::vector<float> row(targets(), 0.0f);
    Status status = document_.append(std::as_bytes(std::span(row)));
    for (std::size_t t = 0; t < targets() && status; ++t) {
      row[t] = 1.0f;
      status = document_.append(std::as_bytes(std::span(row)));
      row[t] = 0.0f;
    }
    return status;
  }

  const Model& model_;
  const MeshMotion& motion_;
  const WriteOptions& options_;
  Progress* progress_;
  int jobs_;
  Document document_;
  ShapeRoom base_;
  std::vector<Document::MeshNode> meshes_;
  std::vector<Document::Bounds> bounds_;
};

}  // namespace

std::uint64_t baked_bytes(const Model& model, std::int64_t frames,
                          std::span<const Material> materials) {
  const std::uint64_t vertex =
      (model.normals.empty() ? 12 : 24) +
      (!model.tangents.empty() && has_normal_texture(model, materials) ? 12 : 0);
  const auto count = static_cast<std::uint64_t>(std::max<std::int64_t>(frames, 1));
  return count * model.positions.size() * vertex + count * (count - 1) * sizeof(float);
}

Status write_baked(const Model& model, const MeshMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress, int jobs) {
  if (Status status = check_mesh(model); !status) return status;
  if (motion.frames < 1) return Error("gltf-structure", "the motion has no frames");
  const auto times = key_times(motion.frames, motion.rate);
  if (!times) return times.error();
  return BakedClip(model, motion, options, progress, jobs).write(*times, file);
}

}  // namespace krok::gltf

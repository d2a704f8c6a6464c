#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/hash.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/json_text_internal.h"
#include "math/types.h"

namespace krok::gltf {

namespace {

int components_of(int type) {
  return tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type));
}

tinygltf::Value text_list(const std::vector<std::string>& texts) {
  tinygltf::Value::Array list;
  for (const std::string& text : texts) list.emplace_back(text);
  return tinygltf::Value(list);
}

tinygltf::Value provenance_value(const Provenance& provenance) {
  tinygltf::Value::Object value;
  value["tool"] = tinygltf::Value(provenance.tool);
  value["version"] = tinygltf::Value(provenance.version);
  tinygltf::Value::Array sources;
  for (const auto& source : provenance.sources) {
    sources.emplace_back(tinygltf::Value::Object{{"name", tinygltf::Value(source.name)},
                                                 {"xxh3", tinygltf::Value(source.xxh3)}});
  }
  if (!sources.empty()) value["sources"] = tinygltf::Value(sources);
  tinygltf::Value::Object options;
  for (const auto& [name, given] : provenance.options) options[name] = tinygltf::Value(given);
  if (!options.empty()) value["options"] = tinygltf::Value(options);
  if (!provenance.conversions.empty()) value["conversions"] = text_list(provenance.conversions);
  if (!provenance.warnings.empty()) value["warnings"] = text_list(provenance.warnings);
  return tinygltf::Value(tinygltf::Value::Object{{"provenance", tinygltf::Value(value)}});
}

// extras of an animation. Keys may be fewer than frames, and none at all of their frames' rate.
// What an engine adds to a motion in place: metres and degrees per second.
tinygltf::Value animation_extras(const JointTracks& tracks) {
  tinygltf::Value::Object extras{{kRate, tinygltf::Value(tracks.rate)}};
  if (const auto& removed = tracks.removed_root_motion) {
    tinygltf::Value::Array velocity;
    for (const double part : removed->velocity) velocity.emplace_back(part);
    extras["velocity"] = tinygltf::Value(std::move(velocity));
    extras["speed"] = tinygltf::Value(removed->velocity.norm());
    extras["turnRate"] = tinygltf::Value(removed->turn_rate / kRadiansPerDegree);
  }
  return tinygltf::Value(std::move(extras));
}

template <typename Vector>
std::vector<double> as_list(const Vector& values) {
  return {values.data(), values.data() + values.size()};
}

void set_rest(const JointTrack& track, tinygltf::Node& node) {
  if (!track.rest_translation.isZero(0)) node.translation = as_list(track.rest_translation);
  if (track.rest_rotation.w() != 1.0f) node.rotation = as_list(track.rest_rotation.coeffs());
}

}  // namespace

Document::Document(const WriteOptions& options) : options_(options) {
  const Provenance& provenance = options.provenance;
  gltf.asset.version = "2.0";
  gltf.asset.generator =
      provenance.version.empty() ? "krok" : fmt::format("krok {}", provenance.version);
  if (!provenance.tool.empty()) gltf.asset.extras = provenance_value(provenance);
  gltf.scenes.resize(1);
  gltf.defaultScene = 0;
}

std::vector<std::byte>& Document::own_part() {
  const bool is_own = !parts_.empty() && parts_.back().view.empty() && parts_.back().to_read == 0;
  if (!is_own) parts_.emplace_back();
  return parts_.back().own;
}

int Document::add_accessor(std::span<const std::byte> bytes, int component,
                           std::size_t component_size, int type, Use use, Keep keep,
                           Filter filter) {
  assert(promised_ == 0);
  const int next = static_cast<int>(gltf.accessors.size());
  // Tracks of joints that stay, or of fingers that turn together, are often the same.
  if (options_.compressed && use == Use::data) {
    const auto [known, made] = known_.try_emplace({component, type, filter, xxh3(bytes)}, next);
    if (!made && std::ranges::equal(bytes_of(gltf.accessors[known->second]), bytes)) {
      return known->second;
    }
  }
  add_accessor_of(bytes.size(), component, component_size, type, use);
  put(bytes, keep);
  if (filter != Filter::none) filters_[gltf.accessors.back().bufferView] = filter;
  return next;
}

void Document::put(std::span<const std::byte> bytes, Keep keep) {
  if (keep == Keep::view && bytes.size() % 4 == 0) {
    parts_.emplace_back().view = bytes;
    size_ += bytes.size();
  } else {
    std::vector<std::byte>& own = own_part();
    const std::size_t before = own.size();
    own.insert(own.end(), bytes.begin(), bytes.end());
    own.resize((own.size() + 3) / 4 * 4, std::byte{0});
    size_ += own.size() - before;
  }
}

int Document::add_accessor_of(std::size_t bytes, int component, std::size_t component_size,
                              int type, Use use) {
  const std::size_t element_size = component_size * static_cast<std::size_t>(components_of(type));
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = size_;
  view.byteLength = bytes;
  if (use == Use::vertices) {
    view.target = TINYGLTF_TARGET_ARRAY_BUFFER;
    view.byteStride = element_size;
  } else if (use == Use::indices) {
    view.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
  }
  gltf.bufferViews.push_back(std::move(view));

  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(gltf.bufferViews.size()) - 1;
  accessor.byteOffset = 0;
  accessor.componentType = component;
  accessor.count = bytes / element_size;
  accessor.type = type;
  gltf.accessors.push_back(std::move(accessor));
  return static_cast<int>(gltf.accessors.size()) - 1;
}

int Document::add_floats(std::span<const float> values, int type, Use use, bool bounds, Keep keep) {
  const int accessor = add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT,
                                    sizeof(float), type, use, keep);
  if (bounds) {
    const auto components = static_cast<std::size_t>(components_of(type));
    std::vector<double> least(values.begin(), values.begin() + static_cast<long>(components));
    std::vector<double> most = least;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[i];
      double& low = least[i % components];
      double& high = most[i % components];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    gltf.accessors[accessor].minValues = std::move(least);
    gltf.accessors[accessor].maxValues = std::move(most);
  }
  return accessor;
}

int Document::add_strided(std::span<const std::byte> bytes, std::size_t stride, int component,
                          int type, bool normalized) {
  const int index = add_accessor(bytes, component, stride / 4, TINYGLTF_TYPE_VEC4, Use::vertices);
  tinygltf::Accessor& accessor = gltf.accessors[static_cast<std::size_t>(index)];
  accessor.type = type;
  accessor.normalized = normalized;
  return index;
}

int Document::add_filtered(std::span<const std::byte> bytes, int type, Filter filter, Use use) {
  if (filter == Filter::octahedral) {
    const int index = add_strided(bytes, 4, TINYGLTF_COMPONENT_TYPE_BYTE, type, true);
    filters_[gltf.accessors[static_cast<std::size_t>(index)].bufferView] = filter;
    return index;
  }
  const bool is_short = filter == Filter::quaternion;
  const int index =
      add_accessor(bytes, is_short ? TINYGLTF_COMPONENT_TYPE_SHORT : TINYGLTF_COMPONENT_TYPE_FLOAT,
                   is_short ? sizeof(std::int16_t) : sizeof(float), type, use, Keep::copy, filter);
  gltf.accessors[static_cast<std::size_t>(index)].normalized = is_short;
  return index;
}

int Document::add_rotations(std::span<const Quatf> rotations, int bits) {
  const bool filtered = options_.compressed && options_.binary;
  if (bits <= JointTrack::kShortBits && filtered) {
    const std::vector<std::int16_t> shorts = quaternion(rotations, bits);
    return add_filtered(std::as_bytes(std::span(shorts)), TINYGLTF_TYPE_VEC4, Filter::quaternion,
                        Use::data);
  }
  const std::span<const float> components{rotations.data()->coeffs().data(), rotations.size() * 4};
  if (bits <= JointTrack::kShortBits) {
    std::vector<std::int16_t> shorts;
    for (const float component : components) {
      shorts.push_back(static_cast<std::int16_t>(std::lround(component * 32767.0f)));
    }
    const int index = add_accessor(std::as_bytes(std::span(shorts)), TINYGLTF_COMPONENT_TYPE_SHORT,
                                   sizeof(std::int16_t), TINYGLTF_TYPE_VEC4, Use::data);
    gltf.accessors[static_cast<std::size_t>(index)].normalized = true;
    return index;
  }
  if (bits < JointTrack::kExact && filtered) {
    if (const auto steps = exponential(components, 1 - bits)) {
      return add_filtered(std::as_bytes(std::span(*steps)), TINYGLTF_TYPE_VEC4, Filter::exponential,
                          Use::data);
    }
  }
  return add_floats(components, TINYGLTF_TYPE_VEC4, Use::data, false, Keep::view);
}

int Document::add_translations(std::span<const Vec3f> translations, int exponent) {
  if (exponent != JointTrack::kExact && options_.compressed && options_.binary) {
    if (const auto steps =
            exponential({translations.data()->data(), translations.size() * 3}, exponent)) {
      return add_filtered(std::as_bytes(std::span(*steps)), TINYGLTF_TYPE_VEC3, Filter::exponential,
                          Use::data);
    }
  }
  return add_vector_keys(translations);
}

int Document::add_vector_keys(std::span<const Vec3f> values) {
  return add_floats({values.data()->data(), values.size() * 3}, TINYGLTF_TYPE_VEC3, Use::data,
                    false, Keep::view);
}

int Document::add_positions(std::span<const Vec3f> values, Use use) {
  return add_floats({values.data()->data(), values.size() * 3}, TINYGLTF_TYPE_VEC3, use, true);
}

int Document::add_vectors(std::span<const Vec3f> values, Use use) {
  return add_floats({values.data()->data(), values.size() * 3}, TINYGLTF_TYPE_VEC3, use, false);
}

int Document::add_integers(std::span<const std::uint32_t> values, int type, std::uint32_t largest,
                           Use use) {
  // The narrowest type for the largest value; as indices, 255 and 65535 are reserved (primitive
  // restart). Bytes only for joints: four of them have the alignment that vertices need.
  if (use == Use::vertices && largest < 256) {
    std::vector<std::uint8_t> narrow(values.begin(), values.end());
    return add_accessor(std::as_bytes(std::span(narrow)), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, 1,
                        type, use);
  }
  if (largest < 65535) {
    std::vector<std::uint16_t> narrow(values.begin(), values.end());
    return add_accessor(std::as_bytes(std::span(narrow)), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 2,
                        type, use);
  }
  return add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 4, type, use);
}

std::string Document::unique_node_name(const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; !node_names_.insert(name).second; ++i) name = fmt::format("{}_{}", wanted, i);
  return name;
}

void Document::add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                           int values) {
  auto& samplers = animation.samplers;
  // Looked up in the animation itself: weights are added to each after the joints of all.
  const auto known = std::ranges::find_if(samplers, [&](const tinygltf::AnimationSampler& one) {
    return one.input == times && one.output == values;
  });
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(known - samplers.begin());
  if (known == samplers.end()) {
    tinygltf::AnimationSampler& sampler = samplers.emplace_back();
    sampler.input = times;
    sampler.output = values;
    sampler.interpolation = "LINEAR";
  }
  channel.target_node = node;
  channel.target_path = path;
  animation.channels.push_back(std::move(channel));
}

int Document::add_skeleton(const Skeleton& skeleton, std::span<const NamedTracks> clips,
                           const std::string& name, const Mat4& stored_to_model) {
  const int first = static_cast<int>(gltf.nodes.size());
  const JointTracks rest = clips.empty() ? rest_tracks(skeleton) : *clips.front().tracks;
  const auto is_sheared = [&](int j) {
    return std::ranges::any_of(clips, [&](const NamedTracks& clip) {
      return !clip.tracks->joints[j].inner_rotations.empty();
    });
  };
  outer_.clear();
  int outer_count = 0;
  std::vector<float> inverse_reference;
  tinygltf::Skin skin;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    tinygltf::Node node;
    node.name = unique_node_name(skeleton.names[j]);
    const bool has_outer = is_sheared(j);
    if (!has_outer) set_rest(rest.joints[j], node);
    gltf.nodes.push_back(std::move(node));
    outer_.push_back(has_outer ? first + skeleton.joint_count() + outer_count++ : first + j);
    if (skeleton.parents[j] == Skeleton::kNoParent) {
      gltf.scenes[0].nodes.push_back(outer_.back());
    } else {
      gltf.nodes[first + skeleton.parents[j]].children.push_back(outer_.back());
    }
    const Mat4 to_joint = skeleton.reference[j].inverse().matrix();
    const Mat4f inverse =
        (options_.quantized ? Mat4(to_joint * stored_to_model) : to_joint).cast<float>();
    inverse_reference.insert(inverse_reference.end(), inverse.data(), inverse.data() + 16);
    skin.joints.push_back(first + j);
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (outer_[j] == first + j) continue;
    tinygltf::Node node;
    node.name = unique_node_name(skeleton.names[j] + "_stretch");
    set_rest(rest.joints[j], node);
    node.children.push_back(first + j);
    gltf.nodes.push_back(std::move(node));
  }
  skin.name = name;
  skin.skeleton = first;
  skin.inverseBindMatrices = add_floats(inverse_reference, TINYGLTF_TYPE_MAT4, Use::data, false);
  gltf.skins.push_back(std::move(skin));
  for (const NamedTracks& clip : clips) add_animation(*clip.tracks, clip.name);
  return static_cast<int>(gltf.skins.size()) - 1;
}

void Document::add_animation(const JointTracks& tracks, const std::string& name) {
  if (tracks.times.empty()) return;
  const std::vector<int> inner = gltf.skins.back().joints;
  assert(tracks.joints.size() == inner.size());
  tinygltf::Animation animation;
  animation.name = name;
  if (tracks.rate > 0) animation.extras = animation_extras(tracks);
  // The times of some frames, or of all; tracks of any clip with the same share an accessor.
  const auto times = [&](const std::vector<int>& frames) {
    std::vector<float> chosen;
    for (const int frame : frames) chosen.push_back(tracks.times[frame]);
    const auto [place, made] = times_.emplace(frames.empty() ? tracks.times : chosen, 0);
    if (made) place->second = add_floats(place->first, TINYGLTF_TYPE_SCALAR, Use::data, true);
    return place->second;
  };
  for (std::size_t j = 0; j < inner.size(); ++j) {
    const JointTrack& track = tracks.joints[j];
    if (track.read_translations || !track.translations.empty()) {
      const int input = times(track.translation_frames);
      add_channel(animation, outer_[j], "translation", input,
                  track.read_translations
                      ? promise_keys(tracks, j, false)
                      : add_translations(track.translations, track.translation_exponent));
    }
    if (track.read_rotations || !track.rotations.empty()) {
      const int input = times(track.rotation_frames);
      add_channel(animation, outer_[j], "rotation", input,
                  track.read_rotations ? promise_keys(tracks, j, true)
                                       : add_rotations(track.rotations, track.rotation_bits));
    }
    if (!track.scales.empty()) {
      const int input = times({});
      add_channel(animation, outer_[j], "scale", input, add_vector_keys(track.scales));
    }
    if (!track.inner_rotations.empty()) {
      const int input = times({});
      add_channel(animation, inner[j], "rotation", input,
                  add_rotations(track.inner_rotations, track.rotation_bits));
    }
  }
  // A character that stays in its reference pose still has an animation of some duration.
  if (animation.channels.empty()) {
    const std::vector<Vec3f> still(tracks.times.size(), tracks.joints[0].rest_translation);
    const int input = times({});
    add_channel(animation, outer_[0], "translation", input, add_vectors(still, Use::data));
  }
  gltf.animations.push_back(std::move(animation));
}

int Document::promise_keys(const JointTracks& tracks, std::size_t joint, bool rotations) {
  if (promised_keys_.empty() || promised_keys_.back().tracks != &tracks) {
    const std::vector<KeyPlace> none(tracks.joints.size());
    promised_keys_.push_back({&tracks, none, none});
  }
  PromisedKeys& promised = promised_keys_.back();
  (rotations ? promised.rotations : promised.translations)[joint] = {size_, parts_.size()};
  const std::size_t bytes = tracks.times.size() * (rotations ? sizeof(Quatf) : sizeof(Vec3f));
  const int accessor =
      add_accessor_of(bytes, TINYGLTF_COMPONENT_TYPE_FLOAT, sizeof(float),
                      rotations ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, Use::data);
  parts_.emplace_back().to_read = bytes;
  size_ += bytes;
  return accessor;
}

Result<tinygltf::Primitive> Document::primitive_of(const Model& model, const Model::Part& part,
                                                   const std::map<std::string, int>& attributes,
                                                   const VertexRange& range) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes = attributes;
  const auto material = add_material(part.material, attributes);
  if (!material) return material.error();
  primitive.material = *material;
  const std::uint32_t* first = model.triangles[part.first_triangle].data();
  std::vector<std::uint32_t> corners(first, first + std::size_t{3} * part.triangle_count);
  for (std::uint32_t& corner : corners) corner -= static_cast<std::uint32_t>(range.first);
  primitive.indices = add_integers(corners, TINYGLTF_TYPE_SCALAR,
                                   static_cast<std::uint32_t>(range.count - 1), Use::indices);
  return primitive;
}

Result<std::vector<Document::MeshNode>> Document::add_meshes(
    const Model& model, const std::map<std::string, int>& attributes, int skin,
    const std::string& name, bool own_vertices) {
  if (Status status = check(options_.materials); !status) return status.error();
  std::vector<VertexRange> ranges;
  if (own_vertices) ranges = part_ranges(model);
  std::vector<MeshNode> meshes;
  const std::string* before = nullptr;
  std::size_t used = 0;
  for (const Model::Part& part : model.parts) {
    if (part.triangle_count == 0) continue;
    const VertexRange range =
        ranges.empty() ? VertexRange{0, model.positions.size()} : ranges[used++];
    auto primitive = primitive_of(model, part, attributes, range);
    if (!primitive) return primitive.error();
    if (before == nullptr || *before != part.mesh) {
      before = &part.mesh;
      gltf.meshes.emplace_back().name = part.mesh.empty() ? name : part.mesh;
      meshes.push_back({static_cast<int>(gltf.meshes.size()) - 1, 0});
    }
    gltf.meshes.back().primitives.push_back(*std::move(primitive));
    if (!ranges.empty()) ranges_[meshes.back().mesh].push_back(range);
  }
  if (meshes.empty()) {
    return Error("gltf-empty-mesh", "the model has no triangles; glTF does not allow empty meshes");
  }
  for_each_own_primitive(
      meshes, [&](tinygltf::Primitive& primitive, const VertexRange& range, bool is_first) {
        primitive.attributes =
            attributes_of(own_attributes(primitive, attributes, range), range, is_first);
      });
  for (MeshNode& made : meshes) {
    const std::string& wanted = gltf.meshes[static_cast<std::size_t>(made.mesh)].name;
    made.node = add_mesh_node(made.mesh, skin, wanted);
  }
  return meshes;
}

int Document::add_mesh_node(int mesh, int skin, const std::string& name) {
  tinygltf::Node node;
  node.name = unique_node_name(name);
  node.mesh = mesh;
  node.skin = skin;
  gltf.nodes.push_back(std::move(node));
  const int index = static_cast<int>(gltf.nodes.size()) - 1;
  gltf.scenes[0].nodes.push_back(index);
  return index;
}

}  // namespace krok::gltf

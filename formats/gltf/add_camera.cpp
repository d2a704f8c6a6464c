#include "formats/gltf/add_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/json_internal.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/gltf/glb_container_internal.h"
#include "formats/gltf/joint_tracks.h"
#include "formats/gltf/json_text_internal.h"

namespace krok::gltf {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kFloat = 5126;  // component type FLOAT

OrderedJson& list_in(OrderedJson& object, const char* name) {
  OrderedJson& list = object[name];
  if (!list.is_array()) list = OrderedJson::array();
  return list;
}

std::string text_in(const OrderedJson& object, const char* name) {
  if (!object.is_object() || !object.contains(name) || !object[name].is_string()) return {};
  return object[name].get<std::string>();
}

std::string free_name(const OrderedJson& nodes, const std::string& wanted) {
  std::set<std::string> taken;
  for (const OrderedJson& node : nodes) taken.insert(text_in(node, "name"));
  std::string name = wanted;
  for (int i = 2; taken.contains(name); ++i) name = fmt::format("{}_{}", wanted, i);
  return name;
}

template <typename Vector>
OrderedJson numbers(const Vector& vector) {
  OrderedJson list = OrderedJson::array();
  for (const float value : vector) list.push_back(static_cast<double>(value));
  return list;
}

OrderedJson provenance_json(const Provenance& provenance) {
  OrderedJson json = {{"tool", provenance.tool}, {"version", provenance.version}};
  for (const auto& source : provenance.sources) {
    json["sources"].push_back({{"name", source.name}, {"xxh3", source.xxh3}});
  }
  for (const auto& [name, value] : provenance.options) json["options"][name] = value;
  if (!provenance.conversions.empty()) json["conversions"] = provenance.conversions;
  if (!provenance.warnings.empty()) json["warnings"] = provenance.warnings;
  return json;
}

Status check_all(const CameraTrack& track, const CameraOptions& options) {
  if (Status status = check(track); !status) return status;
  if (track.frame_count() == 0) return Error("camera-shape", "the camera has no frames");
  const bool good_aspect =
      !options.aspect || (*options.aspect > 0 && std::isfinite(*options.aspect));
  if (!good_aspect || !(options.near_plane > 0) || !std::isfinite(options.near_plane)) {
    return Error("gltf-value", "near plane and aspect ratio must be positive and finite");
  }
  return {};
}

struct CameraKeys {
  std::vector<float> times;
  std::vector<Vec3f> positions;
  std::vector<Quatf> rotations;
};

// A key a frame. Just before a cut, near enough to count as on that frame (see find_rate() in
// lib/character), one more holds the frame before and one begins the new shot: loaders interpolate
// between all keys.
CameraKeys keys_of(const CameraTrack& track, std::span<const float> times) {
  CameraKeys keys;
  const auto add = [&](float time, std::size_t frame) {
    keys.times.push_back(time);
    keys.positions.push_back(track.positions[frame]);
    keys.rotations.push_back(track.orientations[frame]);
    // Successive rotations in one hemisphere, so that viewers interpolate along the shorter arc.
    const std::size_t count = keys.rotations.size();
    if (count > 1 && keys.rotations[count - 1].dot(keys.rotations[count - 2]) < 0) {
      keys.rotations.back().coeffs() *= -1;
    }
  };
  for (std::size_t frame = 0; frame < times.size(); ++frame) {
    if (track.is_cut(static_cast<int>(frame))) {
      const auto before = [&](double frames, float limit) {
        const double time = static_cast<double>(times[frame]) - frames / track.rate;
        return std::min(static_cast<float>(time), std::nextafter(limit, 0.0f));
      };
      const float begin = before(0.004, times[frame]);
      add(before(0.008, begin), frame - 1);
      add(begin, frame);
    }
    add(times[frame], frame);
  }
  return keys;
}

// Adds a camera to the JSON and the buffer of a file.
class CameraPutter {
 public:
  CameraPutter(const CameraTrack& track, const CameraOptions& options, OrderedJson& json,
               std::vector<std::byte>& data)
      : track_(track), options_(options), json_(json), data_(data) {}

  Status put(Diagnostics& diagnostics) {
    // Create all lists first: inserting a key later would move the others and break references.
    for (const char* name : {"cameras", "nodes", "scenes"}) list_in(json_, name);
    if (!json_.contains("scene")) json_["scene"] = 0;
    if (track_.frame_count() > 1) {
      for (const char* name : {"animations", "bufferViews", "accessors"}) list_in(json_, name);
    }
    const int camera = put_lens(diagnostics);
    const int node = put_node(camera);
    return track_.frame_count() > 1 ? put_motion(node, diagnostics) : Status();
  }

 private:
  int put_lens(Diagnostics& diagnostics) {
    OrderedJson lens = {{"yfov", static_cast<double>(track_.fields_of_view[0])},
                        {"znear", options_.near_plane}};
    if (options_.aspect) lens["aspectRatio"] = *options_.aspect;
    OrderedJson camera = {{"type", "perspective"}, {"name", options_.name}, {"perspective", lens}};
    if (!track_.provenance.tool.empty()) {
      camera["extras"]["provenance"] = provenance_json(track_.provenance);
    }
    const auto [least, most] = std::ranges::minmax(track_.fields_of_view);
    if (least != most) {
      camera["extras"]["fieldsOfView"] = {{"rate", track_.rate},
                                          {"values", numbers(track_.fields_of_view)}};
      diagnostics.push_back(make_warning(
          "gltf-lens",
          fmt::format("the field of view varies from {} to {} degrees, which glTF cannot animate; "
                      "viewers use the first frame's",
                      readable(static_cast<double>(least) / kRadiansPerDegree, 4),
                      readable(static_cast<double>(most) / kRadiansPerDegree, 4)),
          "Krok's tools read the animation from the camera's extras"));
    }
    OrderedJson& cameras = list_in(json_, "cameras");
    cameras.push_back(std::move(camera));
    return static_cast<int>(cameras.size()) - 1;
  }

  int put_node(int camera) {
    OrderedJson& nodes = list_in(json_, "nodes");
    const std::size_t index = nodes.size();
    OrderedJson node = {{"name", free_name(nodes, options_.name)}, {"camera", camera}};
    node["translation"] = numbers(track_.positions[0]);
    node["rotation"] = numbers(track_.orientations[0].coeffs());
    OrderedJson& scenes = list_in(json_, "scenes");
    if (scenes.empty()) scenes.push_back({{"nodes", roots_of(nodes)}});
    const std::size_t shown =
        json_["scene"].is_number_unsigned() ? json_["scene"].get<std::size_t>() : 0;
    nodes.push_back(std::move(node));
    list_in(scenes.at(shown), "nodes").push_back(index);
    return static_cast<int>(index);
  }

  static OrderedJson roots_of(const OrderedJson& nodes) {
    std::set<std::size_t> children;
    for (const OrderedJson& node : nodes) {
      if (!node.contains("children")) continue;
      for (const OrderedJson& child : node["children"]) {
        if (child.is_number_unsigned()) children.insert(child.get<std::size_t>());
      }
    }
    OrderedJson roots = OrderedJson::array();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!children.contains(i)) roots.push_back(i);
    }
    return roots;
  }

  // Returns the accessor's index.
  std::size_t put_floats(std::span<const float> values, const char* type, std::size_t count) {
    const std::size_t begin = append_aligned(std::as_bytes(values), data_);
    OrderedJson& views = list_in(json_, "bufferViews");
    views.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", values.size_bytes()}});
    OrderedJson& accessors = list_in(json_, "accessors");
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", kFloat},
                         {"count", count},
                         {"type", type}});
    return accessors.size() - 1;
  }

  // The animation that is wanted; the number of them if there is none.
  std::size_t find_animation(const OrderedJson& animations) const {
    const std::string& wanted = options_.animation;
    if (wanted.empty()) return 0;
    std::size_t named = 0;
    while (named < animations.size() && text_in(animations[named], "name") != wanted) ++named;
    std::size_t number = 0;
    const char* const end = wanted.data() + wanted.size();
    const auto read = std::from_chars(wanted.data(), end, number);
    const bool is_number = read.ec == std::errc() && read.ptr == end;
    return named == animations.size() && is_number ? std::min(number, named) : named;
  }

  Status put_motion(int node, Diagnostics& diagnostics) {
    const auto times = key_times(track_.frame_count(), track_.rate);
    if (!times) return times.error();
    OrderedJson& animations = list_in(json_, "animations");
    if (animations.empty()) {
      animations.push_back({{"name", options_.name},
                            {"channels", OrderedJson::array()},
                            {"samplers", OrderedJson::array()},
                            {"extras", {{kRate, track_.rate}}}});
    }
    const std::size_t wanted = find_animation(animations);
    if (wanted >= animations.size()) {
      return Error("gltf-animation", fmt::format("animation {} does not exist; the file has {}",
                                                 shown(options_.animation), animations.size()));
    }
    if (options_.animation.empty() && animations.size() > 1) {
      diagnostics.push_back(make_warning(
          "gltf-animations",
          fmt::format("the file has {} animations; the camera is added to the first, {}",
                      animations.size(), shown(text_in(animations[0], "name"))),
          "choose another with --clip NAME or NUMBER"));
    }
    const CameraKeys keys = keys_of(track_, *times);
    const std::size_t count = keys.times.size();
    const std::size_t input = put_floats(keys.times, "SCALAR", count);
    list_in(json_, "accessors")[input]["min"] = numbers(std::span(keys.times).first(1));
    list_in(json_, "accessors")[input]["max"] = numbers(std::span(keys.times).last(1));
    const std::size_t places =
        put_floats({keys.positions.data()->data(), 3 * count}, "VEC3", count);
    const std::size_t turns =
        put_floats({keys.rotations.data()->coeffs().data(), 4 * count}, "VEC4", count);
    OrderedJson& animation = animations[wanted];
    put_channel(animation, node, "translation", input, places);
    put_channel(animation, node, "rotation", input, turns);
    return {};
  }

  static void put_channel(OrderedJson& animation, int node, const char* path, std::size_t input,
                          std::size_t output) {
    const std::size_t sampler = list_in(animation, "samplers").size();
    animation["samplers"].push_back(
        {{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
    list_in(animation, "channels")
        .push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
  }

  const CameraTrack& track_;
  const CameraOptions& options_;
  OrderedJson& json_;
  std::vector<std::byte>& data_;
};

Result<WithCamera> with_camera(const CameraTrack& track, const CameraOptions& options,
                               OrderedJson json, std::vector<std::byte> data) {
  WithCamera result;
  CameraPutter putter(track, options, json, data);
  if (Status status = putter.put(result.diagnostics); !status) return status.error();
  auto bytes = assemble_glb(json, data);
  if (!bytes) return bytes.error();
  result.bytes = *std::move(bytes);
  return result;
}

}  // namespace

Result<WithCamera> add_camera(std::span<const std::byte> gltf, const CameraTrack& track,
                              const CameraOptions& options, const ReadOptions& reading) {
  if (Status status = check_all(track, options); !status) return status.error();
  auto packed = pack_glb(gltf, reading);
  if (!packed) return packed.error();
  const auto container = open_container(packed->bytes);
  if (!container) return container.error();
  auto result = with_camera(track, options, parse_ordered_json(container->json),
                            {container->bin.begin(), container->bin.end()});
  if (!result) return result;
  result->files = std::move(packed->files);
  result->diagnostics.insert(result->diagnostics.begin(), packed->diagnostics.begin(),
                             packed->diagnostics.end());
  return result;
}

Result<WithCamera> camera_alone(const CameraTrack& track, const CameraOptions& options) {
  if (Status status = check_all(track, options); !status) return status.error();
  const std::string& version = track.provenance.version;
  OrderedJson json;
  json["asset"] = {{"version", "2.0"},
                   {"generator", version.empty() ? "krok" : fmt::format("krok {}", version)}};
  return with_camera(track, options, std::move(json), {});
}

}  // namespace krok::gltf

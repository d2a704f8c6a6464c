#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/json_internal.h"
#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"

// Private to this folder: packs motions for the page script, which unpacks them in
// page/src/motion.js.

namespace krok::draw {

using Json = nlohmann::ordered_json;

// Binary data of one script element; arrays are 4-byte aligned.
class Blob {
 public:
  // Appends values and returns {"offset": bytes, "count": values}.
  template <typename T>
  Json add(std::span<const T> values) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const Json place = {{"offset", bytes_.size()}, {"count", values.size()}};
    const auto bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return place;
  }

  std::string base64() const;

 private:
  std::vector<std::byte> bytes_;
};

// A unit quaternion in 48 bits. The largest component, made positive, is dropped; the other three,
// in the order x, y, z, w, take 15 bits each over the range +-sqrt(1/2). The index of the dropped
// component is in the top bits of the first two words.
std::array<std::uint16_t, 3> pack_rotation(const Quat& rotation);
Quat unpack_rotation(const std::array<std::uint16_t, 3>& words);

// Adds the clip's properties to `item` and its arrays to `blob`.
void pack_motion(const Clip& clip, Json& item, Blob& blob);
// Corners of triangles take 16 bits each where that is enough for all vertices, otherwise 32.
Json pack_body(const Model& body, Blob& blob);
// The material of each part of a body, the materials and their images. Parts whose material is not
// in `materials` get the default material. Codes: those of picture_facts().
Result<Json> pack_look(const Model& body, std::span<const Material> materials, Blob& blob);
void pack_camera(const CameraTrack& camera, Json& item, Blob& blob);

// Private to this folder: how the page draws a skeleton.

struct DrawnBones {
  // A bone beyond a joint that ends without an end site, such as a head or toes.
  struct Stub {
    int joint = 0;
    Vec3 tip = Vec3::Zero();  // metres, in the joint's space
  };

  // The joint that the camera follows: the hips, or the root.
  int hips = 0;
  // Joints whose line to the parent is no bone of the body: the hips below a root that only
  // positions the character, and what else hangs on such a root without being a limb.
  std::vector<int> loose;
  std::vector<Stub> stubs;
  std::vector<int> left, right;  // the joints of each foot, from the ankle on
};

// `moves`: [joints], 1 if a joint's place relative to its parent changes. Directions of stubs are
// those of the bone before them in the standing pose (retarget::neutral_skeleton); toes and feet
// point along the sole. Lengths are shares of the body's extent. Helpers have none.
DrawnBones find_drawn_bones(const Clip& clip, std::span<const std::uint8_t> moves);

void pack_drawn_bones(const DrawnBones& bones, Json& item);

}  // namespace krok::draw

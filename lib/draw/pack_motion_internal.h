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

// Private to this folder: motions as the page's program unpacks them (page/src/motion.js).

namespace krok::draw {

using Json = nlohmann::ordered_json;

// Bytes for one script element, with arrays at multiples of four.
class Blob {
 public:
  // Appends values; {"offset": bytes, "count": values}.
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

// A unit quaternion in 48 bits: the largest component, made positive, is left out; of the others,
// in the order x, y, z, w, 15 bits each stand for the range of +-sqrt(1/2). Which is left out is in
// the top bits of the first two words.
std::array<std::uint16_t, 3> pack_rotation(const Quat& rotation);
Quat unpack_rotation(const std::array<std::uint16_t, 3>& words);

// Adds what the page needs of the clip to `item` and its arrays to `blob`.
void pack_motion(const Clip& clip, Json& item, Blob& blob);
Json pack_body(const Model& body, Blob& blob);
// Which material each part of a body has, the materials and their pictures. Parts whose material is
// none of `materials` look like one that says nothing. Codes: those of picture_facts().
Result<Json> pack_look(const Model& body, std::span<const Material> materials, Blob& blob);
void pack_camera(const CameraTrack& camera, Json& item, Blob& blob);

}  // namespace krok::draw

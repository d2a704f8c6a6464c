#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/motion_keys.h"

// A page that plays motions in a browser: one HTML file with its program and its data inside, which
// opens from disk without a network. The program is in the folder page/.

namespace krok::draw {

// A motion as a skeleton, and as a character where a body is given.
struct ViewedMotion {
  std::string name;   // for people, such as the file's
  std::string facts;  // a line below the name; may be empty
  bool visible = true;
  const Clip* clip = nullptr;
  const Model* body = nullptr;  // of the same joints as the clip; null for none
  // Of the body's parts, by name, with the pictures' bytes. Parts of other materials are light
  // grey; without any material the body has a colour of the page's. Pictures need texture
  // coordinates.
  std::span<const Material> materials;
  MotionKeys keys;  // coloured and marked on the time line
};

struct ViewedCamera {
  std::string name;
  std::string facts;
  const CameraTrack* camera = nullptr;
};

// A GLB file, shown as it is.
struct ViewedGlb {
  std::string name;
  std::string facts;
  bool visible = true;
  std::span<const std::byte> bytes;
  int animation = 0;   // which of its animations plays
  double rate = 60.0;  // frames a second that stepping takes
};

struct ViewerPage {
  std::string title;
  bool apart = false;       // figures side by side instead of where their files put them
  bool difference = false;  // joints of the first two figures coloured by their distance
  std::vector<ViewedMotion> motions;
  std::vector<ViewedGlb> files;
  std::vector<ViewedCamera> cameras;
};

// The page as HTML text, in UTF-8. Rotations are stored to 1.5e-4 radians relative to the parent,
// positions as floats; a minute of 60 joints at 60 frames a second takes less than 3 MB. The same
// input gives the same bytes. Codes: those of check() for clips, models, materials, cameras
// and keys, and of picture_facts(); viewer-body for a body whose joints are not the clip's.
Result<std::string> write_viewer_page(const ViewerPage& page);

}  // namespace krok::draw

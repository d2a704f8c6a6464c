#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/motion_keys.h"

// A web page that plays motions: one HTML file that contains its script and data and works offline,
// opened from disk. The script is in page/.

namespace krok::draw {

// A goal of inverse kinematics, and how a motion meets it: a marker at its place, a line to it, the
// joints that take part, and by how much it is missed.
struct ViewedGoal {
  std::string name;
  std::string kind;        // "position"; shown beside the name
  std::vector<int> chain;  // joints that take part, from the end effector upwards; may be empty
  struct Frame {
    Vec3 from = Vec3::Zero();  // metres, world: what is moved
    Vec3 to = Vec3::Zero();    // where it is to be
    double strength = 0;       // 0 (not active) to 1; between them the goal fades in or out
    double distance = 0;       // metres by which it is missed
    double angle = 0;          // radians
  };
  std::vector<Frame> frames;  // [frames]
};

// A footprint that the page shows on the ground, in the colour of its side, with its number.
struct ViewedPrint {
  bool left = true;
  int number = 1;                // as in messages and files, from 1
  Vec3 heel = Vec3::Zero();      // metres, world
  Vec3 forward = Vec3::UnitZ();  // from heel to toes, unit vector
  Vec3 up = Vec3::UnitY();       // normal of the sole, unit vector
  double length = 0.26;          // metres, heel to tip
};

// A time in which a motion's foot stands on a footprint, which is marked then.
struct ViewedPrintContact {
  int print = 0;              // index into ViewerPage::prints
  double start = 0, end = 0;  // seconds
};

// A ground that the page shows in place of its level grid, with a grid of metres on it.
struct ViewedGround {
  std::vector<Vec3f> positions;  // metres, world
  std::vector<Vec3f> normals;    // unit vectors, [positions]
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// A motion shown as a skeleton, and as a skinned character if a body is given.
struct ViewedMotion {
  std::string name;   // display name, such as the file name
  std::string facts;  // a line below the name; may be empty
  bool visible = true;
  const Clip* clip = nullptr;
  // Has the same joints as the clip; null for none. On the page once, however many share it.
  const Model* body = nullptr;
  // Materials of the body's parts, by name, with image data. Parts of other materials are light
  // grey; without any material the body has a default colour. Images need texture coordinates.
  std::span<const Material> materials;
  MotionKeys keys;  // coloured and marked on the timeline
  std::vector<ViewedGoal> goals;
  std::vector<ViewedPrintContact> print_contacts;
};

struct ViewedCamera {
  std::string name;
  std::string facts;
  const CameraTrack* camera = nullptr;
};

// How far the vertices of a GLB are from those of another, if both play these animations. Without
// it, the page measures at as many times as it can afford.
struct ViewedDifference {
  int animation = 0, other_animation = 0;
  std::vector<double> times;      // seconds, rising
  std::vector<float> distances;   // the largest at each time, metres
  double time = 0, distance = 0;  // of the largest of all
};

// A GLB file, shown unmodified.
struct ViewedGlb {
  std::string name;
  std::string facts;
  bool visible = true;
  std::span<const std::byte> bytes;
  int animation = 0;          // index of the animation that plays first
  std::vector<double> rates;  // frames per second of each animation, for stepping; else 60
  std::optional<ViewedDifference> difference;  // from the file before it
};

struct ViewerPage {
  std::string title;
  bool apart = false;       // characters side by side instead of at their own positions
  bool difference = false;  // colour the second character by its distance from the first
  std::vector<ViewedMotion> motions;
  std::vector<ViewedGlb> files;
  std::vector<ViewedCamera> cameras;
  ViewedGround ground;  // without triangles: a level grid at height 0
  std::vector<ViewedPrint> prints;
};

// The page as HTML, in UTF-8. Rotations are stored to 1.5e-4 radians relative to the parent,
// positions as floats; one minute of 60 joints at 60 fps takes less than 3 MB. Output is
// deterministic. Codes: those of check() for clips, models, materials, cameras and keys, and of
// picture_facts(); viewer-body if the joints of a body are not those of the clip; viewer-goal if a
// goal has another number of frames than its clip, or joints that the clip has not; viewer-ground
// if triangles or contacts with prints name what is not there.
Result<std::string> write_viewer_page(const ViewerPage& page);

}  // namespace krok::draw

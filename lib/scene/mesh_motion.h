#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/types.h"

// Meshes in motion as whole shapes, one a frame: what skinning and morphing make and what point
// caches and baked files hold. Who takes them needs a Model beside them, for triangles, texture
// coordinates and parts.

namespace krok {

// The vertices of a model in some pose; lengths and units as Model has them.
struct MeshShape {
  std::span<const Vec3f> positions;  // [vertices]
  std::span<const Vec3f> normals;    // [vertices], or none
  std::span<const Vec4f> tangents;   // [vertices], or none
};

// Where the vertices of a shape go: [vertices] each, or none.
struct ShapeOutput {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;
  std::span<Vec4f> tangents;
};

// Fills in the vertices of a frame, 0 <= frame < MeshMotion::frames: all positions, and the normals
// and tangents that have a place. Gives the same numbers whenever it is asked for the same frame.
// May own working memory: one thread at a time uses it.
using ShapeSource = std::function<void(int frame, const ShapeOutput& to)>;

// A motion as shapes that are made when they are asked for, so that a clip of any length takes the
// memory of a few frames. Frame f is at f / rate seconds.
struct MeshMotion {
  int frames = 0;
  double rate = 30.0;  // frames a second

  // One more source of the motion's shapes. Sources are used at once on several threads, each for
  // some of the frames, in rising order, by some writers in two rounds. Is called by one thread
  // after the other.
  std::function<ShapeSource()> source;

  bool tangents = false;  // whether the sources make them
};

// For MeshMotion::source: each a copy of this one.
std::function<ShapeSource()> copies_of(ShapeSource source);

// Room for the shape of a frame.
struct ShapeRoom {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;

  ShapeOutput place() { return {positions, normals, tangents}; }
};

// What make_shapes() makes.
struct ShapeRange {
  int begin = 0, end = 0;    // frames
  std::size_t vertices = 0;  // of each
  bool normals = false;
  bool tangents = false;
};

// Goes through frames of a motion in the memory of a few, or of some megabytes: makes each shape,
// lets `prepare` change it, hands it to `take`. `take` is given some consecutive frames, the first
// of them by its number, and in order; how many does not depend on `jobs`. With `jobs` other than 1
// (as in parallel_for) further frames are made and prepared meanwhile, several at once, each
// thread's by a source of its own. The first of `prepare` and `take` that is not ok() ends it; its
// Error is returned, the same for any `jobs`.
Status make_shapes(const MeshMotion& motion, const ShapeRange& range, int jobs,
                   const std::function<Status(int frame, ShapeRoom& shape)>& prepare,
                   const std::function<Status(int frame, std::span<const ShapeRoom>)>& take);

}  // namespace krok

#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"

// Animated meshes as one whole shape per frame: the result of skinning and morphing, and the
// content of point caches and baked files. Triangles, texture coordinates and parts come from a
// Model.

namespace krok {

// The vertices of a model in some pose; units as in Model.
struct MeshShape {
  std::span<const Vec3f> positions;  // [vertices]
  std::span<const Vec3f> normals;    // [vertices], or empty
  std::span<const Vec4f> tangents;   // [vertices], or empty
};

// Output arrays for a shape: [vertices] each, or empty.
struct ShapeOutput {
  std::span<Vec3f> positions;
  std::span<Vec3f> normals;
  std::span<Vec4f> tangents;
};

// Writes the vertices of a frame, 0 <= frame < MeshMotion::frames: all positions, and the normals
// and tangents whose output is not empty. Deterministic per frame. May own working memory: used by
// one thread at a time.
using ShapeSource = std::function<void(int frame, const ShapeOutput& to)>;

// A motion as shapes produced on demand, so that a clip of any length needs the memory of a few
// frames. Frame f is at f / rate seconds.
struct MeshMotion {
  int frames = 0;
  double rate = 30.0;  // frames per second

  // Creates another source of the shapes. Sources are used concurrently, each for some of the
  // frames in increasing order; some writers make two passes. Not called concurrently.
  std::function<ShapeSource()> source;

  bool tangents = false;  // whether the sources produce tangents
};

// For MeshMotion::source: each source is a copy of this one.
std::function<ShapeSource()> copies_of(ShapeSource source);

// Buffers for the shape of one frame.
struct ShapeRoom {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;

  ShapeOutput place() { return {positions, normals, tangents}; }
};

// The frames and attributes that make_shapes() produces.
struct ShapeRange {
  int begin = 0, end = 0;    // frames
  std::size_t vertices = 0;  // per frame
  bool normals = false;
  bool tangents = false;
};

// Processes frames of a motion with the memory of a few frames or some megabytes: makes each shape,
// lets `prepare` change it and passes it to `take`. `take` gets a run of consecutive frames and the
// number of the first, in order; the run length does not depend on `jobs`. With `jobs` other than 1
// (as in parallel_for), further frames are made and prepared concurrently, each thread with its own
// source. The first `prepare` or `take` that is not ok() stops the loop; its Error is returned, the
// same for any `jobs`.
Status make_shapes(const MeshMotion& motion, const ShapeRange& range, int jobs,
                   const std::function<Status(int frame, ShapeRoom& shape)>& prepare,
                   const std::function<Status(int frame, std::span<const ShapeRoom>)>& take);

}  // namespace krok

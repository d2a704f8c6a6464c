#pragma once

#include <memory>
#include <optional>

#include "core/result.h"
#include "render/actor.h"

// Actors prepared for ray tracing with Intel Embree.

namespace krok::render {

// Linear light, 0 .. 1.
using Light = Vec3f;

struct Hit {
  double depth = 0;  // metres towards the viewer from the actor's middle
  Vec3f point;       // hit point, for occlusion()
  Vec3f normal;      // unit, on the visible side
  Light colour;
};

// A line of sight in world space: through `point`, seen from the far end of `towards` (a unit
// vector). The neighbouring pixels' lines are offset by `right` and `down`, perpendicular to
// `towards`.
struct Sight {
  Vec3 point, towards, right, down;
  bool from_eye = false;  // `point` is the eye: what is behind it is not seen
};

class Tracer;

// An actor normalised to about one unit around the origin, so that very large, small or distant
// characters do not lose precision. The Actor must outlive it.
class TracedActor {
 public:
  TracedActor(TracedActor&&) noexcept;
  TracedActor& operator=(TracedActor&&) noexcept;
  ~TracedActor();

  const Bounds& box() const { return box_; }
  const Vec3& middle() const { return middle_; }
  double unit() const { return unit_; }          // metres
  bool has_holes() const { return has_holes_; }  // parts that an alpha test cuts out

  // The nearest visible hit.
  std::optional<Hit> look(const Sight& sight) const;

  // A subset of `directions` rays with a cosine-weighted distribution about a normal: `count` rays
  // from `first`.
  struct Rays {
    int directions = 18;  // of 18 or 54
    int first = 0, count = 2;
  };
  // The fraction (0 .. 1) of these rays that start at a point with this normal and hit the actor
  // within `reach` units. The directions are the same at each point.
  float occlusion(const Vec3f& point, const Vec3f& normal, const Rays& rays, float reach) const;

  // Transforms a world point to units.
  Vec3f local(const Vec3& world) const { return ((world - middle_) / unit_).cast<float>(); }

 private:
  friend class Tracer;
  struct Scene;
  TracedActor() = default;
  Vec3f normal_of(const void* ray_hit, const Sight& sight, Light& colour) const;
  Light painted(const Surface& surface, std::size_t triangle, const Vec3f& shares,
                const Sight& sight) const;

  const Actor* actor_ = nullptr;
  Bounds box_;
  Vec3 middle_ = Vec3::Zero();
  double unit_ = 1;
  bool has_holes_ = false;
  std::unique_ptr<Scene> scene_;
};

// Embree's device. Traced actors keep their own references to what they need.
class Tracer {
 public:
  // Code render-memory if Embree fails.
  static Result<Tracer> create();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;
  ~Tracer();

  // Codes: those of check(Actor); render-memory.
  Result<TracedActor> add(const Actor& actor) const;

 private:
  struct Device;
  Tracer() = default;
  std::unique_ptr<Device> device_;
};

}  // namespace krok::render

#pragma once

#include <memory>
#include <optional>
#include <span>

#include "core/result.h"
#include "render/actor.h"

// Figures made ready for rays, by Intel Embree.

namespace krok::render {

// Linear light, 0 .. 1.
using Light = Vec3f;

struct Hit {
  double depth = 0;  // metres towards the viewer from the figure's own middle
  Vec3f point;       // where, for occlusion()
  Vec3f normal;      // unit, on the side that is seen
  Light colour;
};

// A line along which something is seen, world: through `point`, from the far end of `towards` (a
// unit vector). The lines beside it are `right` and `down` away, across `towards`.
struct Sight {
  Vec3 point, towards, right, down;
};

class Tracer;

// A figure in a box of its own, the middle in the origin and about one unit wide, so that neither
// very large and small figures nor far ones lose digits. The figure must outlive it.
class TracedActor {
 public:
  TracedActor(TracedActor&&) noexcept;
  TracedActor& operator=(TracedActor&&) noexcept;
  ~TracedActor();

  const Bounds& box() const { return box_; }
  const Vec3& middle() const { return middle_; }
  double unit() const { return unit_; }  // metres

  // What is seen of it.
  std::optional<Hit> look(const Sight& sight) const;

  // Of a set of `directions` about a normal, as many as its cosine gives them, those that are to be
  // followed at a time.
  struct Rays {
    int directions = 18;  // of 18 or 54
    int first = 0, count = 2;
  };
  // The share (0 .. 1) of these rays that leave a point with this normal and meet the figure within
  // `reach` units. The directions are the same at each point.
  float occlusion(const Vec3f& point, const Vec3f& normal, const Rays& rays, float reach) const;

  // A point of the world in units.
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
  std::unique_ptr<Scene> scene_;
};

// Embree's device. Figures that it made keep what they need of it.
class Tracer {
 public:
  // Code render-memory where Embree cannot.
  static Result<Tracer> create();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;
  ~Tracer();

  // Codes: those of check(Figure); render-memory.
  Result<TracedActor> add(const Actor& actor) const;

 private:
  struct Device;
  Tracer() = default;
  std::unique_ptr<Device> device_;
};

}  // namespace krok::render

#include <algorithm>
#include <array>
#include <cmath>

#include "core/embree_internal.h"
#include "render/tracer_internal.h"

namespace krok::render {

namespace {

// One instruction set for all machines and a single-threaded build, so that results are the same
// everywhere.
constexpr const char* kDevice = "isa=sse4.2,threads=1,set_affinity=0";

constexpr double kMaxDistance = 1.0;  // units; no actor extends farther than 0.87 from its middle
constexpr double kStart = 2.0;        // units in front of the middle, where view rays start
constexpr float kStep = 1e-4F;        // offset of secondary rays from the surface
constexpr float kSmallest = 1e-6F;    // units; shorter bones are balls

// Cosine-weighted directions about +Z.
template <int count>
const std::array<Vec3f, count>& directions() {
  static const auto table = [] {
    std::array<Vec3f, count> result;
    const double golden = kPi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
      const double share = (i + 0.5) / count;
      const double radius = std::sqrt(share);
      result[static_cast<std::size_t>(i)] =
          Vec3(radius * std::cos(golden * i), radius * std::sin(golden * i), std::sqrt(1 - share))
              .cast<float>();
    }
    return result;
  }();
  return table;
}

// Writes a point into an Embree buffer, with room for the radius.
void put(float* place, const Vec3f& point) {
  std::copy_n(point.data(), 3, place);
}

struct Curve {
  Vec3f from, to;
  float from_radius, to_radius;
  bool is_ball() const { return (to - from).norm() < kSmallest; }
};

}  // namespace

struct Tracer::Device {
  RTCDevice device = nullptr;
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

struct TracedActor::Scene {
  RTCScene scene = nullptr;
  // Indices of the bones that are capsules and balls, in Embree's order.
  std::vector<std::size_t> bars, balls;
  unsigned bars_geometry = RTC_INVALID_GEOMETRY_ID, balls_geometry = RTC_INVALID_GEOMETRY_ID;

  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }

  // Commits and attaches a geometry, which the scene then keeps alive; returns its id.
  unsigned attach(RTCGeometry geometry) const {
    rtcCommitGeometry(geometry);
    const unsigned id = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    return id;
  }
};

namespace {

// A geometry buffer for `count` elements, or null. Embree rejects empty buffers.
template <typename T>
T* buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride,
          std::size_t count) {
  return static_cast<T*>(rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count));
}

Vec2f coordinates_at(const Surface& surface, std::size_t triangle, const Vec3f& shares) {
  const auto& corners = (*surface.triangles)[triangle];
  const auto& coordinates = *surface.paint->coordinates;
  return shares[0] * coordinates[corners[0]] + shares[1] * coordinates[corners[1]] +
         shares[2] * coordinates[corners[2]];
}

RTCGeometry mesh(RTCDevice device, const Surface& surface, const TracedActor& actor) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (surface.triangles->empty()) return geometry;
  auto* points = buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                               3 * sizeof(float), surface.positions.size());
  auto* corners = buffer<std::uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                        3 * sizeof(std::uint32_t), surface.triangles->size());
  if (points == nullptr || corners == nullptr) return geometry;
  for (const Vec3f& point : surface.positions) {
    put(points, actor.local(point.cast<double>()));
    points += 3;
  }
  for (const auto& triangle : *surface.triangles) {
    corners = std::copy(triangle.begin(), triangle.end(), corners);
  }
  return geometry;
}

// Lets rays through where the alpha test fails. Embree filter function, called for each hit with
// one ray at a time.
void cut_out(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->N != 1 || arguments->valid[0] != -1) return;
  const auto& surface = *static_cast<const Surface*>(arguments->geometryUserPtr);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  const Vec2f place = coordinates_at(surface, hit.primID, {1 - hit.u - hit.v, hit.u, hit.v});
  if (surface.paint->alpha_at(place) < surface.paint->cutoff) arguments->valid[0] = 0;
}

RTCGeometry bars(RTCDevice device, std::span<const Curve> curves) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  auto* ends = buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4 * sizeof(float),
                             2 * curves.size());
  auto* starts = buffer<std::uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT,
                                       sizeof(std::uint32_t), curves.size());
  if (ends == nullptr || starts == nullptr) return geometry;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    put(ends + 8 * i, curves[i].from);
    ends[8 * i + 3] = curves[i].from_radius;
    put(ends + 8 * i + 4, curves[i].to);
    ends[8 * i + 7] = curves[i].to_radius;
    starts[i] = static_cast<std::uint32_t>(2 * i);
  }
  return geometry;
}

RTCGeometry balls(RTCDevice device, std::span<const Curve> curves) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* points = buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4,
                               4 * sizeof(float), curves.size());
  if (points == nullptr) return geometry;
  for (const Curve& curve : curves) {
    put(points, curve.from);
    points[3] = std::max(curve.from_radius, curve.to_radius);
    points += 4;
  }
  return geometry;
}

}  // namespace

Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;
Tracer::~Tracer() = default;
TracedActor::TracedActor(TracedActor&&) noexcept = default;
TracedActor& TracedActor::operator=(TracedActor&&) noexcept = default;
TracedActor::~TracedActor() = default;

Result<Tracer> Tracer::create() {
  Tracer tracer;
  tracer.device_ = std::make_unique<Device>();
  tracer.device_->device = rtcNewDevice(kDevice);
  if (tracer.device_->device == nullptr) {
    return Error("render-memory", "cannot start the renderer");
  }
  return tracer;
}

Result<TracedActor> Tracer::add(const Actor& actor) const {
  if (Status status = check(actor); !status) return status.error();
  TracedActor traced;
  traced.actor_ = &actor;
  traced.box_ = bounds(actor);
  traced.middle_ = 0.5 * (traced.box_.low + traced.box_.high);
  traced.unit_ = std::max(traced.box_.extent(), 1e-30);

  const RTCDevice device = device_->device;
  traced.scene_ = std::make_unique<TracedActor::Scene>();
  TracedActor::Scene& scene = *traced.scene_;
  scene.scene = rtcNewScene(device);
  rtcSetSceneFlags(scene.scene, RTC_SCENE_FLAG_ROBUST);
  for (const Surface& surface : actor.surfaces) {
    const RTCGeometry geometry = mesh(device, surface, traced);
    if (surface.paint != nullptr && surface.paint->cutoff > 0) {
      traced.has_holes_ = true;
      rtcSetGeometryUserData(geometry, const_cast<Surface*>(&surface));
      rtcSetGeometryIntersectFilterFunction(geometry, &cut_out);
      rtcSetGeometryOccludedFilterFunction(geometry, &cut_out);
    }
    scene.attach(geometry);
  }

  std::vector<Curve> bar_curves;
  std::vector<Curve> ball_curves;
  for (std::size_t i = 0; i < actor.bones.size(); ++i) {
    const Bone& bone = actor.bones[i];
    const auto unit = static_cast<float>(traced.unit_);
    const Curve curve{traced.local(bone.from.cast<double>()), traced.local(bone.to.cast<double>()),
                      bone.from_radius / unit, bone.to_radius / unit};
    (curve.is_ball() ? ball_curves : bar_curves).push_back(curve);
    (curve.is_ball() ? scene.balls : scene.bars).push_back(i);
  }
  if (!bar_curves.empty()) scene.bars_geometry = scene.attach(bars(device, bar_curves));
  if (!ball_curves.empty()) scene.balls_geometry = scene.attach(balls(device, ball_curves));
  rtcCommitScene(scene.scene);
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    return Error("render-memory", "out of memory while preparing the character for rendering");
  }
  return traced;
}

// The filter footprint follows from how the barycentric coordinates change from one line of sight
// to the next.
Light TracedActor::painted(const Surface& surface, std::size_t triangle, const Vec3f& shares,
                           const Sight& sight) const {
  const auto& corners = (*surface.triangles)[triangle];
  const Vec3f origin = local(surface.positions[corners[0]].cast<double>());
  const Vec3f first = local(surface.positions[corners[1]].cast<double>()) - origin;
  const Vec3f second = local(surface.positions[corners[2]].cast<double>()) - origin;
  const Vec3f towards = sight.towards.cast<float>();
  const auto& coordinates = *surface.paint->coordinates;
  const Vec2f along_first = coordinates[corners[1]] - coordinates[corners[0]];
  const Vec2f along_second = coordinates[corners[2]] - coordinates[corners[0]];
  // step = a first + b second + c towards, by Cramer's rule. Edge-on, the volume is zero and
  // neither a nor b is finite.
  const float volume = first.cross(second).dot(towards);
  const auto way = [&](const Vec3& step) -> Vec2f {
    const Vec3f units = (step / unit_).cast<float>();
    const float a = units.cross(second).dot(towards) / volume;
    const float b = first.cross(units).dot(towards) / volume;
    return a * along_first + b * along_second;
  };
  const Vec2f place = coordinates_at(surface, triangle, shares);
  return surface.paint->at(place, way(sight.right), way(sight.down)).head<3>();
}

Vec3f TracedActor::normal_of(const void* ray_hit, const Sight& sight, Light& colour) const {
  const RTCHit& hit = static_cast<const RTCRayHit*>(ray_hit)->hit;
  const Vec3f flat(hit.Ng_x, hit.Ng_y, hit.Ng_z);
  if (hit.geomID == scene_->bars_geometry || hit.geomID == scene_->balls_geometry) {
    const bool bar = hit.geomID == scene_->bars_geometry;
    const Bone& bone = actor_->bones[(bar ? scene_->bars : scene_->balls)[hit.primID]];
    const float along = bar ? std::clamp(hit.u, 0.0F, 1.0F) : 0.0F;
    colour = (1 - along) * to_light(bone.from_colour) + along * to_light(bone.to_colour);
    return flat;
  }
  const Surface& surface = actor_->surfaces[hit.geomID];
  const auto& corners = (*surface.triangles)[hit.primID];
  const std::array<float, 3> share = {1 - hit.u - hit.v, hit.u, hit.v};
  if (surface.colours.size() == 1) {
    colour = surface.paint != nullptr ? Light(Light::Ones()) : to_light(surface.colours[0]);
  } else {
    colour = Light::Zero();
    for (std::size_t k = 0; k < 3; ++k) colour += share[k] * to_light(surface.colours[corners[k]]);
  }
  if (surface.paint != nullptr) {
    const Vec3f shares(share[0], share[1], share[2]);
    colour = colour.cwiseProduct(painted(surface, hit.primID, shares, sight));
  }
  if (surface.normals.empty()) return flat;
  Vec3f smooth = Vec3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) smooth += share[k] * surface.normals[corners[k]];
  // Opposite normals cancel out.
  return smooth.squaredNorm() > 1e-12F ? smooth : flat;
}

std::optional<Hit> TracedActor::look(const Sight& sight) const {
  const Vec3& towards = sight.towards;
  const Vec3 offset = (sight.point - middle_) / unit_;
  const Vec3 aside = offset - towards.dot(offset) * towards;
  // Skip rays that pass far from the actor: Embree should not get distant origins.
  if (!(aside.squaredNorm() <= kMaxDistance * kMaxDistance)) return std::nullopt;
  const Vec3f start = (aside + kStart * towards).cast<float>();
  const Vec3f direction = -towards.cast<float>();
  RTCRayHit ray{};
  ray.ray.org_x = start.x();
  ray.ray.org_y = start.y();
  ray.ray.org_z = start.z();
  ray.ray.dir_x = direction.x();
  ray.ray.dir_y = direction.y();
  ray.ray.dir_z = direction.z();
  ray.ray.tfar = static_cast<float>(2 * kStart);
  if (sight.from_eye) {
    // An eye behind the far end sees nothing; one in front of the start sees everything.
    const double eye = kStart - offset.dot(towards);
    if (!(eye < 2 * kStart)) return std::nullopt;
    ray.ray.tnear = static_cast<float>(std::max(eye, 0.0));
  }
  ray.ray.mask = 0xFFFFFFFFU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree::Context context;
  embree::init(context);
  embree::intersect(scene_->scene, context, ray, true);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Hit hit;
  hit.depth = (kStart - static_cast<double>(ray.ray.tfar)) * unit_;
  hit.point = start + ray.ray.tfar * direction;
  hit.normal = normal_of(&ray, sight, hit.colour);
  const float length = hit.normal.norm();
  const bool has_direction = length > 0 && std::isfinite(length);
  hit.normal = has_direction ? Vec3f(hit.normal / length) : Vec3f(-direction);
  if (hit.normal.dot(direction) > 0) hit.normal = -hit.normal;
  return hit;
}

float TracedActor::occlusion(const Vec3f& point, const Vec3f& normal, const Rays& rays,
                             float reach) const {
  if (!(point.norm() <= static_cast<float>(kMaxDistance) + reach)) return 0;
  // An orthonormal basis about the normal. Source: Duff et al., Building an Orthonormal Basis,
  // Revisited (JCGT 6(1), 2017).
  const float sign = std::copysign(1.0F, normal.z());
  const float a = -1.0F / (sign + normal.z());
  const float b = normal.x() * normal.y() * a;
  const Vec3f across(1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x());
  const Vec3f other(b, sign + normal.y() * normal.y() * a, -normal.y());
  const Vec3f start = point + kStep * normal;
  embree::Context context;
  embree::init(context);
  const Vec3f* ways = rays.directions == 18 ? directions<18>().data() : directions<54>().data();
  int met = 0;
  for (int i = rays.first; i < rays.first + rays.count; ++i) {
    const Vec3f& way = ways[i];
    const Vec3f direction = way.x() * across + way.y() * other + way.z() * normal;
    RTCRay ray{};
    ray.org_x = start.x();
    ray.org_y = start.y();
    ray.org_z = start.z();
    ray.dir_x = direction.x();
    ray.dir_y = direction.y();
    ray.dir_z = direction.z();
    ray.tnear = kStep;
    ray.tfar = reach;
    ray.mask = 0xFFFFFFFFU;
    embree::occluded(scene_->scene, context, ray);
    met += ray.tfar < 0 ? 1 : 0;
  }
  return static_cast<float>(met) / static_cast<float>(rays.count);
}

}  // namespace krok::render

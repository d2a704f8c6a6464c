#include "terrain/shapes.h"

#include <fmt/format.h>

#include <cmath>

#include "core/embree_internal.h"

namespace krok::terrain {

namespace {

// One instruction set on all machines and one build thread, for reproducible results.
constexpr const char* kDevice = "isa=sse4.2,threads=1,set_affinity=0";
constexpr double kFarthestCorner = 1e6;
// The tree uses floats, so its boxes are enlarged by this fraction of the total size.
constexpr double kMargin = 1e-6;

// Twice the signed area over the ground of the corner (x, z) with the edge from `a` to `b`: at
// least 0 inside a triangle that faces up. Same but for the sign for (b, a), so that triangles on
// both sides of an edge agree about it.
double side_of(const Vec3& a, const Vec3& b, double x, double z) {
  const bool swap = std::pair(b.x(), b.z()) < std::pair(a.x(), a.z());
  const Vec3& from = swap ? b : a;
  const Vec3& to = swap ? a : b;
  const double twice = (to.z() - from.z()) * (x - from.x()) - (to.x() - from.x()) * (z - from.z());
  return swap ? -twice : twice;
}

double area_up(const GroundTriangle& triangle) {
  return side_of(triangle[0], triangle[1], triangle[2].x(), triangle[2].z()) / 2;
}

struct Found {
  double x, z, below;
  std::optional<GroundPoint> best;
};

// What Embree hands through to the triangles it meets.
struct Search : embree::Context {
  Found* found = nullptr;
};

class MeshGround final : public Terrain {
 public:
  // `all`: the faces that do not carry, too.
  MeshGround(std::vector<GroundTriangle> triangles, std::vector<GroundTriangle> all)
      : triangles_(std::move(triangles)), solid_(std::move(all)) {
    Eigen::AlignedBox3d box;
    for (const GroundTriangle& triangle : triangles_) {
      for (const Vec3& corner : triangle) box.extend(corner);
    }
    centre_ = box.center();
    top_ = box.max().y();
    bottom_ = box.min().y();
    touching_ = kMargin * (1 + box.diagonal().norm());
  }
  MeshGround(const MeshGround&) = delete;
  MeshGround& operator=(const MeshGround&) = delete;
  ~MeshGround() override {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    if (solid_scene_ != nullptr) rtcReleaseScene(solid_scene_);
    if (device_ != nullptr) rtcReleaseDevice(device_);
  }

  bool build();

  // From Embree's own copy.
  std::vector<GroundTriangle> all_triangles() const {
    const RTCGeometry geometry = rtcGetGeometry(solid_scene_, 0);
    const auto* corners =
        static_cast<const float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    std::vector<GroundTriangle> all(solid_count_);
    for (GroundTriangle& triangle : all) {
      for (Vec3& corner : triangle) {
        corner = centre_ + Vec3f(corners[0], corners[1], corners[2]).cast<double>();
        corners += 3;
      }
    }
    return all;
  }

  bool is_blocked(const Vec3& from, const Vec3& to) const override {
    if (!from.allFinite() || !to.allFinite()) return false;
    RTCRay ray{};
    const Vec3f origin = (from - centre_).cast<float>(), way = (to - from).cast<float>();
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = way.x(), ray.dir_y = way.y(), ray.dir_z = way.z();
    ray.tfar = 1;
    ray.mask = 0xFFFFFFFFu;
    embree::Context context;
    embree::init(context);
    embree::occluded(solid_scene_, context, ray);
    return ray.tfar < 0;
  }

  std::optional<GroundPoint> at(double x, double z, double below) const override {
    if (!std::isfinite(x) || !std::isfinite(z) || !(below >= bottom_)) return std::nullopt;
    Found found{x, z, below, {}};
    const double from = std::min(below, top_) + 2 * touching_;
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(x - centre_.x());
    ray.ray.org_y = static_cast<float>(from - centre_.y());
    ray.ray.org_z = static_cast<float>(z - centre_.z());
    ray.ray.dir_y = -1;
    ray.ray.tfar = static_cast<float>(from - bottom_ + 4 * touching_);
    ray.ray.mask = 0xFFFFFFFFu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    Search search;
    embree::init(search);
    search.found = &found;
    embree::intersect(scene_, search, ray);
    return found.best;
  }

 private:
  bool build_solid();
  void look_at(unsigned index, RTCRay& ray, Found& found) const;

  std::vector<GroundTriangle> triangles_;
  std::vector<GroundTriangle> solid_;  // only while building
  std::size_t solid_count_ = 0;
  Vec3 centre_;
  double top_ = 0, bottom_ = 0;
  double touching_ = 0;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr, solid_scene_ = nullptr;
};

// Plain triangles, for rays in any direction.
bool MeshGround::build_solid() {
  solid_scene_ = rtcNewScene(device_);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                              3 * solid_.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), solid_.size()));
  if (corners == nullptr || indices == nullptr) return false;
  unsigned next = 0;
  for (const GroundTriangle& triangle : solid_) {
    for (const Vec3& corner : triangle) {
      const Vec3f at = (corner - centre_).cast<float>();
      corners = std::copy_n(at.data(), 3, corners);
      *indices++ = next++;
    }
  }
  solid_count_ = solid_.size();
  solid_ = {};
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(solid_scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(solid_scene_);
  return rtcGetDeviceError(device_) == RTC_ERROR_NONE;
}

bool MeshGround::build() {
  device_ = rtcNewDevice(kDevice);
  if (device_ == nullptr) return false;
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles_.size()));
  rtcSetGeometryUserData(geometry, this);
  const auto bounds = [](const RTCBoundsFunctionArguments* arguments) {
    const auto& ground = *static_cast<const MeshGround*>(arguments->geometryUserPtr);
    Eigen::AlignedBox3d one;
    for (const Vec3& corner : ground.triangles_[arguments->primID]) {
      one.extend(corner - ground.centre_);
    }
    const Vec3f low = (one.min().array() - ground.touching_).matrix().cast<float>();
    const Vec3f high = (one.max().array() + ground.touching_).matrix().cast<float>();
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = low.x(), out.lower_y = low.y(), out.lower_z = low.z();
    out.upper_x = high.x(), out.upper_y = high.y(), out.upper_z = high.z();
  };
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  const auto intersect = [](const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->N != 1 || arguments->valid[0] == 0) return;
    auto& ray = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    static_cast<const MeshGround*>(arguments->geometryUserPtr)
        ->look_at(arguments->primID, ray.ray, *static_cast<Search*>(arguments->context)->found);
  };
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  return rtcGetDeviceError(device_) == RTC_ERROR_NONE && build_solid();
}

void MeshGround::look_at(unsigned index, RTCRay& ray, Found& found) const {
  const auto& [a, b, c] = triangles_[index];
  const double u = side_of(b, c, found.x, found.z);
  const double v = side_of(c, a, found.x, found.z);
  const double w = side_of(a, b, found.x, found.z);
  const double sum = u + v + w;
  if (u < 0 || v < 0 || w < 0 || !(sum > 0)) return;
  const double height = (u * a.y() + v * b.y() + w * c.y()) / sum;
  if (!(height <= found.below) || (found.best && found.best->height >= height)) return;
  found.best = GroundPoint{height, (b - a).cross(c - a).normalized()};
  // The margin keeps what is as high as this; the highest of all is found in any order.
  const double depth = ray.org_y - (height - centre_.y()) + 2 * touching_;
  ray.tfar = std::min(ray.tfar, static_cast<float>(depth));
}

}  // namespace

Result<std::unique_ptr<Terrain>> mesh_ground(std::vector<GroundTriangle> triangles,
                                             bool* reversed) {
  if (triangles.size() > kMaxGroundTriangles) {
    return Error(
        "ground-size",
        fmt::format("{} triangles are more than {}", triangles.size(), kMaxGroundTriangles),
        "simplify the mesh");
  }
  double up = 0, down = 0;
  for (const GroundTriangle& triangle : triangles) {
    for (const Vec3& corner : triangle) {
      if ((corner.array().abs() <= kFarthestCorner).all()) continue;
      return Error("ground-value",
                   fmt::format("a corner of the mesh is at ({}, {}, {}) m", corner.x(), corner.y(),
                               corner.z()),
                   "keep the ground within 1000 km of the origin");
    }
    const double area = area_up(triangle);
    (area > 0 ? up : down) += std::abs(area);
  }
  const bool turn = down > 2 * up;
  if (reversed != nullptr) *reversed = turn;
  if (turn) {
    for (GroundTriangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
  std::vector<GroundTriangle> all = triangles;
  std::erase_if(triangles, [](const GroundTriangle& triangle) { return !(area_up(triangle) > 0); });
  if (triangles.empty()) {
    return Error("ground-empty", "no triangle of the mesh faces up", "check which axis is up");
  }
  triangles.shrink_to_fit();
  auto ground = std::make_unique<MeshGround>(std::move(triangles), std::move(all));
  if (!ground->build()) return Error("ground-memory", "Embree could not build the mesh's tree");
  return std::unique_ptr<Terrain>(std::move(ground));
}

std::optional<std::vector<GroundTriangle>> triangles_of(const Terrain& ground) {
  const auto* mesh = dynamic_cast<const MeshGround*>(&ground);
  if (mesh == nullptr) return {};
  return mesh->all_triangles();
}

}  // namespace krok::terrain

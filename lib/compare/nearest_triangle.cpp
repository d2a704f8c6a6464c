#include <algorithm>
#include <limits>

#include "compare/nearest_triangle_internal.h"
#include "core/embree_internal.h"

namespace krok::compare {

namespace {

// One instruction set on all machines and one build thread, for reproducible results.
constexpr const char* kDevice = "isa=sse4.2,threads=1,set_affinity=0";

// The tree uses floats, so its boxes and search radii are enlarged by this fraction of the total
// size; distances are computed in doubles.
constexpr double kMargin = 1e-6;

std::array<double, 3> nearest_on_edges(const std::array<Vec3, 3>& triangle, const Vec3& point) {
  std::array<double, 3> best{1, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Vec3 along = triangle[j] - triangle[i];
    const double square = along.squaredNorm();
    const double t =
        square > 0 ? std::clamp(along.dot(point - triangle[i]) / square, 0.0, 1.0) : 0.0;
    const double distance = (triangle[i] + t * along - point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {};
    best[i] = 1 - t;
    best[j] = t;
  }
  return best;
}

struct Search {
  const std::vector<Facet>& facets;
  Vec3 point;
  double touching;
  double near;
  double margin;
  double nearest = std::numeric_limits<double>::infinity();
  std::vector<FoundFacet>& found;

  double reach() const { return std::max(nearest + touching, near); }
};

bool look_at(RTCPointQueryFunctionArguments* arguments) {
  Search& search = *static_cast<Search*>(arguments->userPtr);
  FoundFacet one;
  one.facet = arguments->primID;
  const auto& corners = search.facets[one.facet].points;
  one.shares = nearest_shares(corners, search.point);
  Vec3 place = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) place += one.shares[k] * corners[k];
  one.distance = (place - search.point).norm();
  if (one.distance > search.reach()) return false;
  search.found.push_back(one);
  if (one.distance >= search.nearest) return false;
  search.nearest = one.distance;
  arguments->query->radius = static_cast<float>(search.reach() * (1 + kMargin) + search.margin);
  return true;
}

}  // namespace

std::array<double, 3> nearest_shares(const std::array<Vec3, 3>& triangle, const Vec3& point) {
  const auto& [a, b, c] = triangle;
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 ap = point - a, bp = point - b, cp = point - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  const double sum = va + vb + vc;
  if (va <= 0 || vb <= 0 || vc <= 0 || !(sum > 0)) return nearest_on_edges(triangle, point);
  return {va / sum, vb / sum, vc / sum};
}

struct FacetTree::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

FacetTree::~FacetTree() = default;

FacetTree::FacetTree(std::vector<Facet> facets)
    : facets_(std::move(facets)), embree_(std::make_unique<Embree>()) {
  Eigen::AlignedBox3d box;
  for (const Facet& facet : facets_) {
    for (const Vec3& point : facet.points) box.extend(point);
  }
  centre_ = box.center();
  size_ = box.diagonal().norm();
  touching_ = kMargin * size_;
}

std::unique_ptr<const FacetTree> FacetTree::create(std::vector<Facet> facets) {
  std::unique_ptr<FacetTree> tree(new FacetTree(std::move(facets)));
  if (!tree->build()) return nullptr;
  return tree;
}

bool FacetTree::build() {
  embree_->device = rtcNewDevice(kDevice);
  if (embree_->device == nullptr) return false;
  embree_->scene = rtcNewScene(embree_->device);
  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(facets_.size()));
  rtcSetGeometryUserData(geometry, this);
  const auto bounds = [](const RTCBoundsFunctionArguments* arguments) {
    const auto& tree = *static_cast<const FacetTree*>(arguments->geometryUserPtr);
    Eigen::AlignedBox3d one;
    for (const Vec3& point : tree.facets_[arguments->primID].points)
      one.extend(point - tree.centre_);
    const Vec3f low = (one.min().array() - tree.touching_).matrix().cast<float>();
    const Vec3f high = (one.max().array() + tree.touching_).matrix().cast<float>();
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = low.x(), out.lower_y = low.y(), out.lower_z = low.z();
    out.upper_x = high.x(), out.upper_y = high.y(), out.upper_z = high.z();
  };
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  return rtcGetDeviceError(embree_->device) == RTC_ERROR_NONE;
}

void FacetTree::find(const Vec3& point, std::vector<FoundFacet>& found, double near) const {
  found.clear();
  const Vec3 from = point - centre_;
  // Allows for float rounding of points far away from everything, too.
  const double margin = 4 * kMargin * (size_ + from.norm());
  Search search{facets_, point, touching_, near, margin, std::numeric_limits<double>::infinity(),
                found};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query;
  query.x = static_cast<float>(from.x());
  query.y = static_cast<float>(from.y());
  query.z = static_cast<float>(from.z());
  query.time = 0;
  query.radius = std::numeric_limits<float>::infinity();
  rtcPointQuery(embree_->scene, &query, &context, look_at, &search);
  std::erase_if(found, [&](const FoundFacet& one) { return one.distance > search.reach(); });
  std::sort(found.begin(), found.end(),
            [](const FoundFacet& a, const FoundFacet& b) { return a.facet < b.facet; });
}

}  // namespace krok::compare

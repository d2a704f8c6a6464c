#pragma once

#include <utility>
#include <vector>

#include "math/transform.h"

// The implicit surface of a body: tubes along the bones. Connected tubes are blended smoothly;
// tubes that merely come close are not, so that an arm beside the trunk stays separate.

namespace krok::body {

// A cross-section of a tube: an ellipse around `center` with half-axes `width` along `side` and
// `depth` along `front` (unit vectors, perpendicular). `cap` is the half-axis along the tube if it
// ends here.
struct Station {
  Vec3 center = Vec3::Zero();
  double width = 0, depth = 0;
  Vec3 side = Vec3::UnitX(), front = Vec3::UnitZ();
  double cap = 0;     // 0: the smaller of width and depth
  double arc = 0;     // parameter along the tube, see TubeJoint::at
  double along = 0;   // distance from the root along the bones
  double detail = 1;  // target edge length, relative to the rest of the body
};

// A half-space that cuts a tube: inside is normal . x <= offset. `blend` rounds the edge.
struct Cut {
  Vec3 normal = Vec3::UnitY();
  double offset = 0, blend = 0;
};

// From Station::arc = `at` on the tube follows `joint`, fading in over `half_width` on either side.
struct TubeJoint {
  int joint = 0;
  double at = 0, half_width = 0;
};

struct Tube {
  std::vector<Station> stations;  // at least one
  std::vector<TubeJoint>
      joints;  // at least one, by increasing `at`; the first also applies before its `at`
  std::vector<Cut> cuts;
  bool spline = true;  // spline through the stations instead of straight segments
};

// Tubes that are blended into each other over about `radius`.
struct Blend {
  std::vector<int> tubes;
  double radius = 0;
};

struct Shape {
  std::vector<Tube> tubes;
  std::vector<Blend> blends;

  int add(Tube tube) {
    tubes.push_back(std::move(tube));
    return static_cast<int>(tubes.size()) - 1;
  }
};

// The closest location on a tube to a point.
struct TubePoint {
  double value = 0;  // approximate signed distance
  int tube = 0;
  int segment = 0;      // between stations segment and segment + 1 of Field::tube_stations
  double fraction = 0;  // in [0, 1]
};

// Evaluates a shape. Immutable after construction and safe to share between threads. Uses only
// +, -, *, / and sqrt, so that results are bit-identical on every machine.
class Field {
 public:
  explicit Field(const Shape& shape);

  // The tubes that can affect points within `radius` of `center`.
  struct Near {
    struct Range {
      int tube, first, last;  // segments [first, last]
    };
    std::vector<Range> ranges;
    std::vector<int> blends;
  };
  Near near(const Vec3& center, double radius) const;

  // Negative inside, positive outside; near the surface about the signed distance.
  double value(const Vec3& point, const Near& near) const;
  // By finite differences over `step`; `value` is the value at the point.
  Vec3 gradient(const Vec3& point, double value, const Near& near, double step) const;

  // The closest locations on all tubes of `near`, nearest first.
  std::vector<TubePoint> places(const Vec3& point, const Near& near) const;

  // The first of places(); tube is -1 if there is none.
  TubePoint nearest_place(const Vec3& point, const Near& near) const;

  Station station_at(const TubePoint& place) const;
  double detail_at(const TubePoint& place) const;  // of station_at
  // Appends the joints that move a location, with weights that sum to `scale`, to `weights`.
  void bind(const TubePoint& place, double scale,
            std::vector<std::pair<int, double>>& weights) const;
  bool blended(int tube_a, int tube_b) const;
  double blend_radius(int tube_a, int tube_b) const;

  Eigen::AlignedBox3d bounds() const { return bounds_; }
  double area_estimate() const { return area_; }
  double smallest_radius() const { return smallest_radius_; }
  // Balls that together contain the surface, one per segment.
  struct Ball {
    Vec3 center;
    double radius;
  };
  std::vector<Ball> balls() const;

 private:
  struct Path {
    std::vector<Station> stations;  // sampled from the spline; a single station is a ball
    std::vector<Ball> balls;        // around each segment
    std::vector<Cut> cuts;
    std::vector<TubeJoint> joints;
    double margin = 0;  // the largest radius that it is blended with
  };
  double segment_value(const Path& path, int segment, const Vec3& point, double* fraction) const;
  // From which value on a tube changes nothing where another one's is `nearest`.
  double limit_of(int tube, double nearest) const;
  // Where it is more than `limit`, the largest number may come instead.
  double tube_value(int tube, int first, int last, const Vec3& point, double limit, int* segment,
                    double* fraction) const;

  std::vector<Path> paths_;
  std::vector<Blend> blends_;
  std::vector<std::vector<double>> pair_radius_;  // [tubes x tubes], 0 where not blended
  Eigen::AlignedBox3d bounds_;
  double area_ = 0, smallest_radius_ = 0;
};

}  // namespace krok::body

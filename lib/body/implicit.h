#pragma once

#include <utility>
#include <vector>

#include "math/types.h"

// The implicit surface of a body: tubes along the bones, blended smoothly where they belong
// together and not at all where they merely come close, so that an arm beside the trunk stays
// apart.

namespace krok::body {

// A cross-section of a tube: an ellipse about `center` with half-axes `width` along `side` and
// `depth` along `front` (unit vectors, perpendicular). `cap` is the half-axis along the tube where
// it ends here.
struct Station {
  Vec3 center = Vec3::Zero();
  double width = 0, depth = 0;
  Vec3 side = Vec3::UnitX(), front = Vec3::UnitZ();
  double cap = 0;     // 0: the smaller of width and depth
  double arc = 0;     // where the tube's joints take over from each other, see Tube::joints
  double along = 0;   // distance from the root along the bones
  double detail = 1;  // edge length wanted here, relative to the rest of the body
};

// A half-space that cuts a tube: the inside is where normal . x <= offset. `blend` rounds the edge.
struct Cut {
  Vec3 normal = Vec3::UnitY();
  double offset = 0, blend = 0;
};

// From Station::arc = `at` on the tube follows `joint`, coming in over `half_width` on either side.
struct TubeJoint {
  int joint = 0;
  double at = 0, half_width = 0;
};

struct Tube {
  std::vector<Station> stations;  // at least one
  std::vector<TubeJoint>
      joints;  // at least one, in rising order of `at`; the first holds before it too
  std::vector<Cut> cuts;
  bool spline = true;  // round the path and the profile through the stations
};

// Tubes that melt into each other over about `radius`.
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

// Where a point lies on a tube.
struct TubePoint {
  double value = 0;  // signed distance, about
  int tube = 0;
  int segment = 0;      // between stations segment and segment + 1 of Field::tube_stations
  double fraction = 0;  // in [0, 1]
};

// Evaluates a shape. Built once, then read by many threads. Uses +, -, *, / and sqrt alone, so that
// the same bits come out on every machine.
class Field {
 public:
  explicit Field(const Shape& shape);

  // The tubes that can matter within `radius` of `center`.
  struct Near {
    struct Range {
      int tube, first, last;  // segments [first, last]
    };
    std::vector<Range> ranges;
    std::vector<int> blends;
  };
  Near near(const Vec3& center, double radius) const;

  // Below zero inside, above outside, about the distance to the surface close to it.
  double value(const Vec3& point, const Near& near) const;
  // By differences over `step`; `value` is the one at the point.
  Vec3 gradient(const Vec3& point, double value, const Near& near, double step) const;

  // The places on all tubes of `near`, nearest first.
  std::vector<TubePoint> places(const Vec3& point, const Near& near) const;

  // The first of them, or one with tube -1 where there is none.
  TubePoint nearest_place(const Vec3& point, const Near& near) const;

  Station station_at(const TubePoint& place) const;
  double detail_at(const TubePoint& place) const;  // of station_at
  // The joints that move the place, with weights that sum to 1; appended to `weights`, times
  // `scale`.
  void bind(const TubePoint& place, double scale,
            std::vector<std::pair<int, double>>& weights) const;
  bool blended(int tube_a, int tube_b) const;
  double blend_radius(int tube_a, int tube_b) const;

  Eigen::AlignedBox3d bounds() const { return bounds_; }
  double area_estimate() const { return area_; }
  double smallest_radius() const { return smallest_radius_; }
  // Balls that together hold the surface: one a segment.
  struct Ball {
    Vec3 center;
    double radius;
  };
  std::vector<Ball> balls() const;

 private:
  struct Path {
    std::vector<Station> stations;  // after the spline; one station is a ball
    std::vector<Ball> balls;        // around each segment
    std::vector<Cut> cuts;
    std::vector<TubeJoint> joints;
  };
  double segment_value(const Path& path, int segment, const Vec3& point, double* fraction) const;
  double tube_value(int tube, int first, int last, const Vec3& point, int* segment,
                    double* fraction) const;

  std::vector<Path> paths_;
  std::vector<Blend> blends_;
  std::vector<std::vector<double>> pair_radius_;  // [tubes x tubes], 0 where not blended
  Eigen::AlignedBox3d bounds_;
  double area_ = 0, smallest_radius_ = 0, margin_ = 0;
};

}  // namespace krok::body

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "math/transform.h"
#include "skin/skin_job_internal.h"

// The scalar references. Operations are in the same order as in the kernels.

namespace krok::skin_detail {

namespace {

struct Vector {
  float x, y, z;
};

// The influences of one vertex.
struct Vertex {
  const std::uint16_t* joints;
  const std::uint32_t* pairs;
  const float* weights;
  std::size_t influences;
};

Vertex vertex_of(const Job& job, std::size_t v) {
  const Influences& all = job.influences;
  const std::size_t begin = v / kBlock * kBlock;
  const Run run = run_from(all, begin, begin + kBlock);
  const std::size_t first = run.first + (v - begin) * run.influences;
  return {all.joints + first, all.pairs == nullptr ? nullptr : all.pairs + first,
          all.weights + first, run.influences};
}

template <class Entry>
void blend(const Vertex& vertex, std::size_t floats, const Entry& entry, float* sum) {
  for (std::size_t e = 0; e < floats; ++e) sum[e] = vertex.weights[0] * entry(0)[e];
  for (std::size_t k = 1; k < vertex.influences; ++k) {
    for (std::size_t e = 0; e < floats; ++e) {
      sum[e] = std::fma(vertex.weights[k], entry(k)[e], sum[e]);
    }
  }
}

float dot(const Vector& a, const Vector& b) {
  return std::fma(a.x, b.x, std::fma(a.y, b.y, a.z * b.z));
}
float difference(float a, float b, float c, float d) {  // a b - c d
  return std::fma(a, b, -(c * d));
}
Vector cross(const Vector& a, const Vector& b) {
  return {difference(a.y, b.z, a.z, b.y), difference(a.z, b.x, a.x, b.z),
          difference(a.x, b.y, a.y, b.x)};
}
// a x + b y + c z, fused from the right.
Vector combined(const Vector& a, float x, const Vector& b, float y, const Vector& c, float z) {
  return {std::fma(a.x, x, std::fma(b.x, y, c.x * z)), std::fma(a.y, x, std::fma(b.y, y, c.y * z)),
          std::fma(a.z, x, std::fma(b.z, y, c.z * z))};
}

bool is_regular(float square) {
  return square >= kMinLengthSquared && square <= kMaxLengthSquared;
}

bool normalize(Vector& v) {
  const float square = dot(v, v);
  if (!is_regular(square)) return false;
  const float scale = 1.0f / std::sqrt(square);
  v = {v.x * scale, v.y * scale, v.z * scale};
  return true;
}

// The columns of a palette matrix.
struct Columns {
  Vector x, y, z, origin;

  explicit Columns(const float* m)
      : x{m[0], m[1], m[2]},
        y{m[4], m[5], m[6]},
        z{m[8], m[9], m[10]},
        origin{m[12], m[13], m[14]} {}

  Vector point(const Vector& p) const {
    const auto row = [&](float mx, float my, float mz, float o) {
      return std::fma(mx, p.x, std::fma(my, p.y, std::fma(mz, p.z, o)));
    };
    return {row(x.x, y.x, z.x, origin.x), row(x.y, y.y, z.y, origin.y),
            row(x.z, y.z, z.z, origin.z)};
  }
  Vector vector(const Vector& v) const { return combined(x, v.x, y, v.y, z, v.z); }

  // +1, or -1 for a reflection.
  float handedness() const { return std::copysign(1.0f, dot(x, cross(y, z))); }

  // The inverse transpose times a positive factor: cofactors times the sign of the determinant.
  Vector normal(const Vector& n) const {
    const Vector c = combined(cross(y, z), n.x, cross(z, x), n.y, cross(x, y), n.z);
    const float sign = handedness();
    return {c.x * sign, c.y * sign, c.z * sign};
  }
};

Vector normal_by(const Columns& columns, bool inverse_transpose, const Vector& n) {
  return inverse_transpose ? columns.normal(n) : columns.vector(n);
}

struct Motion {
  Vector r, d;
  float rw, dw;

  explicit Motion(const float* q) : r{q[0], q[1], q[2]}, d{q[4], q[5], q[6]}, rw(q[3]), dw(q[7]) {}

  bool normalize() {
    const float square = std::fma(r.x, r.x, std::fma(r.y, r.y, std::fma(r.z, r.z, rw * rw)));
    if (!is_regular(square)) return false;
    const float scale = 1.0f / std::sqrt(square);
    r = {r.x * scale, r.y * scale, r.z * scale};
    d = {d.x * scale, d.y * scale, d.z * scale};
    rw *= scale;
    dw *= scale;
    return true;
  }

  // From rotation q and q(centre) - centre = d to the rigid transform that takes the centre there:
  // d becomes t q / 2 with t = centre + d - q centre q*.
  void turn_about(const Vector& centre) {
    const float square = std::fma(r.x, r.x, std::fma(r.y, r.y, std::fma(r.z, r.z, rw * rw)));
    const float scale = is_regular(square) ? 1.0f / std::sqrt(square) : 1.0f;
    r = {r.x * scale, r.y * scale, r.z * scale};
    rw *= scale;
    const Vector moved = vector(centre);
    const Vector t{centre.x + d.x - moved.x, centre.y + d.y - moved.y, centre.z + d.z - moved.z};
    const Vector c = cross(t, r);
    d = {0.5f * std::fma(rw, t.x, c.x), 0.5f * std::fma(rw, t.y, c.y),
         0.5f * std::fma(rw, t.z, c.z)};
    dw = -0.5f * dot(t, r);
  }

  // r x v + w v; the rotation adds 2 r x (this) to v.
  Vector half_way(const Vector& v) const {
    const Vector c = cross(r, v);
    return {std::fma(rw, v.x, c.x), std::fma(rw, v.y, c.y), std::fma(rw, v.z, c.z)};
  }
  Vector vector(const Vector& v) const {
    const Vector c = cross(r, half_way(v));
    return {std::fma(2.0f, c.x, v.x), std::fma(2.0f, c.y, v.y), std::fma(2.0f, c.z, v.z)};
  }
  Vector point(const Vector& p) const {
    const Vector u = half_way(p);
    const Vector c = cross(r, {u.x + d.x, u.y + d.y, u.z + d.z});
    const auto moved = [&](float from, float turn, float di, float ri) {
      return std::fma(2.0f, std::fma(-dw, ri, std::fma(rw, di, turn)), from);
    };
    return {moved(p.x, c.x, d.x, r.x), moved(p.y, c.y, d.y, r.y), moved(p.z, c.z, d.z, r.z)};
  }
};

Vector read(const float* from) {
  return {from[0], from[1], from[2]};
}
void write(const Vector& v, float* to) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

// `blended` and `first` transform a normal or tangent by all influences and by the first only.
template <class Blended, class First>
void write_direction(const Vector& from, const Blended& blended, const First& first,
                     const Vector& last_resort, float* to) {
  Vector v = blended(from);
  if (!normalize(v)) {
    v = first(from);
    if (!normalize(v)) v = last_resort;
  }
  write(v, to);
}

constexpr Vector kUp = {0, 1, 0};
constexpr Vector kAside = {1, 0, 0};

}  // namespace

void linear_scalar(const Job& job, std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    const Vertex vertex = vertex_of(job, v);
    const auto entry = [&](std::size_t k) { return job.palette[vertex.joints[k]].elements; };
    float sum[16];
    blend(vertex, 16, entry, sum);
    const Columns all(sum), first(entry(0));
    write(all.point(read(job.positions + 3 * v)), job.out_positions + 3 * v);
    if (job.normals != nullptr) {
      const auto by = [&](const Columns& columns) {
        return [&](const Vector& n) { return normal_by(columns, job.inverse_transpose, n); };
      };
      write_direction(read(job.normals + 3 * v), by(all), by(first), kUp, job.out_normals + 3 * v);
    }
    if (job.tangents != nullptr) {
      const float* from = job.tangents + 4 * v;
      float* to = job.out_tangents + 4 * v;
      write_direction(
          read(from), [&](const Vector& t) { return all.vector(t); },
          [&](const Vector& t) { return first.vector(t); }, kAside, to);
      to[3] = job.inverse_transpose ? from[3] * all.handedness() : from[3];
    }
  }
}

namespace {

// The two phases of one vertex: an optional deformation and a rigid transform.
struct TwoPhases {
  const Columns* deformation;
  Motion motion;

  Vector point(const Vector& p) const {
    return motion.point(deformation != nullptr ? deformation->point(p) : p);
  }
  Vector normal(const Vector& n) const {
    return motion.vector(deformation != nullptr ? deformation->normal(n) : n);
  }
  Vector tangent(const Vector& t) const {
    return motion.vector(deformation != nullptr ? deformation->vector(t) : t);
  }
};

}  // namespace

void dual_quaternion_scalar(const Job& job, std::size_t begin, std::size_t end) {
  static_assert(sizeof(DualQuaternion) == 8 * sizeof(float));
  for (std::size_t v = begin; v < end; ++v) {
    const Vertex vertex = vertex_of(job, v);
    assert(vertex.pairs != nullptr);  // as bindings for this method have them
    const auto motion_of = [&](std::size_t k) { return job.motions[vertex.pairs[k]].components; };
    const auto matrix_of = [&](std::size_t k) { return job.palette[vertex.joints[k]].elements; };
    float motion_sum[8], matrix_sum[16] = {};
    blend(vertex, 8, motion_of, motion_sum);
    const bool deforms = job.palette != nullptr;
    if (deforms) blend(vertex, 16, matrix_of, matrix_sum);
    const Columns blended(matrix_sum), first_matrix(deforms ? matrix_of(0) : matrix_sum);
    TwoPhases first{deforms ? &first_matrix : nullptr, Motion(motion_of(0))};
    TwoPhases all{deforms ? &blended : nullptr, Motion(motion_sum)};
    if (job.centres != nullptr) {
      const Vector centre = read(job.centres[vertex.pairs[0]].data());
      first.motion.turn_about(centre);
      all.motion.turn_about(centre);
    }
    first.motion.normalize();
    if (!all.motion.normalize()) all.motion = first.motion;
    write(all.point(read(job.positions + 3 * v)), job.out_positions + 3 * v);
    if (job.normals != nullptr) {
      write_direction(
          read(job.normals + 3 * v), [&](const Vector& n) { return all.normal(n); },
          [&](const Vector& n) { return first.normal(n); }, kUp, job.out_normals + 3 * v);
    }
    if (job.tangents != nullptr) {
      const float* from = job.tangents + 4 * v;
      float* to = job.out_tangents + 4 * v;
      write_direction(
          read(from), [&](const Vector& t) { return all.tangent(t); },
          [&](const Vector& t) { return first.tangent(t); }, kAside, to);
      to[3] = deforms ? from[3] * blended.handedness() : from[3];
    }
  }
}

// Spherical blend skinning, but for its blend itself (skin_scalar.cpp): sets of joints and their
// rotation centres.

namespace {

// Added to squared singular values of 4 sin^2(angle / 2), so that the centre of joints that hardly
// turn against each other tends to the mean of the joints.
constexpr double kDamping = 1e-6;

struct Rotation {
  Mat3 matrix;
  Vec3 translation;

  explicit Rotation(const DualQuaternion& of) {
    const float* c = of.components;
    const Quat q = Quat(c[3], c[0], c[1], c[2]).normalized();
    const Quat dual(c[7], c[4], c[5], c[6]);
    matrix = q.toRotationMatrix();
    translation = 2 * (dual * q.conjugate()).vec();
  }
};

// x of the smallest sum over all pairs of |(R_a - R_b) x + t_a - t_b|^2, plus kDamping |x -
// start|^2.
Vec3 rotation_centre(std::span<const std::uint16_t> set, const std::vector<DualQuaternion>& motions,
                     const Vec3& start) {
  Mat3 a = kDamping * Mat3::Identity();
  Vec3 b = Vec3::Zero();
  for (std::size_t i = 0; i < set.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Rotation one(motions[set[i]]), other(motions[set[k]]);
      const Mat3 turn = one.matrix - other.matrix;
      a += turn.transpose() * turn;
      b -= turn.transpose() * (turn * start + one.translation - other.translation);
    }
  }
  Mat3 inverse;  // by cofactors; a is symmetric and positive definite
  inverse << a.col(1).cross(a.col(2)), a.col(2).cross(a.col(0)), a.col(0).cross(a.col(1));
  return start + inverse * b / a.col(0).dot(a.col(1).cross(a.col(2)));
}

}  // namespace

std::uint32_t SetNumbers::set(std::vector<std::uint16_t> joints) {
  std::ranges::sort(joints);
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  const auto [found, is_new] =
      sets_.emplace(std::move(joints), static_cast<std::uint32_t>(sets_.size()));
  if (is_new) binding_.sets.push_back(found->first);
  return found->second;
}

std::uint32_t SetNumbers::pair(std::uint32_t set, std::uint16_t joint) {
  const auto [found, is_new] =
      pairs_.emplace(std::pair(set, joint), static_cast<std::uint32_t>(pairs_.size()));
  if (is_new) {
    binding_.pairs.push_back({binding_.sets[set].front(), joint});
    binding_.pair_sets.push_back(set);
  }
  return found->second;
}

void fill_centres(Posed& pose) {
  const Binding& binding = *pose.binding;
  for (std::size_t s = 0; s < binding.sets.size(); ++s) {
    const auto& set = binding.sets[s];
    Vec3 start = binding.joint_to_world[set.front()].position;
    if (set.size() > 1) start.setZero();
    for (std::size_t k = 1; k < set.size(); ++k) {
      start += binding.joint_to_world[set[k]].position / static_cast<double>(set.size() - 1);
    }
    pose.set_centres[s] = rotation_centre(set, pose.motions, start);
  }
  for (std::size_t i = 0; i < binding.pairs.size(); ++i) {
    const Vec3& centre = pose.set_centres[binding.pair_sets[i]];
    const Rotation rotation(pose.motions[binding.pairs[i].joint]);
    const Vec3 moved = rotation.matrix * centre + rotation.translation - centre;
    float* components = pose.pair_motions[i].components;
    for (int k = 0; k < 3; ++k) components[4 + k] = static_cast<float>(moved[k]);
    components[7] = 0;
    pose.pair_centres[i] = centre.cast<float>();
  }
}

}  // namespace krok::skin_detail

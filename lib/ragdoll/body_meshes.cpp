#include "ragdoll/bodies.h"

#include <cmath>

#include "core/index.h"

namespace krok::ragdoll {

namespace {

constexpr int kAround = 24, kRings = 12;  // of round shapes; rings from pole to pole, even

class MeshMaker {
 public:
  explicit MeshMaker(Model& model) : model_(model) {}

  void add(const Body& body, const Transform& to_model) {
    joint_ = body.joint;
    to_model_ = to_model;
    const auto first = static_cast<std::uint32_t>(model_.triangles.size());
    if (body.shape.kind == Shape::Kind::box) {
      add_box(body.shape.half);
    } else {
      add_round(body.shape.radius,
                body.shape.kind == Shape::Kind::capsule ? body.shape.half_length : 0);
    }
    const auto count = static_cast<std::uint32_t>(model_.triangles.size()) - first;
    model_.parts.push_back({body.name, "bodies", first, count});
  }

 private:
  std::uint32_t vertex(const Vec3& position, const Vec3& normal) {
    model_.positions.push_back((to_model_ * position).cast<float>());
    model_.normals.push_back((to_model_.orientation * normal).normalized().cast<float>());
    model_.influence_joints.push_back(static_cast<std::uint16_t>(joint_));
    model_.influence_weights.push_back(1);
    return static_cast<std::uint32_t>(model_.positions.size()) - 1;
  }

  void add_box(const Vec3& half) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vec3 out = side * Vec3::Unit(axis);
        const Vec3 u = Vec3::Unit((axis + 1) % 3), v = out.cross(u);
        std::array<std::uint32_t, 4> corners{};
        for (std::size_t i = 0; i < 4; ++i) {
          const Vec3 corner = out + (i == 0 || i == 3 ? -1.0 : 1.0) * u + (i < 2 ? -1.0 : 1.0) * v;
          corners[i] = vertex(corner.cwiseProduct(half), out);
        }
        model_.triangles.push_back({corners[0], corners[1], corners[2]});
        model_.triangles.push_back({corners[0], corners[2], corners[3]});
      }
    }
  }

  // Rings about y from the lower pole up; the middle ring is there twice, at both ends of the side.
  void add_round(double radius, double half_length) {
    std::uint32_t before = 0;
    for (int ring = 0; ring <= kRings + 1; ++ring) {
      const int step = ring <= kRings / 2 ? ring : ring - 1;
      const double angle = kPi * (static_cast<double>(step) / kRings - 0.5);
      const double end = ring <= kRings / 2 ? -half_length : half_length;
      const auto first = static_cast<std::uint32_t>(model_.positions.size());
      for (int i = 0; i < kAround; ++i) {
        const double turn = 2 * kPi * i / kAround;
        const Vec3 out(std::cos(angle) * std::sin(turn), std::sin(angle),
                       std::cos(angle) * std::cos(turn));
        vertex(radius * out + end * Vec3::UnitY(), out);
      }
      for (std::uint32_t i = 0; ring > 0 && i < kAround; ++i) {
        const std::uint32_t next = (i + 1) % kAround;
        if (ring > 1) model_.triangles.push_back({before + i, before + next, first + next});
        if (ring <= kRings) model_.triangles.push_back({before + i, first + next, first + i});
      }
      before = first;
    }
  }

  Model& model_;
  int joint_ = 0;
  Transform to_model_;
};

}  // namespace

Model body_meshes(const Skeleton& skeleton, const std::vector<Body>& bodies) {
  Model model;
  model.skeleton = skeleton;
  model.influences_per_vertex = 1;
  MeshMaker maker(model);
  for (const Body& body : bodies) {
    maker.add(body, skeleton.reference[at(body.joint)] * body.to_joint);
  }
  return model;
}

}  // namespace krok::ragdoll

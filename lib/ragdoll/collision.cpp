#include "ragdoll/impulse_solver_internal.h"

#include <btBulletCollisionCommon.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/index.h"
#include "ragdoll/faces_internal.h"
#include "ragdoll/ground_edges_internal.h"

namespace krok::ragdoll {

namespace {

constexpr double kWall = 1e-3;  // of a face's normal, upwards

Vec3 corner_of(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

void Faces::processTriangle(btVector3* corners, int /*part*/, int number) {
  numbers_.push_back(number);
  Face face;
  for (std::size_t k = 0; k < 3; ++k) face.corners[k] = corner_of(corners[k]);
  const auto& [a, b, c] = face.corners;
  face.normal = (b - a).cross(c - a);
  const double size = face.normal.norm();
  if (!(size > 1e-12)) return;
  face.normal /= size;
  face.inward = {face.normal.cross(b - a), face.normal.cross(c - b), face.normal.cross(a - c)};
  face.wall = std::abs(face.normal.y()) < kWall;
  if (face.normal.y() < 0) face.normal = -face.normal;  // ground is solid below
  if (const Vec3& out = edges_.wall_side(number); face.wall && !out.isZero()) {
    face.normal = out;
    face.wall = false;
  }
  faces_.push_back(face);
}

void find_touches(const Vec3& point, double radius, const Vec3& free, double reach,
                  std::span<const Faces::Face> faces, std::vector<Touch>& touches) {
  touches.clear();
  for (const Faces::Face& face : faces) {
    const double side = face.wall && face.normal.dot(free - face.corners[0]) < 0 ? -1 : 1;
    const Vec3 normal = side * face.normal;
    const Vec3 on_body = point - radius * normal;
    const double gap = normal.dot(on_body - face.corners[0]);
    if (gap < -kThick || gap > reach || !face.is_beside(on_body)) continue;
    touches.push_back({gap, normal, on_body});
  }
  std::ranges::stable_sort(touches, std::greater(), &Touch::gap);
  std::size_t kept = 0;
  Vec3 out = Vec3::Zero();
  for (const Touch& candidate : touches) {
    if (kept == kTouches) break;
    const Vec3 on_face = candidate.on_body - candidate.gap * candidate.normal;
    const auto behind = [&](const Faces::Face& face) {  // and not another step's wall
      return std::abs(face.normal.dot(candidate.normal)) > kSameWay &&
             std::abs(face.normal.dot(face.corners[0] - on_face)) < kThick &&
             face.is_beside(candidate.on_body + out);
    };
    if (kept > 0 && (touches[0].normal.dot(candidate.normal) > kSameWay ||
                     !std::ranges::any_of(faces, behind))) {
      continue;
    }
    touches[kept++] = candidate;
    if (candidate.gap < 0) out -= 1.01 * candidate.gap * candidate.normal;
  }
  touches.resize(kept);
}

namespace {

// Bullet keeps contacts up to this distance, metres: what falls 10 m/s comes that far in a step.
constexpr float kReach = 0.04F;
constexpr double kSamePlace = 0.03;  // metres between points of one contact

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

btTransform placed(const Transform& t) {
  const Quat& q = t.orientation;
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     to_bullet(t.position));
}

// Bullet sets memory aside for 4096 pairs, which takes longer than a short fall; what a character
// has is some dozens, and more than that it would allocate.
btDefaultCollisionConstructionInfo small_pools() {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = 128;
  info.m_defaultMaxCollisionAlgorithmPoolSize = 128;
  return info;
}

std::unique_ptr<btCollisionShape> make_shape(const Shape& shape) {
  const auto number = [](double value) { return static_cast<btScalar>(value); };
  switch (shape.kind) {
    case Shape::Kind::capsule:
      return std::make_unique<btCapsuleShape>(number(shape.radius), number(2 * shape.half_length));
    case Shape::Kind::sphere:
      return std::make_unique<btSphereShape>(number(shape.radius));
    case Shape::Kind::box:
      break;
  }
  auto box = std::make_unique<btBoxShape>(to_bullet(shape.half));
  // Bullet rounds boxes off by a margin of 4 cm, more than half of a hand.
  box->setMargin(number(0.1 * shape.half.minCoeff()));
  return box;
}

}  // namespace

// A body as a box, of which all points are within a radius.
struct Solid {
  Shape shape;
  Vec3 half = shape.kind == Shape::Kind::box ? shape.half : Vec3(0, shape.half_length, 0);
  double radius = shape.kind == Shape::Kind::box ? 0 : shape.radius;
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
};

namespace {

// Farther than Bullet keeps contacts, by planes across the line of centres and across the axes.
bool are_apart(const Solid& a, const Solid& b) {
  const Vec3 way = b.centre - a.centre;
  const Vec3 in_a = (a.axes.transpose() * way).cwiseAbs();
  const Vec3 in_b = (b.axes.transpose() * way).cwiseAbs();
  const double distance = way.norm(), clear = a.radius + b.radius + static_cast<double>(kReach);
  if (distance * (distance - clear) > in_a.dot(a.half) + in_b.dot(b.half)) return true;
  const Mat3 turn = (a.axes.transpose() * b.axes).cwiseAbs();
  return (in_a - a.half - turn * b.half).maxCoeff() > clear ||
         (in_b - b.half - turn.transpose() * a.half).maxCoeff() > clear;
}

// Bullet takes long to find out that shapes do not touch.
void look_at_pair(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                  const btDispatcherInfo& info) {
  const auto solid = [](const btBroadphaseProxy* proxy) {
    const auto* object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
    return static_cast<const Solid*>(object->getUserPointer());
  };
  if (!are_apart(*solid(pair.m_pProxy0), *solid(pair.m_pProxy1))) {
    btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
  } else if (pair.m_algorithm != nullptr) {
    pair.m_algorithm->~btCollisionAlgorithm();
    dispatcher.freeCollisionAlgorithm(pair.m_algorithm);
    pair.m_algorithm = nullptr;
  }
}

}  // namespace

// In the order in which they are made; destroyed in the reverse one.
struct Collision::Inside {
  // Points of a shape that touch a plane first, in its own frame, and how thick it is about them.
  struct Feelers {
    std::vector<Vec3> points;
    double radius = 0;
  };
  static Feelers feelers_of(const Shape& shape);

  bool level = false;
  double height = 0;
  btDefaultCollisionConfiguration configuration{small_pools()};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};
  btTriangleMesh mesh;
  GroundEdges edges{{}};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btCollisionObject>> bodies;
  std::vector<std::unique_ptr<btCollisionObject>> grounds;
  std::vector<Solid> solids;                              // shape [bodies]
  std::vector<Feelers> feelers;                           // shape [bodies]
  std::vector<std::vector<std::array<float, 3>>> memory;  // shape [bodies, kTouches * feelers]
  // Of what touched edges in the last step, and does so now.
  struct EdgeMemory {
    int body = 0, edge = 0;
    Vec3 on_a;
    std::array<float, 3> impulses = {};
  };
  std::vector<EdgeMemory> on_edges, on_edges_before;
  std::vector<Contact> contacts;

  ~Inside();
  void place(std::span<const BodyState> states);
  void add_mesh(const Surroundings& surroundings);
  void part_overlapping();
  void touch_plane(std::span<const BodyState> states, double step);
  void touch_faces(std::span<const BodyState> states, double step);
  void touch_edges(std::size_t body, const Transform& pose, std::span<const int> near,
                   double reach);
  void connect_edges();
  bool is_on_face(const Contact& of) const;
  void take_manifolds(std::span<const BodyState> states);
};

Collision::Inside::Feelers Collision::Inside::feelers_of(const Shape& shape) {
  Feelers feelers;
  if (shape.kind == Shape::Kind::box) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                      (corner & 4) != 0 ? 1 : -1);
      feelers.points.emplace_back(sign.cwiseProduct(shape.half));
    }
    return feelers;
  }
  feelers.radius = shape.radius;
  feelers.points.emplace_back(0, shape.half_length, 0);
  if (shape.half_length > 0) feelers.points.emplace_back(0, -shape.half_length, 0);
  return feelers;
}

Collision::Inside::~Inside() {
  for (const auto& body : bodies) world.removeCollisionObject(body.get());
}

void Collision::Inside::place(std::span<const BodyState> states) {
  for (std::size_t b = 0; b < states.size(); ++b) {
    solids[b].centre = states[b].to_world.position;
    solids[b].axes = states[b].to_world.orientation.toRotationMatrix();
    bodies[b]->setWorldTransform(placed(states[b].to_world));
    bodies[b]->setUserPointer(&solids[b]);
  }
}

void Collision::Inside::add_mesh(const Surroundings& surroundings) {
  for (const auto& t : surroundings.triangles) {
    mesh.addTriangle(to_bullet(t[0]), to_bullet(t[1]), to_bullet(t[2]));
  }
  edges = GroundEdges(surroundings.triangles);
  auto shape = std::make_unique<btBvhTriangleMeshShape>(&mesh, true);
  shape->setMargin(0);
  auto ground = std::make_unique<btCollisionObject>();
  ground->setCollisionShape(shape.get());
  ground->setCollisionFlags(btCollisionObject::CF_STATIC_OBJECT);
  shapes.push_back(std::move(shape));
  grounds.push_back(std::move(ground));
}

// A forearm that starts in the belly's box would be shot out of it.
void Collision::Inside::part_overlapping() {
  world.performDiscreteCollisionDetection();
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    auto* a = const_cast<btCollisionObject*>(manifold.getBody0());
    auto* b = const_cast<btCollisionObject*>(manifold.getBody1());
    if (a->isStaticObject() || b->isStaticObject()) continue;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      if (manifold.getContactPoint(p).getDistance() > 0) continue;
      a->setIgnoreCollisionCheck(b, true);
      b->setIgnoreCollisionCheck(a, true);
      break;
    }
  }
  // Bullet does not look at such a pair again, but keeps what it found of it.
  for (const auto& body : bodies) {
    world.getPairCache()->cleanProxyFromPairs(body->getBroadphaseHandle(), &dispatcher);
  }
}

void Collision::Inside::touch_plane(std::span<const BodyState> states, double step) {
  for (std::size_t b = 0; b < feelers.size(); ++b) {
    const Transform& pose = states[b].to_world;
    const double fall = step * (std::abs(states[b].velocity.y()) + states[b].spin.norm());
    for (std::size_t k = 0; k < feelers[b].points.size(); ++k) {
      const Vec3 point = pose * feelers[b].points[k];
      const double gap = point.y() - feelers[b].radius - height;
      std::array<float, 3>& impulses = memory[b][kTouches * k];
      if (gap > 0.01 + 2 * fall) {
        impulses.fill(0);
        continue;
      }
      Contact contact;
      contact.a = static_cast<int>(b);
      const Vec3 lowest = point - feelers[b].radius * Vec3::UnitY();
      contact.on_a = pose.inverse() * lowest;
      contact.on_b = Vec3(lowest.x(), height, lowest.z());
      contact.impulses = {&impulses[0], &impulses[1], &impulses[2]};
      contacts.push_back(contact);
    }
  }
}

// Bullet keeps points on a mesh from step to step, and one set for all its triangles, while a body
// rolls over them; on faces, points are therefore found anew in each step, in double precision.
void Collision::Inside::touch_faces(std::span<const BodyState> states, double step) {
  const auto* shape = static_cast<const btBvhTriangleMeshShape*>(grounds[0]->getCollisionShape());
  Faces faces(edges);
  std::vector<Touch> touches;
  std::vector<int> near;
  std::swap(on_edges, on_edges_before);
  on_edges.clear();
  for (std::size_t b = 0; b < feelers.size(); ++b) {
    const Transform& pose = states[b].to_world;
    const double fall = step * (states[b].velocity.norm() + states[b].spin.norm());
    const auto around = static_cast<btScalar>(kThick + 2 * fall);
    btVector3 low, high;
    bodies[b]->getCollisionShape()->getAabb(bodies[b]->getWorldTransform(), low, high);
    const btVector3 margin(around, around, around);
    faces.clear();
    shape->processAllTriangles(&faces, low - margin, high + margin);
    const double radius = feelers[b].radius;
    for (std::size_t k = 0; k < feelers[b].points.size(); ++k) {
      const Vec3 point = pose * feelers[b].points[k];
      find_touches(point, radius, radius > 0 ? point : pose.position, 0.01 + 2 * fall,
                   faces.faces(), touches);
      for (std::size_t i = 0; i < kTouches; ++i) {
        std::array<float, 3>& impulses = memory[b][kTouches * k + i];
        if (i >= touches.size()) {
          impulses.fill(0);
          continue;
        }
        Contact contact;
        contact.a = static_cast<int>(b);
        contact.normal = touches[i].normal;
        contact.on_a = pose.inverse() * touches[i].on_body;
        contact.on_b = touches[i].on_body - touches[i].gap * touches[i].normal;
        contact.impulses = {&impulses[0], &impulses[1], &impulses[2]};
        contacts.push_back(contact);
      }
    }
    near.clear();
    for (const int triangle : faces.numbers()) {
      std::ranges::copy(edges.of_triangle(triangle), std::back_inserter(near));
    }
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    touch_edges(b, pose, near, 0.01 + 2 * fall);
  }
  connect_edges();
}

void Collision::Inside::touch_edges(std::size_t body, const Transform& pose,
                                    std::span<const int> near, double reach) {
  std::vector<EdgeTouch> touches;
  for (const int edge : near) {
    touches.clear();
    touch_edge(solids[body].shape, pose, edges[edge], reach, touches);
    for (const EdgeTouch& touch : touches) {
      Contact contact;
      contact.a = static_cast<int>(body);
      contact.normal = touch.normal;
      contact.on_a = pose.inverse() * touch.on_body;
      contact.on_b = touch.on_body - touch.gap * touch.normal;
      if (is_on_face(contact)) continue;
      EdgeMemory now{contact.a, edge, contact.on_a, {}};
      for (const EdgeMemory& before : on_edges_before) {
        if (before.body == now.body && before.edge == edge &&
            (before.on_a - now.on_a).norm() < kSamePlace) {
          now.impulses = before.impulses;
          break;
        }
      }
      on_edges.push_back(now);
      contacts.push_back(contact);
    }
  }
}

// After all have been added, because growing moves them in memory.
void Collision::Inside::connect_edges() {
  std::size_t next = 0;
  for (Contact& contact : contacts) {
    if (contact.impulses[0] != nullptr) continue;
    auto& impulses = on_edges[next++].impulses;
    contact.impulses = {&impulses[0], &impulses[1], &impulses[2]};
  }
}

bool Collision::Inside::is_on_face(const Contact& of) const {
  return std::ranges::any_of(contacts, [&](const Contact& contact) {
    return contact.b < 0 && contact.a == of.a && contact.normal.dot(of.normal) > kSameWay &&
           (contact.on_a - of.on_a).norm() < kSamePlace;
  });
}

void Collision::Inside::take_manifolds(std::span<const BodyState> states) {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const int a = manifold.getBody0()->getUserIndex(), b = manifold.getBody1()->getUserIndex();
    const double sign = a >= 0 ? 1 : -1;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      btManifoldPoint& point = manifold.getContactPoint(p);
      Contact contact;
      contact.a = a >= 0 ? a : b;
      contact.b = a >= 0 ? b : a;
      contact.normal = sign * from_bullet(point.m_normalWorldOnB).normalized();
      const Vec3 on_a = from_bullet(a >= 0 ? point.m_positionWorldOnA : point.m_positionWorldOnB);
      // The other's point from the distance, which is exact where the points are rounded.
      const Vec3 on_b = on_a - static_cast<double>(point.getDistance()) * contact.normal;
      contact.on_a = states[at(contact.a)].to_world.inverse() * on_a;
      contact.on_b = states[at(contact.b)].to_world.inverse() * on_b;
      contact.impulses = {&point.m_appliedImpulse, &point.m_appliedImpulseLateral1,
                          &point.m_appliedImpulseLateral2};
      contacts.push_back(contact);
    }
  }
}

Collision::Collision(const Surroundings& surroundings) : inside_(std::make_unique<Inside>()) {
  // Bullet has one reach for all worlds; this is the same for all.
  static const bool set = (gContactBreakingThreshold = kReach, true);
  (void)set;
  Inside& in = *inside_;
  in.dispatcher.setDispatcherFlags(
      in.dispatcher.getDispatcherFlags() &
      ~btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
  in.dispatcher.setNearCallback(look_at_pair);
  in.world.setForceUpdateAllAabbs(false);
  in.world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  in.level = surroundings.level;
  in.height = surroundings.height;
  if (!surroundings.triangles.empty()) in.add_mesh(surroundings);
}

Collision::~Collision() = default;

void Collision::add(std::span<const Body> bodies, std::span<const BodyState> states,
                    std::span<const Joint> joints) {
  Inside& in = *inside_;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    in.shapes.push_back(make_shape(bodies[b].shape));
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(in.shapes.back().get());
    object->setCollisionFlags(0);
    object->setWorldTransform(placed(states[b].to_world));
    object->setUserIndex(static_cast<int>(b));
    object->setActivationState(DISABLE_DEACTIVATION);
    in.world.addCollisionObject(object.get());
    in.bodies.push_back(std::move(object));
    in.solids.push_back({bodies[b].shape});
    in.feelers.push_back(Inside::feelers_of(bodies[b].shape));
    in.memory.emplace_back(kTouches * in.feelers.back().points.size());
  }
  in.place(states);
  for (const Joint& joint : joints) {
    if (joint.parent < 0) continue;
    btCollisionObject *a = in.bodies[at(joint.parent)].get(), *b = in.bodies[at(joint.child)].get();
    a->setIgnoreCollisionCheck(b, true);
    b->setIgnoreCollisionCheck(a, true);
  }
  in.part_overlapping();
}

std::span<const Contact> Collision::find(std::span<const BodyState> states, double step) {
  Inside& in = *inside_;
  in.contacts.clear();
  if (in.level) in.touch_plane(states, step);
  if (in.bodies.size() > 1 || !in.grounds.empty()) {
    in.place(states);
    if (!in.grounds.empty()) in.touch_faces(states, step);
    in.world.performDiscreteCollisionDetection();
    in.take_manifolds(states);
  }
  return in.contacts;
}

}  // namespace krok::ragdoll

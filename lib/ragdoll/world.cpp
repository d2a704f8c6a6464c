#include "ragdoll/world.h"

#include <BulletCollision/CollisionDispatch/btInternalEdgeUtility.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ragdoll/bullet_joint_internal.h"
#include "ragdoll/bullet_solver_internal.h"

namespace krok::ragdoll {

namespace {

btTransform placed(const Transform& t) {
  const Quat& q = t.orientation;
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     to_bullet(t.position));
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

// The edges between a mesh's triangles stop nothing.
bool smooth_edges(btManifoldPoint& point, const btCollisionObjectWrapper* body, int, int,
                  const btCollisionObjectWrapper* mesh, int part, int index) {
  btAdjustInternalEdgeContacts(point, mesh, body, part, index);
  return false;
}

}  // namespace

// In the order in which they are made; destroyed in the reverse one.
struct World::Inside {
  WorldOptions options;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  Solver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btTriangleMesh mesh;
  btTriangleInfoMap edges;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btRigidBody>> grounds;
  btRigidBody fixed{0, nullptr, nullptr};
  std::vector<std::unique_ptr<BulletJoint>> joints;

  ~Inside();
  void add_ground(std::unique_ptr<btCollisionShape> shape);
  void add_body(const Body& body, const BodyState& state);
  void part_overlapping();
  double substep() const { return kStep / options.substeps; }
};

World::Inside::~Inside() {
  for (const auto& joint : joints) world.removeConstraint(joint.get());
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  for (const auto& ground : grounds) world.removeRigidBody(ground.get());
}

void World::Inside::add_ground(std::unique_ptr<btCollisionShape> shape) {
  shape->setMargin(0);
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape.get());
  info.m_friction = 1;  // Bullet multiplies the coefficients of both
  info.m_restitution = 1;
  grounds.push_back(std::make_unique<btRigidBody>(info));
  shapes.push_back(std::move(shape));
}

void World::Inside::add_body(const Body& body, const BodyState& state) {
  auto shape = make_shape(body.shape);
  btVector3 inertia(0, 0, 0);
  const auto mass = static_cast<btScalar>(body.mass);
  shape->calculateLocalInertia(mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
  info.m_startWorldTransform = placed(state.to_world);
  info.m_friction = static_cast<btScalar>(options.friction);
  info.m_restitution = static_cast<btScalar>(options.restitution);
  auto made = std::make_unique<btRigidBody>(info);
  made->setLinearVelocity(to_bullet(state.velocity));
  made->setAngularVelocity(to_bullet(state.spin));
  // Rest is judged by the caller, by the whole character.
  made->setActivationState(DISABLE_DEACTIVATION);
  shapes.push_back(std::move(shape));
  bodies.push_back(std::move(made));
  world.addRigidBody(bodies.back().get());
}

// A forearm that starts in the belly's box would be shot out of it.
void World::Inside::part_overlapping() {
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
}

World::World(const WorldOptions& options, const Surroundings& surroundings)
    : inside_(std::make_unique<Inside>()) {
  // Bullet has one callback for all worlds; this is the same for all.
  static const bool set = (gContactAddedCallback = smooth_edges, true);
  (void)set;
  Inside& in = *inside_;
  in.options = options;
  in.world.setGravity(to_bullet(options.gravity));
  in.world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  btContactSolverInfo& solving = in.world.getSolverInfo();
  solving.m_numIterations = options.iterations;
  solving.m_splitImpulse = 1;
  // Penetration of any depth is taken back apart from the speeds, so that it adds no energy.
  solving.m_splitImpulsePenetrationThreshold = 0;
  // Bodies that start in the ground come out within some hundredths of a second, not with a jerk.
  solving.m_erp2 = 0.05F;
  solving.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  if (surroundings.level) {
    in.add_ground(std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0),
                                                       static_cast<btScalar>(surroundings.height)));
  }
  if (!surroundings.triangles.empty()) {
    for (const auto& t : surroundings.triangles) {
      in.mesh.addTriangle(to_bullet(t[0]), to_bullet(t[1]), to_bullet(t[2]));
    }
    auto shape = std::make_unique<btBvhTriangleMeshShape>(&in.mesh, true);
    btGenerateInternalEdgeInfo(shape.get(), &in.edges);
    in.add_ground(std::move(shape));
    in.grounds.back()->setCollisionFlags(in.grounds.back()->getCollisionFlags() |
                                         btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
  }
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

Status World::add(std::span<const Body> bodies, std::span<const BodyState> states,
                  std::span<const Joint> joints) {
  Inside& in = *inside_;
  const int count = static_cast<int>(bodies.size());
  if (bodies.size() != states.size()) return Error("ragdoll-value", "each body needs a state");
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& state = states[b];
    const bool finite = state.to_world.position.allFinite() && state.velocity.allFinite() &&
                        state.spin.allFinite() && state.to_world.orientation.coeffs().allFinite();
    if (!finite || !(bodies[b].mass > 0) || !(volume(bodies[b].shape) > 0)) {
      return Error("ragdoll-value",
                   "the body '" + bodies[b].name + "' has no mass, no size or no finite state");
    }
  }
  for (const Joint& joint : joints) {
    if (joint.child < 0 || joint.child >= count || joint.parent >= count ||
        joint.parent == joint.child || joint.range.min > joint.range.max ||
        !(joint.stiffness >= 0) || !(joint.damping >= 0) || !(joint.friction >= 0)) {
      return Error("ragdoll-value", "a joint ties bodies that do not exist, or has wrong limits");
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) in.add_body(bodies[b], states[b]);
  // After the bodies: that puts the ground last in each pair, as smooth_edges() needs it.
  for (const auto& ground : in.grounds) in.world.addRigidBody(ground.get());
  for (const Joint& joint : joints) {
    btRigidBody& parent = joint.parent < 0 ? in.fixed : *in.bodies[at(joint.parent)];
    in.joints.push_back(
        std::make_unique<BulletJoint>(joint, parent, *in.bodies[at(joint.child)], in.substep()));
    in.world.addConstraint(in.joints.back().get(), true);
  }
  in.part_overlapping();
  return {};
}

void World::step() {
  Inside& in = *inside_;
  const auto part = static_cast<btScalar>(in.substep());
  for (int i = 0; i < in.options.substeps; ++i) {
    for (const auto& joint : in.joints) joint->push_back();
    in.world.stepSimulation(part, 0, part);
  }
}

void World::push(int body, const Vec3& impulse) {
  inside_->bodies[at(body)]->applyCentralImpulse(to_bullet(impulse));
}

void World::set_motor(int joint, double torque, const Quat& target, const Vec3& target_speed) {
  Joint& its = inside_->joints[at(joint)]->joint;
  its.motor = torque;
  its.target = target;
  its.target_speed = target_speed;
}

BodyState World::state(int body) const {
  const btRigidBody& its = *inside_->bodies[at(body)];
  const btQuaternion q = its.getWorldTransform().getRotation();
  BodyState state;
  state.to_world = {from_bullet(its.getCenterOfMassPosition()),
                    Quat(q.w(), q.x(), q.y(), q.z()).normalized()};
  state.velocity = from_bullet(its.getLinearVelocity());
  state.spin = from_bullet(its.getAngularVelocity());
  return state;
}

WorldMeasures World::measures() const {
  WorldMeasures measures;
  for (const auto& joint : inside_->joints) {
    measures.joint_gap = std::max(measures.joint_gap, joint->gap());
    measures.limit_excess = std::max(measures.limit_excess, joint->excess());
  }
  for (int m = 0; m < inside_->dispatcher.getNumManifolds(); ++m) {
    const auto& manifold = *inside_->dispatcher.getManifoldByIndexInternal(m);
    if (!manifold.getBody0()->isStaticObject() && !manifold.getBody1()->isStaticObject()) continue;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      const double distance = manifold.getContactPoint(p).getDistance();
      measures.penetration = std::max(measures.penetration, -distance);
      if (distance < 0.005) ++measures.contacts;
    }
  }
  return measures;
}

}  // namespace krok::ragdoll

#include "ragdoll/multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodySphericalJointLimit.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <vector>

using namespace krok;
using namespace krok::ragdoll;

namespace {

btVector3 to_bt(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
btQuaternion to_bt(const Quat& q) {
  return {static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()), static_cast<btScalar>(q.z()),
          static_cast<btScalar>(q.w())};
}

std::unique_ptr<btCollisionShape> shape_of(const Shape& shape) {
  if (shape.kind == Shape::Kind::box) {
    auto box = std::make_unique<btBoxShape>(to_bt(shape.half));
    box->setMargin(static_cast<btScalar>(0.1 * shape.half.minCoeff()));
    return box;
  }
  return std::make_unique<btCapsuleShape>(static_cast<btScalar>(shape.radius),
                                          static_cast<btScalar>(2 * shape.half_length));
}

}  // namespace

struct Multibody::Inside {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  btStaticPlaneShape plane{btVector3(0, 1, 0), 0};
  std::unique_ptr<btRigidBody> ground;
  std::unique_ptr<btMultiBody> body;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> limits;

  ~Inside() {
    for (auto& limit : limits) world.removeMultiBodyConstraint(limit.get());
    world.removeMultiBody(body.get());
    for (auto& collider : colliders) world.removeCollisionObject(collider.get());
    world.removeRigidBody(ground.get());
  }
};

Multibody::Multibody(std::span<const Body> bodies, std::span<const BodyState> states,
                     std::span<const Joint> joints, int iterations)
    : inside_(std::make_unique<Inside>()) {
  Inside& in = *inside_;
  in.world.setGravity(btVector3(0, static_cast<btScalar>(-9.81), 0));
  in.world.getSolverInfo().m_numIterations = iterations;
  in.ground = std::make_unique<btRigidBody>(0, nullptr, &in.plane);
  in.ground->setFriction(1);
  in.world.addRigidBody(in.ground.get());
  std::vector<btVector3> inertias;
  for (const Body& body : bodies) {
    in.shapes.push_back(shape_of(body.shape));
    btVector3 inertia;
    in.shapes.back()->calculateLocalInertia(static_cast<btScalar>(body.mass), inertia);
    inertias.push_back(inertia);
  }
  const int links = static_cast<int>(bodies.size()) - 1;
  in.body = std::make_unique<btMultiBody>(links, static_cast<btScalar>(bodies[0].mass), inertias[0],
                                          false, false);
  btMultiBody& tree = *in.body;
  for (const Joint& joint : joints) {
    const auto c = static_cast<std::size_t>(joint.child),
               p = static_cast<std::size_t>(joint.parent);
    const Quat turn = states[c].to_world.orientation.conjugate() * states[p].to_world.orientation;
    const int link = joint.child - 1;
    const auto mass = static_cast<btScalar>(bodies[c].mass);
    const btVector3 to_pivot = to_bt(joint.in_parent.position);
    const btVector3 from_pivot = to_bt(Vec3(-joint.in_child.position));
    if (joint.kind == JointKind::revolute) {
      tree.setupRevolute(link, mass, inertias[c], joint.parent - 1, to_bt(turn),
                         to_bt(Vec3(joint.in_child.orientation * Vec3(Vec3::UnitX()))), to_pivot,
                         from_pivot, true);
    } else {
      tree.setupSpherical(link, mass, inertias[c], joint.parent - 1, to_bt(turn), to_pivot,
                          from_pivot, true);
    }
  }
  tree.finalizeMultiDof();
  tree.setBaseWorldTransform(
      btTransform(to_bt(states[0].to_world.orientation), to_bt(states[0].to_world.position)));
  tree.setBaseVel(to_bt(states[0].velocity));
  tree.setBaseOmega(to_bt(states[0].spin));
  tree.setLinearDamping(0);
  tree.setAngularDamping(0);
  for (const Joint& joint : joints) {
    const auto c = static_cast<std::size_t>(joint.child),
               p = static_cast<std::size_t>(joint.parent);
    // In the child's frame.
    const Vec3 spin =
        states[c].to_world.orientation.conjugate() * (states[c].spin - states[p].spin);
    btScalar speed[3] = {static_cast<btScalar>(spin.x()), static_cast<btScalar>(spin.y()),
                         static_cast<btScalar>(spin.z())};
    if (joint.kind == JointKind::revolute) {
      speed[0] = static_cast<btScalar>(spin.dot(joint.in_child.orientation * Vec3(Vec3::UnitX())));
    }
    tree.setJointVelMultiDof(joint.child - 1, speed);
    tree.getLink(joint.child - 1).m_jointDamping = static_cast<btScalar>(joint.friction);
  }
  in.world.addMultiBody(&tree);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    auto collider = std::make_unique<btMultiBodyLinkCollider>(&tree, static_cast<int>(b) - 1);
    collider->setCollisionShape(in.shapes[b].get());
    collider->setWorldTransform(
        btTransform(to_bt(states[b].to_world.orientation), to_bt(states[b].to_world.position)));
    collider->setFriction(static_cast<btScalar>(0.7));
    in.world.addCollisionObject(collider.get(), 1, -1);
    if (b == 0) {
      tree.setBaseCollider(collider.get());
    } else {
      tree.getLink(static_cast<int>(b) - 1).m_collider = collider.get();
    }
    in.colliders.push_back(std::move(collider));
  }
  for (const Joint& joint : joints) {
    if (joint.kind == JointKind::revolute) {
      in.limits.push_back(std::make_unique<btMultiBodyJointLimitConstraint>(
          &tree, joint.child - 1, static_cast<btScalar>(joint.range.min),
          static_cast<btScalar>(joint.range.max)));
    } else if (joint.turn.kind == ik::JointLimit::Kind::cone) {
      // Symmetrical about the pose at the start: all that there is.
      in.limits.push_back(std::make_unique<btMultiBodySphericalJointLimit>(
          &tree, joint.child - 1, static_cast<btScalar>(joint.turn.max_swing[0]),
          static_cast<btScalar>(joint.turn.max_swing[1]),
          static_cast<btScalar>(joint.turn.max_twist), static_cast<btScalar>(1000)));
    } else {
      continue;
    }
    in.limits.back()->finalizeMultiDof();
    in.world.addMultiBodyConstraint(in.limits.back().get());
  }
}

Multibody::~Multibody() = default;

void Multibody::step() {
  const auto part = static_cast<btScalar>(World::kStep);
  inside_->world.stepSimulation(part, 0, part);
}

double Multibody::penetration() const {
  double deepest = 0;
  for (int m = 0; m < inside_->dispatcher.getNumManifolds(); ++m) {
    const auto& manifold = *inside_->dispatcher.getManifoldByIndexInternal(m);
    if (manifold.getBody0() != inside_->ground.get() &&
        manifold.getBody1() != inside_->ground.get())
      continue;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      deepest = std::max(deepest, -static_cast<double>(manifold.getContactPoint(p).getDistance()));
    }
  }
  return deepest;
}

Vec3 Multibody::position(int body) const {
  const btVector3 at =
      inside_->colliders[static_cast<std::size_t>(body)]->getWorldTransform().getOrigin();
  return {at.x(), at.y(), at.z()};
}

double Multibody::fastest() const {
  const btMultiBody& tree = *inside_->body;
  double fastest = tree.getBaseVel().length();
  for (int i = 0; i < tree.getNumDofs(); ++i) {
    fastest = std::max(fastest, std::abs(static_cast<double>(tree.getVelocityVector()[6 + i])));
  }
  return fastest;
}

#include "ragdoll/world.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"
#include "ragdoll/articulation_internal.h"
#include "ragdoll/impulse_solver_internal.h"

namespace krok::ragdoll {

namespace {
// How often a step is corrected, and then divided.
constexpr int kAgain = 1, kDivided = 6;
// Rotation in one part of a step from which a spinning body would gain energy.
constexpr double kPartTurn = 0.2;  // radians
constexpr double kMaxParts = 32;   // of a step
}  // namespace

struct World::Inside {
  Inside(const WorldOptions& its, const Surroundings& surroundings)
      : options(its), collision(surroundings) {}

  WorldOptions options;
  Collision collision;
  Articulation bodies;
  ImpulseSolver solver;
  std::vector<BodyState> states;
  std::vector<Contact> contacts;
  std::vector<bool> follow;  // shape [bodies]: the motion has them where they are

  void look();
  void advance(double step, int divided);
};

void World::Inside::look() {
  states.clear();
  for (int b = 0; b < bodies.body_count(); ++b) states.push_back(bodies.state(b));
  contacts.clear();
  for (const Contact& contact : collision.find(states, kStep)) {
    if (contact.b < 0 || !follow[at(contact.a)] || !follow[at(contact.b)]) {
      contacts.push_back(contact);
    }
  }
}

// Divides steps in which something turns so fast that its limits are missed.
void World::Inside::advance(double step, int divided) {
  bodies.accelerate(step, options.gravity);
  solver.begin(bodies, step);
  solver.add_contacts(contacts, options.friction, options.restitution);
  solver.add_limits();
  solver.solve(options.iterations);
  bodies.move(step, solver.moving(), solver.left());
  for (int again = 0; solver.has_rows() && solver.missed(); ++again) {
    const bool divide = again == kAgain && divided < kDivided;
    if (again == kAgain && !divide) break;
    bodies.move_back();
    if (divide) {
      advance(0.5 * step, divided + 1);
      advance(0.5 * step, divided + 1);
      return;
    }
    solver.solve_again(options.iterations);
    bodies.move(step, solver.moving(), solver.left());
  }
}

World::World(const WorldOptions& options, const Surroundings& surroundings)
    : inside_(std::make_unique<Inside>(options, surroundings)) {}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

Status World::add(std::span<const Body> bodies, std::span<const BodyState> states,
                  std::span<const Joint> joints) {
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
        !(joint.stiffness >= 0) || !(joint.damping >= 0) || !(joint.friction >= 0) ||
        !(joint.dry_friction >= 0)) {
      return Error("ragdoll-value", "a joint ties bodies that do not exist, or has wrong limits");
    }
  }
  if (Status status = inside_->bodies.build(bodies, states, joints); !status) return status;
  for (const Body& body : bodies) inside_->follow.push_back(body.mode != BodyMode::simulated);
  for (int b = 0; b < count; ++b) {
    if (bodies[at(b)].mode != BodyMode::animated) continue;
    for (const Joint& joint : joints) {
      if (joint.child == b && joint.kind != JointKind::distance &&
          (joint.parent < 0 || bodies[at(joint.parent)].mode != BodyMode::animated)) {
        return Error("ragdoll-mode", "the animated body '" + bodies[at(b)].name +
                                         "' hangs from what is not animated");
      }
    }
    inside_->bodies.set_kinematic(b, true);
  }
  inside_->collision.add(bodies, states, joints);
  inside_->look();
  return {};
}

void World::step() {
  Inside& in = *inside_;
  const double turn = kStep * in.bodies.max_spin();
  const int parts = std::max(in.options.substeps,
                             static_cast<int>(std::ceil(std::min(turn / kPartTurn, kMaxParts))));
  for (int i = 0; i < parts; ++i) in.advance(kStep / parts, 0);
  // Afterwards, so that measures() sees the poses as they are; the next step begins with these.
  in.look();
}

void World::push(int body, const Vec3& impulse) {
  inside_->bodies.push(body, impulse);
}

void World::set_motor(int joint, const Quat& target, const Vec3& target_speed) {
  Joint& its = inside_->bodies.joint(joint);
  its.target = target;
  its.target_speed = target_speed;
}

void World::lead(int body, const Transform& to_world) {
  BodyState& state = inside_->bodies.state(body);
  state.velocity = (to_world.position - state.to_world.position) / kStep;
  state.spin =
      rotation_vector(to_world.orientation * state.to_world.orientation.conjugate()) / kStep;
}

void World::move_anchor(int joint, const Vec3& in_parent) {
  inside_->bodies.move_anchor(joint, (in_parent - inside_->bodies.anchor(joint)) / kStep);
}

void World::hold(int body, const Hold& hold) {
  inside_->bodies.hold(body, hold);
}

BodyState World::state(int body) const {
  return inside_->bodies.state(body);
}

WorldMeasures World::measures() const {
  const Articulation& bodies = inside_->bodies;
  WorldMeasures measures;
  for (int j = 0; j < bodies.joint_count(); ++j) {
    if (bodies.is_fixed(bodies.joint(j).child, bodies.joint(j).parent)) continue;
    measures.joint_gap = std::max(measures.joint_gap, bodies.gap(j));
    measures.limit_excess = std::max(measures.limit_excess, bodies.excess(j));
  }
  for (const Contact& contact : inside_->contacts) {
    if (contact.b >= 0 || bodies.is_kinematic(contact.a)) continue;
    const Vec3 point = bodies.state(contact.a).to_world * contact.on_a;
    const double distance = contact.normal.dot(point - contact.on_b);
    measures.penetration = std::max(measures.penetration, -distance);
    if (distance < 0.005) ++measures.contacts;
  }
  return measures;
}

}  // namespace krok::ragdoll

#pragma once

#include <btBulletDynamicsCommon.h>

namespace krok::ragdoll {

// Bullet's solver lets a point keep the friction of an earlier pass when it stops carrying in a
// later one, so that boxes slide up to a tenth too slowly. Here it loses it.
class Solver final : public btSequentialImpulseConstraintSolver {
 protected:
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** constraints, int constraint_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    const btScalar residual = btSequentialImpulseConstraintSolver::solveSingleIteration(
        iteration, bodies, body_count, manifolds, manifold_count, constraints, constraint_count,
        info, drawer);
    for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); ++i) {
      btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[i];
      if (m_tmpSolverContactConstraintPool[row.m_frictionIndex].m_appliedImpulse > 0) continue;
      row.m_lowerLimit = row.m_upperLimit = 0;
      resolveSingleConstraintRowGeneric(m_tmpSolverBodyPool[row.m_solverBodyIdA],
                                        m_tmpSolverBodyPool[row.m_solverBodyIdB], row);
    }
    return residual;
  }
};

}  // namespace krok::ragdoll

#include <algorithm>
#include <cmath>
#include <utility>

#include "ragdoll/impulse_solver_internal.h"

namespace krok::ragdoll {

namespace {
// Sweeps end where no row's speed changes by more, m/s or rad/s.
constexpr float kEnough = 5e-5F;
// Numbers that are added at a time, in four registers.
constexpr std::size_t kLanes = 16;
using Lanes = Eigen::Array<float, static_cast<int>(kLanes), 1>;
}  // namespace

// Adds the rows, of stride_ numbers, times their factors.
void ImpulseSolver::add_terms(std::span<const Term> terms, const std::vector<float>& rows,
                              float* to) const {
  for (std::size_t i = 0; i < stride_; i += kLanes) {
    Lanes sum = Eigen::Map<const Lanes>(to + i);
    for (const Term& term : terms) {
      sum += term.factor * Eigen::Map<const Lanes>(rows.data() + term.row * stride_ + i);
    }
    Eigen::Map<Lanes>(to + i) = sum;
  }
}

// What each row's impulse gives to the freedoms of the trees.
void ImpulseSolver::connect() {
  stride_ = (rows_.size() + kLanes - 1) / kLanes * kLanes;
  freedom_impulses_.assign(at(bodies_->freedom_count()) * stride_, 0);
  answers_.resize(rows_.size() * stride_);
  terms_.resize(rows_.size() * at(bodies_->freedom_count()));
  std::size_t count = 0;
  swept_.clear();
  for (const Group& group : groups_) {
    for (std::size_t r = group.first; r < group.end; ++r) {
      Swept row;
      row.first = count;
      double own = 1e-12;
      bodies_->each_answer(group.a, group.b, rows_[r].wrench,
                           [&](int number, const auto& impulse, const auto& speed) {
                             own += impulse.dot(speed);
                             for (Eigen::Index k = 0; k < impulse.size(); ++k) {
                               const std::size_t freedom = at(number) + static_cast<std::size_t>(k);
                               freedom_impulses_[freedom * stride_ + r] =
                                   static_cast<float>(impulse[k]);
                               if (speed[k] == 0) continue;
                               terms_[count++] = {freedom, static_cast<float>(speed[k])};
                             }
                           });
      row.end = count;
      row.own = static_cast<float>(own);
      row.inverse = static_cast<float>(1 / own);
      swept_.push_back(row);
    }
  }
}

// Found when first asked for: the impulses of most limits stay 0.
float* ImpulseSolver::answer(std::size_t r) {
  Swept& row = swept_[r];
  float* answers = &answers_[r * stride_];
  if (std::exchange(row.answered, true)) return answers;
  std::fill_n(answers, stride_, 0.0F);
  add_terms(std::span(terms_).subspan(row.first, row.end - row.first), freedom_impulses_, answers);
  return answers;
}

void ImpulseSolver::change(std::size_t r, float by) {
  if (by == 0) return;
  answer(r);
  changes_.push_back({r, by});
}

float ImpulseSolver::speed(std::size_t r) const {
  float speed = speeds_[r];
  for (const Term& term : changes_) speed += term.factor * answers_[term.row * stride_ + r];
  return speed;
}

void ImpulseSolver::warm_start(bool again) {
  speeds_.assign(stride_, 0);
  impulses_.assign(stride_, 0);
  for (const Group& group : groups_) {
    for (std::size_t r = group.first; r < group.end; ++r) {
      speeds_[r] = static_cast<float>(speed_along(group, rows_[r].wrench));
    }
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    impulses_[r] = again ? row.pushed : row.cache == nullptr ? 0 : *row.cache;
    change(r, impulses_[r]);
  }
  add_terms(changes_, answers_, speeds_.data());
  changes_.clear();
}

void ImpulseSolver::sweep_row(std::size_t r, float& largest) {
  const Swept& row = swept_[r];
  const float before = impulses_[r];
  float now = before + (row.target - speed(r)) * row.inverse;
  if (!rows_[r].both) now = std::max(now, 0.0F);
  const float by = now - before;
  if (by == 0) return;
  impulses_[r] = now;
  largest = std::max(largest, std::abs(by) * row.own);
  change(r, by);
}

// Coulomb's cone: both rows across together, at most the friction times the pressure.
void ImpulseSolver::sweep_friction(const Patch& patch, float& largest) {
  float most = 0, most_spin = 0;
  for (std::size_t r = patch.first; r < patch.end; ++r) {
    most += patch.friction * impulses_[r];
    most_spin += patch.friction * impulses_[r] * patch.arms[r - patch.first];
  }
  const std::size_t i = patch.end, j = i + 1, k = i + 2;
  float &u = impulses_[i], &v = impulses_[j];
  const float old_u = u, old_v = v;
  if (most > 0 || old_u != 0 || old_v != 0) {
    u -= speed(i) * swept_[i].inverse;
    const float slip = speed(j) + (u - old_u) * answer(i)[j];
    v -= slip * swept_[j].inverse;
    const float length = std::sqrt(u * u + v * v);
    if (length > most) {
      u *= most / length;
      v *= most / length;
    }
    change(i, u - old_u);
    change(j, v - old_v);
    largest = std::max(
        {largest, std::abs(u - old_u) * swept_[i].own, std::abs(v - old_v) * swept_[j].own});
  }
  if (patch.arms.size() < 2 || (most_spin == 0 && impulses_[k] == 0)) return;
  const float old = impulses_[k];
  impulses_[k] = std::clamp(old - speed(k) * swept_[k].inverse, -most_spin, most_spin);
  change(k, impulses_[k] - old);
}

float ImpulseSolver::sweep() {
  float largest = 0;
  for (const Group& group : groups_) {
    const Patch* patch = group.patch < 0 ? nullptr : &patches_[at(group.patch)];
    const std::size_t end = patch == nullptr ? group.end : patch->end;
    for (std::size_t r = group.first; r < end; ++r) sweep_row(r, largest);
    if (patch != nullptr) sweep_friction(*patch, largest);
    if (changes_.empty()) continue;
    add_terms(changes_, answers_, speeds_.data());
    changes_.clear();
  }
  return largest;
}

// Sweeps as steps of nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben, 2010):
// what a sweep changes is the gradient, and a part of the last direction goes with it.
void ImpulseSolver::sweep_until(bool relax, int count) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    swept_[r].target = static_cast<float>(relax ? rows_[r].kept : rows_[r].target);
  }
  impulse_turns_.assign(stride_, 0);
  speed_turns_.assign(stride_, 0);
  float slope = 0;
  for (int i = 0; i < count; ++i) {
    impulses_before_ = impulses_;
    speeds_before_ = speeds_;
    if (sweep() < kEnough || i + 1 == count) return;
    const float last = slope;
    slope = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const float change = impulses_[r] - impulses_before_[r];
      slope += change * change * swept_[r].own;
    }
    const float share = last > 0 && slope < last ? slope / last : 0;
    const auto go_on = [&](std::vector<float>& now, const std::vector<float>& before,
                           std::vector<float>& turns) {
      for (std::size_t r = 0; r < stride_; ++r) {
        const float old = share * turns[r];
        turns[r] = now[r] - before[r] + old;
        now[r] += old;
      }
    };
    go_on(impulses_, impulses_before_, impulse_turns_);
    go_on(speeds_, speeds_before_, speed_turns_);
  }
}

// The twists of all bodies with the impulses that there are.
void ImpulseSolver::sum(std::vector<Vec6>& all) {
  pushes_.assign(all.size(), Vec6::Zero());
  for (const Group& group : groups_) {
    Vec6 wrench = Vec6::Zero();
    for (std::size_t r = group.first; r < group.end; ++r) {
      wrench += static_cast<double>(impulses_[r]) * rows_[r].wrench;
    }
    pushes_[at(group.a)] += wrench;
    if (group.b >= 0) pushes_[at(group.b)] -= wrench;
  }
  bodies_->answer(pushes_, all);
}

void ImpulseSolver::solve(int iterations) {
  if (rows_.empty()) return;
  connect();
  warm_start(false);
  sweep_all(iterations);
}

void ImpulseSolver::solve_again(int iterations) {
  connect();
  warm_start(true);
  sweep_all(iterations);
}

void ImpulseSolver::sweep_all(int iterations) {
  sweep_until(false, iterations);
  sum(moving_);
  for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].pushed = impulses_[r];
  if (std::ranges::any_of(rows_, [](const Row& r) { return r.target != r.kept; })) {
    sweep_until(true, std::max(2, iterations / 2));
    sum(left_);
  } else {
    left_ = moving_;
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (rows_[r].cache != nullptr) *rows_[r].cache = impulses_[r];
  }
}

}  // namespace krok::ragdoll

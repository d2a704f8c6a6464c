#include <algorithm>
#include <cmath>

#include "ragdoll/impulse_solver_internal.h"

namespace krok::ragdoll {

namespace {
// Sweeps end where no row's speed changes by more, m/s or rad/s.
constexpr float kEnough = 5e-5F;
}  // namespace

// How all bodies that have rows answer to a wrench at each group.
void ImpulseSolver::connect() {
  touched_.clear();
  std::vector<int> place(moving_.size(), -1);
  const auto touch = [&](int body) {
    if (body >= 0 && place[at(body)] < 0) {
      place[at(body)] = static_cast<int>(touched_.size());
      touched_.push_back(body);
    }
    return body < 0 ? -1 : place[at(body)];
  };
  for (Group& group : groups_) {
    group.touched_a = touch(group.a);
    group.touched_b = touch(group.b);
  }
  answers_.resize(groups_.size() * touched_.size());
  swept_.resize(rows_.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    for (std::size_t t = 0; t < touched_.size(); ++t) {
      Mat6 answer = bodies_->response(touched_[t], group.a);
      if (group.b >= 0) answer -= bodies_->response(touched_[t], group.b);
      Mat8f& whole = answers_[g * touched_.size() + t];
      whole.setZero();
      whole.topLeftCorner<6, 6>() = answer.cast<float>();
    }
    Mat6 own = bodies_->response(group.a, group.a);
    if (group.b >= 0) {
      own += bodies_->response(group.b, group.b) - bodies_->response(group.a, group.b) -
             bodies_->response(group.b, group.a);
    }
    for (std::size_t r = group.first; r < group.end; ++r) {
      const Vec6 answer = own * rows_[r].wrench;
      Swept& row = swept_[r];
      row.wrench << rows_[r].wrench.cast<float>(), 0, 0;
      row.answer << answer.cast<float>(), 0, 0;
      row.inverse = static_cast<float>(1 / std::max(rows_[r].wrench.dot(answer), 1e-12));
    }
  }
}

void ImpulseSolver::spread(std::size_t group, const Vec8f& wrench) {
  const Mat8f* answers = &answers_[group * touched_.size()];
  for (std::size_t t = 0; t < touched_.size(); ++t) {
    twists_[t].noalias() += answers[t].leftCols<6>() * wrench.head<6>();
  }
}

void ImpulseSolver::warm_start(bool again) {
  twists_.clear();
  for (const int body : touched_) {
    twists_.emplace_back();
    twists_.back() << bodies_->twists()[at(body)].cast<float>(), 0, 0;
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Vec8f wrench = Vec8f::Zero();
    for (std::size_t r = groups_[g].first; r < groups_[g].end; ++r) {
      Row& row = rows_[r];
      row.impulse = again ? row.pushed : row.cache == nullptr ? 0 : *row.cache;
      wrench += row.impulse * swept_[r].wrench;
    }
    if (!wrench.isZero(0)) spread(g, wrench);
  }
}

void ImpulseSolver::sweep_row(std::size_t r, Vec8f& difference, Vec8f& wrench, float& largest) {
  const Swept& swept = swept_[r];
  Row& row = rows_[r];
  const float before = row.impulse;
  row.impulse += (swept.target - swept.wrench.dot(difference)) * swept.inverse;
  if (!row.both) row.impulse = std::max(row.impulse, 0.0F);
  const float change = row.impulse - before;
  if (change == 0) return;
  largest = std::max(largest, std::abs(change) / swept.inverse);
  wrench += change * swept.wrench;
  difference += change * swept.answer;
}

// Coulomb's cone: both rows across together, at most the friction times the pressure.
void ImpulseSolver::sweep_friction(const Patch& patch, Vec8f& difference, Vec8f& wrench,
                                   float& largest) {
  float most = 0, most_spin = 0;
  for (std::size_t r = patch.first; r < patch.end; ++r) {
    most += patch.friction * rows_[r].impulse;
    most_spin += patch.friction * rows_[r].impulse * patch.arms[r - patch.first];
  }
  Row &u = rows_[patch.end], &v = rows_[patch.end + 1], &spin = rows_[patch.end + 2];
  const Swept *su = &swept_[patch.end], *sv = su + 1, *ss = su + 2;
  const float old_u = u.impulse, old_v = v.impulse, old_spin = spin.impulse;
  if (most == 0 && old_u == 0 && old_v == 0 && old_spin == 0) return;
  u.impulse -= su->wrench.dot(difference) * su->inverse;
  const float slip = sv->wrench.dot(difference) + (u.impulse - old_u) * sv->wrench.dot(su->answer);
  v.impulse -= slip * sv->inverse;
  const float length = std::sqrt(u.impulse * u.impulse + v.impulse * v.impulse);
  if (length > most) {
    u.impulse *= most / length;
    v.impulse *= most / length;
  }
  const float du = u.impulse - old_u, dv = v.impulse - old_v;
  wrench += du * su->wrench + dv * sv->wrench;
  difference += du * su->answer + dv * sv->answer;
  spin.impulse =
      std::clamp(old_spin - ss->wrench.dot(difference) * ss->inverse, -most_spin, most_spin);
  const float ds = spin.impulse - old_spin;
  wrench += ds * ss->wrench;
  difference += ds * ss->answer;
  largest = std::max({largest, std::abs(du) / su->inverse, std::abs(dv) / sv->inverse});
}

float ImpulseSolver::sweep() {
  float largest = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    Vec8f difference = twists_[at(group.touched_a)], wrench = Vec8f::Zero();
    if (group.b >= 0) difference -= twists_[at(group.touched_b)];
    const Patch* patch = group.patch < 0 ? nullptr : &patches_[at(group.patch)];
    const std::size_t end = patch == nullptr ? group.end : patch->end;
    for (std::size_t r = group.first; r < end; ++r) sweep_row(r, difference, wrench, largest);
    if (patch != nullptr) sweep_friction(*patch, difference, wrench, largest);
    if (!wrench.isZero(0)) spread(g, wrench);
  }
  return largest;
}

// Sweeps as steps of nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben, 2010):
// what a sweep changes is the gradient, and a part of the last direction goes with it.
void ImpulseSolver::sweep_until(bool relax, int count) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    swept_[r].target = static_cast<float>(relax ? rows_[r].kept : rows_[r].target);
  }
  directions_.assign(rows_.size(), 0.0F);
  turns_.assign(touched_.size(), Vec8f::Zero());
  before_.resize(rows_.size());
  float slope = 0;
  for (int i = 0; i < count; ++i) {
    for (std::size_t r = 0; r < rows_.size(); ++r) before_[r] = rows_[r].impulse;
    twists_before_ = twists_;
    if (sweep() < kEnough || i + 1 == count) return;
    const float last = slope;
    slope = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const float change = rows_[r].impulse - before_[r];
      slope += change * change / swept_[r].inverse;
    }
    const float share = last > 0 && slope < last ? slope / last : 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const float old = share * directions_[r];
      directions_[r] = rows_[r].impulse - before_[r] + old;
      rows_[r].impulse += old;
    }
    for (std::size_t t = 0; t < touched_.size(); ++t) {
      const Vec8f old = share * turns_[t];
      turns_[t] = twists_[t] - twists_before_[t] + old;
      twists_[t] += old;
    }
  }
}

// The twists of all bodies with the impulses that there are.
std::vector<Vec6> ImpulseSolver::sum() const {
  std::vector<Vec6> all = bodies_->twists();
  for (const Group& group : groups_) {
    Vec6 wrench = Vec6::Zero();
    for (std::size_t r = group.first; r < group.end; ++r) {
      wrench += static_cast<double>(rows_[r].impulse) * rows_[r].wrench;
    }
    if (wrench.isZero(0)) continue;
    for (int b = 0; b < bodies_->body_count(); ++b) {
      all[at(b)].noalias() += bodies_->response(b, group.a) * wrench;
      if (group.b >= 0) all[at(b)].noalias() -= bodies_->response(b, group.b) * wrench;
    }
  }
  return all;
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
  moving_ = sum();
  for (Row& row : rows_) row.pushed = row.impulse;
  if (std::ranges::any_of(rows_, [](const Row& r) { return r.target != r.kept; })) {
    sweep_until(true, std::max(2, iterations / 2));
    left_ = sum();
  } else {
    left_ = moving_;
  }
  for (const Row& row : rows_) {
    if (row.cache != nullptr) *row.cache = row.impulse;
  }
}

}  // namespace krok::ragdoll

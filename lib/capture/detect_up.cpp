#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "capture/actor_internal.h"

namespace krok::actor {

namespace {

// Number of samples in which the body is upright along each axis.
struct UpVotes {
  std::array<int, 6> votes{};
  int valid = 0;

  explicit UpVotes(const Evidence& evidence) {
    constexpr double kUpright = 0.8;  // within 37 degrees
    for (std::size_t i = 0; i < evidence.sample_count; ++i) {
      const auto axis = body_axis(evidence.sample(i), evidence.marks);
      if (!axis) continue;
      ++valid;
      const NearestAxis nearest = nearest_axis(*axis);
      if (nearest.cosine >= kUpright) ++votes[static_cast<std::size_t>(nearest.direction)];
    }
  }

  Direction winner() const {
    return static_cast<Direction>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
  double share(Direction d) const {
    return valid == 0 ? 0 : static_cast<double>(votes[static_cast<std::size_t>(d)]) / valid;
  }
};

void detect_up_without_motion(const Evidence& evidence, Conventions& found) {
  if (evidence.reference_stands) {
    found.up = evidence.reference_stands->direction;
    found.up_confidence =
        evidence.reference_stands->cosine > 0.95 ? Confidence::certain : Confidence::likely;
    found.up_reason = fmt::format("the reference pose is upright along {}", signed_name(found.up));
    return;
  }
  const auto axis = body_axis(evidence.reference, evidence.marks);
  if (!axis) {
    found.up_reason = "the body axis has zero length; +y is the default";
    return;
  }
  found.up = nearest_axis(*axis).direction;
  found.up_reason =
      fmt::format("the reference pose is not upright; its head is furthest from the {} along {}",
                  evidence.marks.lower_end(), signed_name(found.up));
}

bool is_usual(Direction up) {
  return up == Direction::plus_y || up == Direction::plus_z;
}

// How well each signed axis explains the motion as up.
class UpScores {
 public:
  UpScores(const Evidence& evidence, const UpVotes& votes)
      : votes_(votes), heights_(heights_of(evidence)) {
    if (evidence.reference_stands) reference_ = evidence.reference_stands->direction;
    const Vec3 side = mean_side(evidence);
    for (int i = 0; i < 6; ++i) {
      const auto d = static_cast<Direction>(i);
      scores_[static_cast<std::size_t>(i)] = score(d) - kSide * side[i / 2];
    }
    // +y, which most files have, wins a tie.
    for (const Direction d : {Direction::plus_z, Direction::plus_x, Direction::minus_x,
                              Direction::minus_y, Direction::minus_z}) {
      if (of(d) > of(best_)) best_ = d;
    }
  }

  Direction best() const { return best_; }

  // By how much the best axis exceeds the second.
  double margin() const {
    double second = -INFINITY;
    for (int i = 0; i < 6; ++i) {
      const auto d = static_cast<Direction>(i);
      if (d != best_) second = std::max(second, of(d));
    }
    return of(best_) - second;
  }

  bool heights_known() const { return heights_.has_value(); }

  // Range of the lowest joint's height over time, in body heights: small along the true up axis,
  // however far the character travels. Of both signs the smaller.
  double spread(Direction d) const {
    return std::min(heights(d).spread, heights(opposite(d)).spread);
  }

  // Whether the lowest joint is at the ground of the file's world, which is at 0, and stays there.
  bool on_the_ground(Direction d) const {
    constexpr double kNear = 0.08, kBelow = -0.03, kKeeps = 0.1;
    constexpr double kMinHips = 0.03;  // soft tissue between the hips and the ground
    if (!heights_) return false;
    const Heights& found = heights(d);
    return found.lowest >= kBelow && found.lowest <= kNear && found.spread < kKeeps &&
           found.hips >= kMinHips;
  }

  // Roughly: one who lies has hands and feet below the markers' plane.
  bool near_the_ground(Direction d) const {
    constexpr double kNear = 0.1, kKeeps = 0.1;
    return heights_ && std::abs(heights(d).lowest) <= kNear && heights(d).spread < kKeeps;
  }

 private:
  // Weights. Ground outweighs a body that is upright elsewhere, since it may lie; a character that
  // travels along an axis outweighs both; a reference pose alone does not.
  static constexpr double kUpright = 1.5, kReference = 1, kGround = 1.6, kReferenceOnGround = 0.4;
  static constexpr double kTravel = 2.5, kSide = 0.8;
  static constexpr double kUsual = 0.2, kUsualAlone = 1.6;  // with a reference pose, without

  static Vec3 mean_side(const Evidence& evidence) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (std::size_t i = 0; i < evidence.sample_count; ++i) {
      const auto side = side_axis(evidence.sample(i), evidence.marks);
      if (!side) continue;
      sum += side->cwiseAbs();
      ++count;
    }
    return count == 0 ? sum : Vec3(sum / count);
  }

  double of(Direction d) const { return scores_[static_cast<std::size_t>(d)]; }
  const Heights& heights(Direction d) const { return (*heights_)[static_cast<std::size_t>(d)]; }

  double score(Direction d) const {
    const bool agrees = reference_ == d;
    double sum = kUpright * votes_.share(d) + (agrees ? kReference : 0);
    if (is_usual(d)) sum += reference_ ? kUsual : kUsualAlone;
    if (!heights_) return sum;
    if (on_the_ground(d)) sum += kGround + (agrees ? kReferenceOnGround : 0);
    constexpr double kSteady = 0.02, kTravels = 0.42;  // in body heights
    return sum - kTravel * std::clamp((spread(d) - kSteady) / (kTravels - kSteady), 0.0, 1.0);
  }

  const UpVotes& votes_;
  std::optional<std::array<Heights, 6>> heights_;
  std::optional<Direction> reference_;
  std::array<double, 6> scores_{};
  Direction best_ = Direction::plus_y;
};

int percent_of(double share) {
  return static_cast<int>(std::lround(100 * share));
}

// Whether the character travels along another axis than `up`, while its support keeps its height.
bool travels_level(const UpScores& scores, Direction up, std::optional<Direction> along) {
  constexpr double kLevel = 0.25;  // in body heights
  constexpr double kSteadier = 0.5;
  if (!scores.heights_known()) return false;
  for (const Direction d : {Direction::plus_x, Direction::plus_y, Direction::plus_z}) {
    if (on_one_axis(d, up) || (along && !on_one_axis(d, *along))) continue;
    if (scores.spread(d) > kLevel && scores.spread(up) < kSteadier * scores.spread(d)) return true;
  }
  return false;
}

// Certain only where reference pose and motion agree, or where the motion shows besides that the
// reference pose's axis is level.
Confidence confidence_of(const Evidence& evidence, const UpVotes& votes, const UpScores& scores) {
  constexpr double kAtTimes = 0.2, kMostly = 0.5, kThroughout = 0.95;
  constexpr double kClear = 0.5;  // of scores
  const Direction up = scores.best();
  const double share = votes.share(up);
  const auto& reference = evidence.reference_stands;
  if (reference && reference->direction == up) {
    if (share >= kMostly) return Confidence::certain;
    const bool elsewhere = votes.share(votes.winner()) >= kMostly;
    return share >= kAtTimes || !elsewhere ? Confidence::likely : Confidence::guess;
  }
  if (share < kMostly) return Confidence::guess;
  if (!reference) {
    const auto trunk = body_axis(evidence.reference, evidence.marks);  // all there is without feet
    const bool agrees =
        !evidence.marks.feet_known() && trunk && nearest_axis(*trunk).direction == up;
    const Direction other = up == Direction::plus_y ? Direction::plus_z : Direction::plus_y;
    const bool grounded = scores.on_the_ground(up) && !scores.near_the_ground(other);
    const bool shown = agrees || grounded || travels_level(scores, up, {});
    return shown && scores.margin() > kClear ? Confidence::likely : Confidence::guess;
  }
  const Direction other = reference->direction;
  const bool grounded = scores.on_the_ground(up) && !scores.on_the_ground(other);
  const bool level = travels_level(scores, up, other);
  if (!grounded && !level) {
    // Files with up along x are rare: such a reference pose lies.
    return is_usual(up) && !is_usual(other) ? Confidence::likely : Confidence::guess;
  }
  return share >= kThroughout && !on_one_axis(up, other) ? Confidence::certain : Confidence::likely;
}

std::string reason_of(const Evidence& evidence, const UpVotes& votes, const UpScores& scores) {
  const Direction up = scores.best();
  const Direction winner = votes.winner();
  const auto& reference = evidence.reference_stands;
  const bool agrees = reference && reference->direction == up;
  const bool upright = votes.share(up) >= 0.5;
  const bool lies = winner != up && votes.share(winner) >= 0.5;
  const auto above = [&](Direction d) {
    return fmt::format("the head is above the {} along {} in {}% of the sampled frames",
                       evidence.marks.lower_end(), signed_name(d), percent_of(votes.share(d)));
  };
  if (agrees && upright) return above(up) + ", and the reference pose agrees";
  std::string reason =
      !reference ? "the reference pose does not stand"
                 : "the reference pose is upright along " + signed_name(reference->direction);
  reason += "; " + above(lies ? winner : up);
  if (reference && !agrees && upright) {
    reason += on_one_axis(up, reference->direction) ? ", upside down to it" : "";
    reason += ", and the motion takes precedence";
  }
  if (lies && on_one_axis(up, winner)) reason += ", upside down";
  if (!scores.heights_known()) return reason;
  if (scores.on_the_ground(up)) {
    reason += fmt::format("; the lowest joint is near 0 along {}", signed_name(up));
  }
  const Direction other = lies ? winner : reference && !agrees ? reference->direction : up;
  reason += fmt::format("; the lowest joint keeps its height within {}% of the body's along {}",
                        percent_of(scores.spread(up)), signed_name(up));
  if (!on_one_axis(up, other)) {
    reason +=
        fmt::format(", within {}% along {}", percent_of(scores.spread(other)), signed_name(other));
  }
  return reason + (lies ? ": the character seems to lie or crawl" : "");
}

}  // namespace

void detect_up(const Evidence& evidence, Conventions& found) {
  const auto& marks = evidence.marks;
  if (!marks.trunk_known()) {
    found.up_reason = "up cannot be detected without hips and head; +y is the default";
    return;
  }
  const UpVotes votes(evidence);
  if (votes.valid == 0) {
    detect_up_without_motion(evidence, found);
  } else {
    const UpScores scores(evidence, votes);
    found.up = scores.best();
    found.up_confidence = confidence_of(evidence, votes, scores);
    found.up_reason = reason_of(evidence, votes, scores);
  }
  if (marks.upright_known()) return;
  found.up_reason += "; not checked against the feet, as fewer than two were found";
  if (found.up_confidence == Confidence::certain) found.up_confidence = Confidence::likely;
}

}  // namespace krok::actor

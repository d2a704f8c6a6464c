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

// The reference pose's up axis if files have such a one; a reference pose along another lies.
std::optional<NearestAxis> usual_reference(const Evidence& evidence) {
  const auto& reference = evidence.reference_stands;
  return reference && is_usual(reference->direction) ? reference : std::nullopt;
}

constexpr double kNear = 0.08;  // in body heights, as all that follow
constexpr double kBelow = -0.03;
constexpr double kKeepsHeight = 0.1;

bool keeps_to_the_ground(const Heights& heights) {
  return heights.lowest >= kBelow && heights.lowest <= kNear && heights.spread < kKeepsHeight;
}

// The floor is at 0, so the lowest joint of a standing character is near 0. If it is not along the
// detected up axis, and the reference pose is not upright along that axis either, the character may
// lie on the floor: its lowest joint is then near 0 along the true up axis.
void hold_against_the_ground(const Evidence& evidence, Conventions& found) {
  constexpr double kMinHips = 0.03;  // soft tissue between the hips and the ground
  const auto reference = usual_reference(evidence);
  const bool unusual = !is_usual(found.up);
  const auto standing = heights_along(evidence, found.up);
  if (!standing || (std::abs(standing->lowest) <= kNear && !unusual)) return;
  const auto lies = [&](Direction up) {
    if (on_one_axis(up, found.up)) return false;
    const auto lying = heights_along(evidence, up);
    return lying && keeps_to_the_ground(*lying) && lying->hips >= kMinHips;
  };
  std::optional<Direction> ground;
  if (reference) {
    if (lies(reference->direction)) ground = reference->direction;
  } else {
    for (const Direction up : {Direction::plus_z, Direction::plus_y}) {
      if (lies(up)) ground = up;
    }
  }
  if (ground) {
    found.up_reason += fmt::format(
        "; but the lowest joint is near 0 along {} instead, so the character seems to lie down{}",
        signed_name(*ground), reference ? "" : ", and the reference pose is not upright");
    found.up = *ground;
    found.up_confidence = Confidence::guess;
    return;
  }
  const auto& stands = evidence.reference_stands;
  if (std::abs(standing->lowest) <= kNear || (stands && stands->direction == found.up)) return;
  found.up_reason += "; but the lowest joint is not near the ground there";
  if (unusual || reference) {
    if (unusual && reference) {
      found.up = reference->direction;
      found.up_reason += ", and that up axis is rare; using that of the reference pose";
    }
    found.up_confidence = Confidence::guess;
  } else if (found.up_confidence == Confidence::certain) {
    found.up_confidence = Confidence::likely;
  }
}

// Whether trunk and legs are rarely aligned: on all fours, crawling or sitting.
bool stays_folded(const Evidence& evidence) {
  constexpr double kStretched = 0.6;
  constexpr double kNow = 0.2;
  std::size_t known = 0, stretched = 0;
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    const auto cosine = stretch(evidence.sample(i), evidence.marks);
    if (!cosine) continue;
    ++known;
    if (*cosine >= kStretched) ++stretched;
  }
  return known > 0 && static_cast<double>(stretched) < kNow * static_cast<double>(known);
}

// On all fours the head is in front of the feet rather than above them, so the heading is mistaken
// for up. If such a character travels along the detected up axis while its lowest joint stays at
// one height along another axis, that axis is up.
void look_for_a_floor(const Evidence& evidence, Conventions& found) {
  constexpr std::size_t kFewestSamples = 10;
  constexpr double kTravels = 0.25;
  if (evidence.sample_count < kFewestSamples || !stays_folded(evidence)) return;
  const auto seeming = heights_along(evidence, found.up);
  if (!seeming || seeming->spread < kTravels) return;
  std::optional<Direction> floor;
  double least = kKeepsHeight;
  for (const Direction up : {Direction::plus_y, Direction::plus_z}) {
    const auto heights = on_one_axis(up, found.up) ? std::nullopt : heights_along(evidence, up);
    if (!heights || heights->spread >= least) continue;
    floor = up;
    least = heights->spread;
  }
  if (!floor) return;
  found.up_reason += fmt::format(
      "; but the body is bent at the hips and the lowest joint keeps its height along {} while it "
      "travels, so the character seems to move on all fours",
      signed_name(*floor));
  found.up = *floor;
  found.up_confidence = Confidence::guess;
}

constexpr double kPart = 0.2;  // of the samples

// Whether the character is upright along both usual axes in part of the motion, so that it lies or
// falls along one of them.
bool is_upright_along_both(const UpVotes& votes) {
  return votes.share(Direction::plus_y) >= kPart && votes.share(Direction::plus_z) >= kPart;
}

// Whether the character is upright along the reference pose's up axis in part of the motion; along
// `other` it then lies or falls.
bool stands_at_times(const Evidence& evidence, const UpVotes& votes, Direction other) {
  const auto reference = usual_reference(evidence);
  return reference && reference->direction != other && votes.share(reference->direction) >= kPart;
}

// The up axis of a character that is rarely upright or lies along a usual axis at times: +y, which
// most files have, unless its lowest joint keeps to the ground along +z alone.
Direction up_by_the_ground(const Evidence& evidence) {
  const auto y = heights_along(evidence, Direction::plus_y);
  const auto z = heights_along(evidence, Direction::plus_z);
  const bool along_z = z && keeps_to_the_ground(*z) && !(y && keeps_to_the_ground(*y));
  return along_z ? Direction::plus_z : Direction::plus_y;
}

void detect_up_of_motion(const Evidence& evidence, const UpVotes& votes, Conventions& found) {
  const auto& reference = evidence.reference_stands;
  const auto usual = usual_reference(evidence);
  const Direction winner = votes.winner();
  const double share = votes.share(winner);
  const int percent = static_cast<int>(std::lround(100 * share));
  const bool agrees = reference && reference->direction == winner;
  const bool turned_over = usual && usual->direction == opposite(winner);
  const bool lies_at_times =
      usual ? stands_at_times(evidence, votes, winner) : is_upright_along_both(votes);
  if (share >= 0.5 && !turned_over && !lies_at_times) {
    found.up = winner;
    found.up_confidence = agrees || share >= 0.8 ? Confidence::certain : Confidence::likely;
    found.up_reason = fmt::format("the head is above the {} along {} in {}% of the sampled frames",
                                  evidence.marks.lower_end(), signed_name(winner), percent);
    if (agrees) {
      found.up_reason += ", and the reference pose agrees";
    } else if (reference) {
      found.up_reason +=
          fmt::format("; the reference pose is upright along {}, the motion takes precedence",
                      signed_name(reference->direction));
      if (found.up_confidence == Confidence::certain && share < 0.95) {
        found.up_confidence = Confidence::likely;
      }
    }
    if (!agrees || !is_usual(winner)) hold_against_the_ground(evidence, found);
    if (!reference) look_for_a_floor(evidence, found);
    return;
  }
  if (usual) {
    found.up = usual->direction;
    found.up_confidence = Confidence::likely;
    found.up_reason = fmt::format(
        "the reference pose is upright along {}; the motion is upright along it in only {}% of the "
        "sampled frames",
        signed_name(found.up), static_cast<int>(std::lround(100 * votes.share(found.up))));
    if (turned_over && share >= 0.8) {
      found.up_confidence = Confidence::guess;
      found.up_reason += fmt::format(", and upside down in {}%", percent);
    }
    return;
  }
  found.up = up_by_the_ground(evidence);
  found.up_reason =
      fmt::format("the character is rarely upright; {}",
                  found.up == Direction::plus_z ? "the lowest joint is near the ground along +z"
                                                : "+y is kept, which most files have");
  look_for_a_floor(evidence, found);
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
    detect_up_of_motion(evidence, votes, found);
  }
  if (marks.upright_known()) return;
  found.up_reason += "; not checked against the feet, as fewer than two were found";
  if (found.up_confidence == Confidence::certain) found.up_confidence = Confidence::likely;
}

}  // namespace krok::actor

#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "contacts/gait_keytimes.h"
#include "samples/generator/walk.h"

namespace krok::test {

inline std::vector<double> times_of(const std::vector<Keytime>& keytimes, const std::string& name) {
  std::vector<double> times;
  for (const Keytime& key : keytimes) {
    if (key.name == name) times.push_back(key.time);
  }
  return times;
}

// How what was found lies to what is known.
struct Hits {
  int known = 0, within_a_frame = 0, extra = 0;
  double squares = 0;
  int matched = 0;

  double share() const { return known == 0 ? 1 : static_cast<double>(within_a_frame) / known; }
  double rms() const { return matched == 0 ? 0 : std::sqrt(squares / matched); }
};

// A frame is 1/60 s, as in the published figures, whatever the clip's rate.
inline void match(const std::vector<double>& known, std::vector<double> found, Hits& hits) {
  for (const double time : known) {
    ++hits.known;
    const auto nearest = std::min_element(found.begin(), found.end(), [&](double a, double b) {
      return std::abs(a - time) < std::abs(b - time);
    });
    if (nearest == found.end() || std::abs(*nearest - time) > 0.2) continue;
    const double error = *nearest - time;
    hits.squares += error * error;
    ++hits.matched;
    if (std::abs(error) <= 1.0 / 60 + 1e-9) ++hits.within_a_frame;
    found.erase(nearest);
  }
  hits.extra += static_cast<int>(found.size());
}

struct WalkHits {
  Hits strikes, offs;
  double share() const {
    return static_cast<double>(strikes.within_a_frame + offs.within_a_frame) /
           std::max(1, strikes.known + offs.known);
  }
};

inline void match(const samples::Walk& walk, const std::vector<Keytime>& keytimes, WalkHits& hits) {
  for (const char* side : {"left", "right"}) {
    const samples::FootContacts& foot = walk.feet[side == std::string("left") ? 0 : 1];
    match(foot.strikes, times_of(keytimes, std::string(side) + "_strike"), hits.strikes);
    match(foot.offs, times_of(keytimes, std::string(side) + "_off"), hits.offs);
  }
}

// The clip without the joints whose names contain one of these.
inline Clip without(const Clip& clip, const std::vector<std::string>& names) {
  Clip result;
  result.rate = clip.rate;
  std::vector<int> kept, place(clip.skeleton.names.size(), -1);
  for (int j = 0; j < clip.joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    const bool drop = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return clip.skeleton.names[i].find(name) != std::string::npos;
    });
    if (drop) continue;
    const int parent = clip.skeleton.parents[i];
    place[i] = result.skeleton.add(clip.skeleton.names[i],
                                   parent < 0 ? parent : place[static_cast<std::size_t>(parent)],
                                   clip.skeleton.reference[i], clip.skeleton.end_sites[i] != 0);
    kept.push_back(j);
  }
  result.resize(clip.frame_count());
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const auto from = static_cast<std::size_t>(kept[k]);
      result.frame_positions(f)[k] = clip.frame_positions(f)[from];
      result.frame_orientations(f)[k] = clip.frame_orientations(f)[from];
    }
  }
  return result;
}

inline std::vector<Keytime> keytimes_of(const Clip& clip) {
  const RoleMap roles = find_roles(clip.skeleton);
  const auto contacts = find_contacts(clip, roles);
  return contacts ? find_gait(clip, roles, *contacts).keytimes : std::vector<Keytime>();
}

}  // namespace krok::test

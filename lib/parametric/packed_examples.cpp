#include "parametric/packed_examples.h"

#include <algorithm>
#include <cmath>

#include "math/hermite.h"
#include "math/quaternion.h"

namespace krok::parametric {

namespace {

constexpr double kReferenceRate = 60;   // reference poses per second of generic time
constexpr double kMaxReference = 4096;  // max number of reference poses
constexpr double kMinReach = 0.01;      // of the skeleton's extent
constexpr int kSpreadParts = 4;         // samples per interval for the spread

void add_times(const Library& library, PackedExamples& packed) {
  const auto keytimes = static_cast<Eigen::Index>(library.keytimes.size());
  const auto examples = static_cast<Eigen::Index>(library.examples.size());
  packed.times.resize(keytimes, examples);
  packed.slopes.resize(keytimes, examples);
  packed.generic.assign(library.keytimes.size(), 0);
  for (const Example& example : library.examples) {
    for (std::size_t k = 0; k < packed.generic.size(); ++k) {
      packed.generic[k] += (example.keytimes[k] - example.keytimes[0]) /
                           static_cast<double>(library.examples.size());
    }
  }
  for (Eigen::Index i = 0; i < examples; ++i) {
    const auto& times = library.examples[static_cast<std::size_t>(i)].keytimes;
    for (Eigen::Index k = 0; k < keytimes; ++k) {
      packed.times(k, i) = times[static_cast<std::size_t>(k)];
    }
    monotone_velocities(packed.generic, times, Ends::open,
                        {packed.slopes.col(i).data(), static_cast<std::size_t>(keytimes)});
  }
}

std::vector<Transform> local_pose(const PackedExamples& packed, int example, double generic) {
  const PackedClip& clip = packed.clips[static_cast<std::size_t>(example)];
  std::vector<PoseBlock> pose(static_cast<std::size_t>(clip.blocks_per_pose()));
  sample_pose(clip, example_time(packed, generic_place(packed.generic, generic), example), pose);
  std::vector<Transform> local(static_cast<std::size_t>(clip.joints));
  unpack_pose(pose, local);
  return local;
}

// Sums in the hemisphere of the previous pose, so that the reference is continuous.
void add_reference(PackedExamples& packed) {
  const int joints = packed.clips.front().joints;
  PackedClip& reference = packed.reference;
  reference.joints = joints;
  // Bounds the size of the reference for motions of any duration.
  const double last = packed.generic.back();
  const double count = std::clamp(std::ceil(last * kReferenceRate), 1.0, kMaxReference);
  reference.rate = count / last;
  reference.frames = static_cast<int>(count) + 1;
  const auto blocks = static_cast<std::size_t>(reference.blocks_per_pose());
  reference.blocks.resize(static_cast<std::size_t>(reference.frames) * blocks);
  std::vector<Transform> mean = local_pose(packed, 0, 0);
  for (int f = 0; f < reference.frames; ++f) {
    std::vector<Vec4> sums(mean.size(), Vec4::Zero());
    std::vector<Vec3> places(mean.size(), Vec3::Zero());
    for (int i = 0; i < packed.examples(); ++i) {
      const auto pose = local_pose(packed, i, f / reference.rate);
      for (std::size_t j = 0; j < pose.size(); ++j) {
        sums[j] += in_hemisphere_of(mean[j].orientation, pose[j].orientation).coeffs();
        places[j] += pose[j].position / packed.examples();
      }
    }
    for (std::size_t j = 0; j < mean.size(); ++j) {
      mean[j].position = places[j];
      if (sums[j].norm() > 1e-6) mean[j].orientation.coeffs() = sums[j].normalized();
    }
    pack_pose(mean,
              std::span(reference.blocks).subspan(static_cast<std::size_t>(f) * blocks, blocks));
  }
}

std::vector<std::uint8_t> joints_with_bones(const Skeleton& skeleton) {
  std::vector<std::uint8_t> carries(skeleton.names.size(), 0);
  const double least = kMinReach * reference_extent(skeleton);
  for (std::size_t j = carries.size(); j-- > 1;) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    const Vec3 bone = skeleton.reference[j].position - skeleton.reference[parent].position;
    if (carries[j] || bone.norm() > least) carries[parent] = 1;
  }
  return carries;
}

}  // namespace

PackedExamples pack_examples(const Library& library) {
  PackedExamples packed;
  std::vector<const Clip*> motions;
  for (const Example& example : library.examples) motions.push_back(&example.motion);
  packed.hips_root = HipsRoot(motions, carrying_joint(library));
  // A root that stands has been moved along with each step into the stance foot's frame.
  packed.hips_root.stand_at(library.skeleton.reference.front());
  packed.skeleton = packed.hips_root.rooted(library.skeleton);
  for (const Clip* motion : motions) {
    packed.clips.push_back(packed.hips_root.changes() ? pack_clip(packed.hips_root.rooted(*motion))
                                                      : pack_clip(*motion));
  }
  add_times(library, packed);
  add_reference(packed);
  packed.carries = joints_with_bones(packed.skeleton);
  return packed;
}

GenericTimePoint generic_place(std::span<const double> knots, double generic) {
  const std::size_t last = knots.size() - 1;
  std::size_t k = 0;
  while (k + 1 < last && generic >= knots[k + 1]) ++k;
  const double span = knots[k + 1] - knots[k];
  const double s = std::clamp((generic - knots[k]) / span, 0.0, 1.0), rest = 1 - s;
  return {static_cast<int>(k),
          {(1 + 2 * s) * rest * rest, s * s * (3 - 2 * s)},
          {span * s * rest * rest, -span * s * s * rest}};
}

Spread widest_spread(const PackedExamples& packed) {
  Spread widest;
  const auto last = static_cast<int>(packed.generic.size()) - 1;
  for (int m = 0; m <= last * kSpreadParts; ++m) {
    const auto k = static_cast<std::size_t>(std::min(m / kSpreadParts, last - 1));
    const double part = static_cast<double>(m) / kSpreadParts - static_cast<double>(k);
    const double generic = packed.generic[k] + part * (packed.generic[k + 1] - packed.generic[k]);
    std::vector<std::vector<Transform>> poses;
    for (int i = 0; i < packed.examples(); ++i) poses.push_back(local_pose(packed, i, generic));
    for (std::size_t a = 0; a < poses.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        for (std::size_t j = 0; j < poses[a].size(); ++j) {
          const double angle = angle_between(poses[a][j].orientation, poses[b][j].orientation);
          if (!packed.carries[j] || angle <= widest.angle) continue;
          widest = {angle, packed.hips_root.original(static_cast<int>(j)), static_cast<int>(b),
                    static_cast<int>(a), generic};
        }
      }
    }
  }
  return widest;
}

}  // namespace krok::parametric

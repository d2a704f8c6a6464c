#include <krok/core/file.h>
#include <krok/formats/anim/anim.h>
#include <krok/formats/io/open_motion.h>
#include <krok/motion/sample.h>
#include <krok/skin/palette.h>

#include <cstdio>
#include <vector>

// A program of somebody else's: writes a clip of two joints, reads it back, samples it half-way.
int main() {
  krok::Clip clip;
  clip.skeleton.add("hips", krok::Skeleton::kNoParent, {});
  clip.skeleton.add("head", 0, {{0, 1, 0}, krok::Quat::Identity()});
  clip.rate = 10;
  clip.resize(2);
  clip.set_pose(0, clip.skeleton.reference);
  clip.set_pose(1, clip.skeleton.reference);
  clip.frame_positions(1)[0].z() = 1;
  clip.frame_positions(1)[1].z() = 1;

  auto file = krok::OutputFile::create("consumer.anim");
  if (!file || !krok::anim::write(clip, {}, *file) || !file->commit()) return 1;
  krok::io::PlainInputs inputs;
  const auto back = krok::io::open_motion("consumer.anim", inputs);
  if (!back || back->joint_count() != 2) return 1;

  std::vector<krok::Transform> pose(2), scratch(6);
  krok::sample(*back, 0.05, pose, scratch);
  std::printf("head at z = %.3f m\n", pose[1].position.z());
  return std::abs(pose[1].position.z() - 0.5) < 1e-6 ? 0 : 1;
}

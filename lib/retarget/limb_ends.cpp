#include "retarget/limb_ends.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/index.h"
#include "roles/joint_names.h"
#include "roles/roles.h"

namespace krok::retarget {

namespace {

// The vertices that follow `joint` more than any other.
std::vector<Vec3> vertices_of(const Model& model, int joint) {
  std::vector<Vec3> vertices;
  for (int v = 0; v < model.vertex_count(); ++v) {
    // Influences are in decreasing order.
    const std::size_t first = at(v) * at(model.influences_per_vertex);
    if (model.influence_joints[first] == joint) {
      vertices.push_back(model.positions[at(v)].cast<double>());
    }
  }
  return vertices;
}

// The mean of the points between two distances from `place` along a way; none without points there.
std::optional<Vec3> middle(const std::vector<Vec3>& points, const Vec3& place, const Vec3& along,
                           double from, double to) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Vec3& point : points) {
    const double far = (point - place).dot(along);
    if (far < from || far > to) continue;
    sum += point;
    ++count;
  }
  return count > 0 ? std::optional<Vec3>(sum / count) : std::nullopt;
}

// Where the mesh of a joint ends: on the line through what is above its foot or hand, as shoes
// point forwards; of a block, through its end. None for a mesh that does not go on beyond the
// joint.
std::optional<Vec3> end_of(const Model& model, int joint) {
  const Vec3 place = model.skeleton.reference[at(joint)].position;
  const Vec3 bone =
      place - model.skeleton.reference[at(model.skeleton.parents[at(joint)])].position;
  if (!(bone.norm() > 0)) return std::nullopt;
  const std::vector<Vec3> vertices = vertices_of(model, joint);
  const auto reach = [&](const Vec3& along) {
    double farthest = 0;
    for (const Vec3& vertex : vertices) farthest = std::max(farthest, (vertex - place).dot(along));
    return farthest;
  };
  Vec3 along = bone.normalized();
  const double far = reach(along);
  if (far < 0.2 * bone.norm()) return std::nullopt;
  auto through = middle(vertices, place, along, 0.5 * far, 0.8 * far);
  if (!through) through = middle(vertices, place, along, 0.8 * far, far);
  along = (*through - place).normalized();
  return place + reach(along) * along;
}

// The hand or foot by name that belongs to a forearm or shin without children, and hangs elsewhere;
// -1 if there is none. What is farther off than a limb is long is something else.
int loose_end(const Skeleton& skeleton, const std::vector<JointName>& names, int limb) {
  const JointName& of_limb = names[at(limb)];
  const Part wanted = of_limb.part == Part::lower_arm ? Part::hand : Part::foot;
  const auto place = [&](int joint) { return skeleton.reference[at(joint)].position; };
  const double longest = 1.5 * (place(limb) - place(skeleton.parents[at(limb)])).norm();
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (names[at(j)].part != wanted || names[at(j)].side != of_limb.side) continue;
    const double length = (place(j) - place(limb)).norm();
    if (length > 0.2 * longest && length < longest) return j;
  }
  return -1;
}

// A joint that hangs elsewhere and goes with one of those that were added.
struct LooseEnd {
  int end = 0, joint = 0;
};
std::vector<LooseEnd> loose_ends(const Skeleton& skeleton, int count) {
  const std::vector<JointName> names = read_joint_names(skeleton);
  std::vector<LooseEnd> loose;
  for (int end = skeleton.joint_count() - count; end < skeleton.joint_count(); ++end) {
    const int joint = loose_end(skeleton, names, skeleton.parents[at(end)]);
    if (joint >= 0 && joint < skeleton.joint_count() - count) loose.push_back({end, joint});
  }
  return loose;
}

Skeleton without_last(Skeleton skeleton, int count) {
  const std::size_t kept = skeleton.names.size() - at(count);
  skeleton.names.resize(kept);
  skeleton.parents.resize(kept);
  skeleton.reference.resize(kept);
  skeleton.end_sites.resize(kept);
  return skeleton;
}

}  // namespace

Skeleton with_limb_ends(const Model& model) {
  if (find_roles(model.skeleton).humanoid) return model.skeleton;
  const std::vector<JointName> names = read_joint_names(model.skeleton);
  const auto children = model.skeleton.children();
  Skeleton with_ends = model.skeleton;
  for (int j = 1; j < model.skeleton.joint_count(); ++j) {
    const JointName& name = names[at(j)];
    if (name.side == Side::middle || !children[at(j)].empty()) continue;
    if (name.part != Part::lower_arm && name.part != Part::lower_leg) continue;
    const std::string end_name = model.skeleton.names[at(j)] + "_end";
    if (const int loose = loose_end(model.skeleton, names, j); loose >= 0) {
      with_ends.add(end_name, j, model.skeleton.reference[at(loose)]);
      continue;
    }
    const auto end = end_of(model, j);
    if (!end) continue;
    const Quat& turn = model.skeleton.reference[at(j)].orientation;
    with_ends.add(end_name, j, {*end, turn});
  }
  return find_roles(with_ends).humanoid ? with_ends : model.skeleton;
}

std::vector<int> carrying_ends(const Skeleton& skeleton, int count) {
  std::vector<int> ends(skeleton.names.size(), -1);
  for (const LooseEnd& loose : loose_ends(skeleton, count)) ends[at(loose.joint)] = loose.end;
  for (std::size_t j = 1; j + at(count) < ends.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (ends[j] < 0 && parent >= 0) ends[j] = ends[at(parent)];
  }
  return ends;
}

FrameSource without_last_joints(FrameSource frames, int count) {
  if (count == 0) return frames;
  FrameSource kept = frames;
  kept.skeleton = without_last(frames.skeleton, count);
  const std::size_t from = frames.skeleton.names.size(), to = kept.skeleton.names.size();
  // Joints with the end that carries them, and their places in its frame.
  struct Carried {
    std::size_t joint, end;
    Transform in_end;
  };
  std::vector<Carried> carried;
  const std::vector<Transform>& reference = frames.skeleton.reference;
  const std::vector<int> ends = carrying_ends(frames.skeleton, count);
  for (std::size_t j = 0; j < to; ++j) {
    if (ends[j] < 0) continue;
    carried.push_back({j, at(ends[j]), reference[at(ends[j])].inverse() * reference[j]});
  }
  kept.read = [read = std::move(frames.read), carried = std::move(carried), from, to](
                  int first, int frame_count, std::span<Vec3f> positions,
                  std::span<Quatf> orientations) -> Status {
    std::vector<Vec3f> places(at(frame_count) * from);
    std::vector<Quatf> turns(places.size());
    if (Status status = read(first, frame_count, places, turns); !status) return status;
    for (std::size_t f = 0; f < at(frame_count); ++f) {
      for (const Carried& one : carried) {
        const Transform end{places[f * from + one.end].cast<double>(),
                            turns[f * from + one.end].cast<double>()};
        const Transform moved = end * one.in_end;
        places[f * from + one.joint] = moved.position.cast<float>();
        turns[f * from + one.joint] = moved.orientation.cast<float>();
      }
      std::copy_n(places.begin() + static_cast<std::ptrdiff_t>(f * from), to,
                  positions.begin() + static_cast<std::ptrdiff_t>(f * to));
      std::copy_n(turns.begin() + static_cast<std::ptrdiff_t>(f * from), to,
                  orientations.begin() + static_cast<std::ptrdiff_t>(f * to));
    }
    return {};
  };
  return kept;
}

Clip without_last_joints(Clip clip, int count) {
  if (count == 0) return clip;
  auto kept = load(without_last_joints(frames_of(clip), count), 1);
  kept->provenance = std::move(clip.provenance);
  return *std::move(kept);
}

void give_to_parents(const Skeleton& skeleton, int count, std::vector<Contact>& contacts) {
  const std::vector<LooseEnd> loose = loose_ends(skeleton, count);
  for (Contact& contact : contacts) {
    if (contact.joint < skeleton.joint_count() - count) continue;
    const auto found = std::ranges::find(loose, contact.joint, &LooseEnd::end);
    contact.joint = found != loose.end() ? found->joint : skeleton.parents[at(contact.joint)];
  }
}

}  // namespace krok::retarget

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/file.h"
#include "formats/anim/anim.h"
#include "formats/io/open_character.h"
#include "formats/obj/obj_writer.h"
#include "math/quaternion.h"
#include "scene/mesh_volume.h"
#include "skin/skin.h"
#include "skin/surface_normals.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-sculpts: writes poses of a body's left elbow, shoulder, knee and wrist, the body as it
// should be in each, with the volume that it has in its reference pose, and the description for
// krok-fit.

namespace {

using namespace krok;
using namespace krok::cli;

struct Sculpt {
  std::vector<double> degrees;  // about each axis of its joint
  std::string file;
};

struct Limb {
  const char* joint;
  std::vector<Vec3> axes;  // in the world
  std::vector<std::vector<double>> examples;
  std::vector<std::vector<double>> ranges;  // degrees, of held-out poses
  std::vector<double> shown;                // degrees, of show.anim
};

std::vector<Limb> limbs_of(const Skeleton& skeleton) {
  const auto place = [&](const char* joint) {
    return skeleton.reference[static_cast<std::size_t>(skeleton.find(joint))].position;
  };
  const Vec3 upper = (place("LeftForeArm") - place("LeftArm")).normalized();
  const Vec3 fore = (place("LeftHand") - place("LeftForeArm")).normalized();
  const Vec3 shin = (place("LeftFoot") - place("LeftLeg")).normalized();
  const Vec3 forward = Vec3::UnitZ(), up = Vec3::UnitY();
  return {{"LeftForeArm",
           {fore.cross(forward).normalized()},
           {{30}, {60}, {90}, {115}, {135}},
           {{3, 135}},
           {120}},
          {"LeftLeg",
           {shin.cross(Vec3(-forward)).normalized()},
           {{30}, {60}, {90}, {115}, {135}},
           {{3, 135}},
           {120}},
          {"LeftArm",
           {upper.cross(forward).normalized(), upper.cross(Vec3(-up)).normalized()},
           {{60, 0}, {-30, 40}, {60, 80}, {-10, 80}, {30, 45}},
           {{-30, 60}, {3, 80}},
           {20, 70}},
          {"LeftHand", {fore}, {{50}, {90}, {120}, {137}, {150}}, {{3, 150}}, {150}}};
}

void turn(const Skeleton& skeleton, int joint, const Vec3& rotation, std::vector<Transform>& pose) {
  const Vec3 centre = pose[static_cast<std::size_t>(joint)].position;
  const Quat by = from_rotation_vector(rotation);
  std::vector<char> moves(pose.size(), 0);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const int parent = skeleton.parents[j];
    moves[j] =
        static_cast<int>(j) == joint || (parent >= 0 && moves[static_cast<std::size_t>(parent)]);
    if (moves[j] == 0) continue;
    pose[j] = {by * (pose[j].position - centre) + centre, by * pose[j].orientation};
  }
}

double volume_of(const Model& model, const std::vector<Vec3f>& positions) {
  std::vector<Vec3> places;
  for (const Vec3f& p : positions) places.push_back(p.cast<double>());
  return mesh_volume(places, model.triangles).volume;
}

// Dual quaternion skinning, then along the normals, where weights blend, by as much as brings back
// the volume of the reference pose (as von Funck, Theisel, Seidel, Volume-preserving mesh skinning,
// VMV 2008, in one step).
std::vector<Vec3f> sculpted(const Model& model, const SkinBinding& binding, SkinPose& posed,
                            const std::vector<Transform>& pose,
                            const std::vector<std::uint32_t>& groups) {
  posed.set(pose);
  std::vector<Vec3f> shape(model.positions.size()), normals(shape.size());
  skin(binding, posed, {model.positions, {}, {}}, {shape, {}, {}}, 0);
  normals_of(model.triangles, shape, groups, normals);
  const double wanted = volume_of(model, model.positions);
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  std::vector<float> moves(shape.size());
  for (std::size_t v = 0; v < shape.size(); ++v) {
    // How much the joints of a vertex turn it differently: 0 where one joint, or the same motion.
    const std::size_t first = v * places;
    for (std::size_t a = 0; a < places; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const std::size_t i = model.influence_joints[first + a],
                          k = model.influence_joints[first + b];
        const Quat turn_i =
            pose[i].orientation * model.skeleton.reference[i].orientation.conjugate();
        const Quat turn_k =
            pose[k].orientation * model.skeleton.reference[k].orientation.conjugate();
        moves[v] += model.influence_weights[first + a] * model.influence_weights[first + b] *
                    static_cast<float>(1 - std::cos(angle_between(turn_i, turn_k)));
      }
    }
  }
  double by = 0, slope = 0;  // metres
  std::vector<Vec3f> moved = shape;
  for (int round = 0; round < 6; ++round) {
    const double lost = wanted - volume_of(model, moved);
    if (slope == 0) {
      std::vector<Vec3f> probe = shape;
      for (std::size_t v = 0; v < shape.size(); ++v) probe[v] += 1e-3f * moves[v] * normals[v];
      slope = (volume_of(model, probe) - volume_of(model, shape)) / 1e-3;
      if (!(slope > 1e-9)) break;
    }
    by += lost / slope;
    for (std::size_t v = 0; v < shape.size(); ++v) {
      moved[v] = shape[v] + static_cast<float>(by) * moves[v] * normals[v];
    }
  }
  return moved;
}

std::string entries(const std::vector<Sculpt>& sculpts, std::size_t begin, std::size_t end,
                    int& frame) {
  std::string text;
  for (std::size_t i = begin; i < end; ++i) {
    text +=
        fmt::format("{}\n      {{\"motion\": \"poses.anim\", \"frame\": {}, \"shape\": \"{}\"}}",
                    i > begin ? "," : "", frame++, sculpts[i].file);
  }
  return text;
}

Result<int> run(ToolContext& context, const std::string& body) {
  auto actor = io::open_actor(body, context, {});
  if (!actor) return actor.error();
  const Model& model = actor->model;
  const SkinBinding binding(model, SkinMethod::dual_quaternion);
  SkinPose posed(binding);
  const auto groups = shading_groups(model.positions, {});
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(context.output).parent_path();
  fs::create_directories(folder / "sculpts");
  auto writer = obj::Writer::create(model, {});
  if (!writer) return writer.error();

  OutputSet outputs(context);
  std::vector<std::vector<Transform>> poses = {model.skeleton.reference};
  std::string text =
      "{\n  \"schema\": \"krok.corrective-poses/1\",\n  \"model\": \"body.model\",\n"
      "  \"joints\": [";
  std::mt19937 random(46);
  int frame = 1;
  std::vector<std::vector<Transform>> shown;
  std::string joints;
  const std::vector<Limb> limbs = limbs_of(model.skeleton);
  for (const Limb& limb : limbs) {
    const int joint = model.skeleton.find(limb.joint);
    std::vector<Sculpt> sculpts;
    for (const auto& degrees : limb.examples) sculpts.push_back({degrees, {}});
    for (int i = 0; i < 20; ++i) {
      Sculpt& sculpt = sculpts.emplace_back();
      for (const auto& range : limb.ranges) {
        const double share = static_cast<double>(random() % 10001) / 10000;
        sculpt.degrees.push_back(range[0] + share * (range[1] - range[0]));
      }
    }
    const auto pose_at = [&](const std::vector<double>& degrees) {
      Vec3 rotation = Vec3::Zero();
      for (std::size_t a = 0; a < limb.axes.size(); ++a) {
        rotation += limb.axes[a] * (degrees[a] * kRadiansPerDegree);
      }
      std::vector<Transform> pose = model.skeleton.reference;
      turn(model.skeleton, joint, rotation, pose);
      return pose;
    };
    shown.push_back(pose_at(limb.shown));
    const Vec3 place = model.skeleton.reference[static_cast<std::size_t>(joint)].position;
    joints += fmt::format("{},{:.6f},{:.6f},{:.6f}\n", limb.joint, place.x(), place.y(), place.z());
    for (std::size_t i = 0; i < sculpts.size(); ++i) {
      std::vector<Transform> pose = pose_at(sculpts[i].degrees);
      std::vector<Vec3f> shape = sculpted(model, binding, posed, pose, groups);
      std::vector<Vec3f> normals(shape.size());
      moved_normals(model.triangles, model.positions, model.normals, shape, normals);
      sculpts[i].file = fmt::format("sculpts/{}_{:02}.obj", limb.joint, i);
      Status status = outputs.add((folder / sculpts[i].file).string(), [&](OutputFile& file) {
        return writer->write({shape, normals, {}}, file);
      });
      if (!status) return status.error();
      poses.push_back(std::move(pose));
    }
    const std::size_t examples = limb.examples.size();
    text += fmt::format("{}\n    {{\"joint\": \"{}\",\n     \"examples\": [",
                        &limb == &limbs[0] ? "" : ",", limb.joint);
    text += entries(sculpts, 0, examples, frame) + "],\n     \"held_out\": [";
    text += entries(sculpts, examples, sculpts.size(), frame) + "]}";
  }
  text += "\n  ]\n}\n";
  const auto write_motion = [&](const char* name, const std::vector<std::vector<Transform>>& of) {
    Clip clip;
    clip.skeleton = model.skeleton;
    clip.rate = 1;
    clip.resize(static_cast<int>(of.size()));
    for (std::size_t f = 0; f < of.size(); ++f) clip.set_pose(static_cast<int>(f), of[f]);
    return outputs.add((folder / name).string(),
                       [&](OutputFile& file) { return anim::write(clip, {}, file); });
  };
  Status status = write_motion("poses.anim", poses);
  if (status) status = write_motion("show.anim", shown);
  if (status) {
    status = outputs.add((folder / "joints.csv").string(),
                         [&](OutputFile& file) { return file.write(joints); });
  }
  if (status) {
    status = outputs.add(context.output, [&](OutputFile& file) { return file.write(text); });
  }
  if (status) status = outputs.finish();
  if (!status) return status.error();
  context.log(
      fmt::format("{}: {} poses of {} joints", context.output, poses.size() - 1, limbs.size()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  std::string body;
  ToolSpec spec;
  spec.name = "make-sculpts";
  spec.summary = "Generates poses of a body's joints with shapes that keep its volume";
  spec.inputs = "BODY.model";
  spec.examples = {
      {"make-sculpts body.model -o correctives.json",
       "a description for krok-fit; beside it poses.anim and sculpts/*.obj, show.anim with "
       "one more pose of each joint, and joints.csv with the places of the joints"}};
  spec.declare = [&](CommandOptions& command) {
    command.add_option("body IN.model", body, "A body from krok-body").required();
  };
  spec.run = [&](ToolContext& context) { return run(context, body); };
  return run_tool([&spec] { return spec; }, argc, argv);
}

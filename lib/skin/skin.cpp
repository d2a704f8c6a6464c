#include "skin/skin.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <unordered_map>

#include "core/parallel.h"
#include "skin/skin_job_internal.h"

namespace krok::skin_detail {

void over_tiles(Kernel kernel, const Job& job, std::size_t count, int jobs) {
  // A few tiles per thread, to balance load; not more, because each tile restarts the hardware
  // prefetcher. Small meshes run on one thread.
  constexpr std::size_t kMin = 128 * kBlock;
  constexpr std::size_t kTilesAThread = 4;
  const std::size_t threads = static_cast<std::size_t>(thread_count(jobs));
  if (threads == 1 || count <= kMin) return kernel(job, 0, count);
  const std::size_t blocks = count / kBlock / (kTilesAThread * threads);
  parallel_for(count, std::max(kMin, blocks * kBlock), jobs,
               [&](std::size_t begin, std::size_t end) { kernel(job, begin, end); });
}

Run run_from(const Influences& influences, std::size_t begin, std::size_t end) {
  if (influences.blocks == nullptr) {
    return {end, begin * influences.influences, influences.influences};
  }
  const Block& block = influences.blocks[begin / kBlock];
  std::size_t v = begin + kBlock;
  while (v < end && influences.blocks[v / kBlock].influences == block.influences) v += kBlock;
  return {std::min(v, end), block.first, block.influences};
}

namespace {

// Copies items `begin` to `end` of `size` numbers each to `to`, and repeats the last up to kBlock.
template <class T>
const T* padded(const T* from, std::size_t begin, std::size_t end, std::size_t size, T* to) {
  if (from == nullptr) return nullptr;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const T* item = from + std::min(begin + i, end - 1) * size;
    std::copy_n(item, size, to + i * size);
  }
  return to;
}

}  // namespace

Tail::Tail(const Job& job, std::size_t begin, std::size_t end)
    : whole_(job), begin_(begin), count_(end - begin), tail_(job) {
  const Run run = run_from(job.influences, begin, end);
  const auto from = [&](auto* values) { return values == nullptr ? nullptr : values + run.first; };
  tail_.influences.joints = padded(from(job.influences.joints), 0, count_, run.influences, joints_);
  tail_.influences.pairs = padded(from(job.influences.pairs), 0, count_, run.influences, pairs_);
  tail_.influences.weights =
      padded(from(job.influences.weights), 0, count_, run.influences, weights_);
  tail_.influences.influences = run.influences;
  tail_.influences.blocks = nullptr;
  tail_.positions = padded(job.positions, begin, end, 3, positions_);
  tail_.normals = padded(job.normals, begin, end, 3, normals_);
  tail_.tangents = padded(job.tangents, begin, end, 4, tangents_);
  tail_.out_positions = out_positions_;
  tail_.out_normals = out_normals_;
  tail_.out_tangents = out_tangents_;
}

void Tail::copy_back() const {
  std::copy_n(out_positions_, 3 * count_, whole_.out_positions + 3 * begin_);
  if (whole_.normals != nullptr) {
    std::copy_n(out_normals_, 3 * count_, whole_.out_normals + 3 * begin_);
  }
  if (whole_.tangents != nullptr) {
    std::copy_n(out_tangents_, 4 * count_, whole_.out_tangents + 4 * begin_);
  }
}

}  // namespace krok::skin_detail

namespace krok {

namespace {

using skin_detail::Job;

Job job_of(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
           const SkinnedSurface& out) {
  [[maybe_unused]] const std::size_t count = binding.vertex_count();
  assert(pose.data().binding == &binding.data());
  assert(in.positions.size() == count && out.positions.size() == count);
  assert(in.normals.empty() || in.normals.size() == count);
  assert(in.tangents.empty() || in.tangents.size() == count);
  assert(out.normals.size() == in.normals.size() && out.tangents.size() == in.tangents.size());
  const auto floats = [](auto span) { return span.empty() ? nullptr : span.data()->data(); };
  const skin_detail::Posed& posed = pose.data();
  Job job;
  job.influences = binding.data().influences();
  const bool by_motions = skin_detail::blends_motions(binding.method());
  if (by_motions) job.motions = posed.pair_motions.data();
  if (!posed.pair_centres.empty()) job.centres = posed.pair_centres.data();
  if (!by_motions || !posed.is_rigid) job.palette = posed.palette.data();
  job.inverse_transpose = !posed.is_rigid;
  job.positions = floats(in.positions);
  job.normals = floats(in.normals);
  job.tangents = floats(in.tangents);
  job.out_positions = floats(out.positions);
  job.out_normals = floats(out.normals);
  job.out_tangents = floats(out.tangents);
  return job;
}

}  // namespace

SkinSurface skin_surface(const Model& model) {
  return {model.positions, model.normals, model.tangents};
}

void skin(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
          const SkinnedSurface& out, int jobs) {
  const auto kernel =
      binding.method() == SkinMethod::dual_quaternion ? skin_detail::dual_quaternion_simd
      : binding.method() == SkinMethod::spherical     ? skin_detail::dual_quaternion_scalar
                                                      : skin_detail::linear_simd;
  skin_detail::over_tiles(kernel, job_of(binding, pose, in, out), binding.vertex_count(), jobs);
}

void skin_reference(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                    const SkinnedSurface& out) {
  const auto reference = skin_detail::blends_motions(binding.method())
                             ? skin_detail::dual_quaternion_scalar
                             : skin_detail::linear_scalar;
  reference(job_of(binding, pose, in, out), 0, binding.vertex_count());
}

namespace skin_detail {

namespace {

// The influences of one vertex with non-zero weight.
struct VertexInfluences {
  std::array<std::uint16_t, Model::kMaxInfluences> joints;
  std::array<float, Model::kMaxInfluences> weights;
  std::size_t count = 0;
};

VertexInfluences influences_of(const Model& model, std::size_t v, SkinMethod method) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  const std::uint16_t* joints = &model.influence_joints[v * places];
  const float* weights = &model.influence_weights[v * places];
  VertexInfluences result;
  for (std::size_t k = 0; k < places; ++k) {
    if (!(weights[k] > 0)) continue;
    result.joints[result.count] = joints[k];
    result.weights[result.count] = weights[k];
    ++result.count;
  }
  if (result.count == 0) {
    result.joints[0] = joints[0];
  } else if (method == SkinMethod::rigid) {
    const auto end = result.weights.begin() + static_cast<std::ptrdiff_t>(result.count);
    const auto strongest = std::max_element(result.weights.begin(), end);
    result.joints[0] = result.joints[static_cast<std::size_t>(strongest - result.weights.begin())];
  }
  if (result.count == 0 || method == SkinMethod::rigid) {
    result.weights[0] = 1.0f;
    result.count = 1;
  }
  return result;
}

// Numbers pairs in order of first use.
class PairNumbers {
 public:
  explicit PairNumbers(std::vector<Pair>& pairs) : pairs_(pairs) {}

  std::uint32_t number(std::uint16_t first, std::uint16_t joint) {
    const std::uint32_t key = std::uint32_t{first} << 16 | joint;
    const auto [found, is_new] = numbers_.emplace(key, static_cast<std::uint32_t>(pairs_.size()));
    if (is_new) pairs_.push_back({first, joint});
    return found->second;
  }

 private:
  std::vector<Pair>& pairs_;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
};

std::unique_ptr<const Binding> bind(const Model& model, SkinMethod method) {
  auto binding = std::make_unique<Binding>();
  binding->method = method;
  binding->vertex_count = model.positions.size();
  binding->joint_to_world = model.skeleton.reference;
  binding->reference_to_joint = inverse_reference(model.skeleton);
  PairNumbers numbers(binding->pairs);
  SetNumbers sets(*binding);
  std::array<VertexInfluences, kBlock> block;
  for (std::size_t begin = 0; begin < binding->vertex_count; begin += kBlock) {
    const std::size_t size = std::min(kBlock, binding->vertex_count - begin);
    std::size_t most = 0;
    for (std::size_t i = 0; i < size; ++i) {
      block[i] = influences_of(model, begin + i, method);
      most = std::max(most, block[i].count);
    }
    binding->blocks.push_back({binding->joints.size(), most});
    for (std::size_t i = 0; i < size; ++i) {
      const VertexInfluences& vertex = block[i];
      std::uint32_t set = 0;
      if (method == SkinMethod::spherical) {
        const auto* joints = vertex.joints.data();
        set = sets.set({joints, joints + std::max<std::size_t>(1, vertex.count)});
      }
      for (std::size_t k = 0; k < most; ++k) {
        // Padding repeats the first joint with weight 0, which does not change the result.
        const std::uint16_t joint = vertex.joints[k < vertex.count ? k : 0];
        binding->joints.push_back(joint);
        binding->weights.push_back(k < vertex.count ? vertex.weights[k] : 0.0f);
        if (method == SkinMethod::dual_quaternion) {
          binding->pair_indices.push_back(numbers.number(vertex.joints[0], joint));
        }
        if (method == SkinMethod::spherical) {
          binding->pair_indices.push_back(sets.pair(set, joint));
        }
      }
    }
  }
  return binding;
}

}  // namespace

Influences Binding::influences() const {
  Influences result;
  result.joints = joints.data();
  result.pairs = pair_indices.empty() ? nullptr : pair_indices.data();
  result.weights = weights.data();
  result.blocks = blocks.data();
  return result;
}

}  // namespace skin_detail

SkinBinding::SkinBinding(const Model& model, SkinMethod method)
    : data_(skin_detail::bind(model, method)) {}
SkinBinding::SkinBinding(SkinBinding&&) noexcept = default;
SkinBinding& SkinBinding::operator=(SkinBinding&&) noexcept = default;
SkinBinding::~SkinBinding() = default;

SkinMethod SkinBinding::method() const {
  return data_->method;
}
std::size_t SkinBinding::vertex_count() const {
  return data_->vertex_count;
}
std::size_t SkinBinding::joint_count() const {
  return data_->reference_to_joint.size();
}

namespace {

using skin_detail::Posed;

float real_dot(const DualQuaternion& a, const DualQuaternion& b) {
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += a.components[i] * b.components[i];
  return sum;
}

// Hemisphere test: negates each pair's quaternion if it opposes that of the first joint.
void fill_pairs(Posed& pose) {
  for (std::size_t i = 0; i < pose.pair_motions.size(); ++i) {
    const skin_detail::Pair pair = pose.binding->pairs[i];
    DualQuaternion& motion = pose.pair_motions[i];
    motion = pose.motions[pair.joint];
    if (real_dot(pose.motions[pair.first], motion) < 0) {
      for (float& component : motion.components) component = -component;
    }
  }
  if (!pose.pair_centres.empty()) skin_detail::fill_centres(pose);
}

}  // namespace

SkinPose::SkinPose(const SkinBinding& binding) : data_(std::make_unique<Posed>()) {
  data_->binding = &binding.data();
  data_->palette.resize(binding.joint_count());
  if (skin_detail::blends_motions(binding.method())) {
    data_->motions.resize(binding.joint_count());
    data_->pair_motions.resize(binding.data().pairs.size());
    data_->set_centres.resize(binding.data().sets.size());
    data_->pair_centres.resize(binding.data().pair_sets.size());
  }
  set(binding.data().joint_to_world);
}
SkinPose::SkinPose(SkinPose&&) noexcept = default;
SkinPose& SkinPose::operator=(SkinPose&&) noexcept = default;
SkinPose::~SkinPose() = default;

void SkinPose::set(std::span<const Transform> joint_to_world) {
  const auto& reference_to_joint = data_->binding->reference_to_joint;
  assert(joint_to_world.size() == reference_to_joint.size());
  data_->is_rigid = true;
  if (data_->motions.empty()) {
    make_palette(reference_to_joint, joint_to_world, data_->palette);
    return;
  }
  for (std::size_t j = 0; j < joint_to_world.size(); ++j) {
    data_->motions[j] = dual_quaternion(joint_to_world[j] * reference_to_joint[j]);
  }
  fill_pairs(*data_);
}

template <typename MatrixOf>
void SkinPose::set_matrices(const MatrixOf& matrix_of) {
  data_->is_rigid = true;
  for (std::size_t j = 0; j < data_->palette.size(); ++j) {
    const SkinMatrix matrix = matrix_of(j);
    data_->is_rigid = data_->is_rigid && is_rigid(matrix);
    if (data_->motions.empty()) {
      data_->palette[j] = matrix;
      continue;
    }
    const auto parts = split(matrix, data_->binding->joint_to_world[j].position);
    data_->motions[j] = parts.motion;
    data_->palette[j] = parts.deformation;
  }
  if (!data_->motions.empty()) fill_pairs(*data_);
}

void SkinPose::set_palette(std::span<const SkinMatrix> palette) {
  assert(palette.size() == data_->palette.size());
  set_matrices([&](std::size_t j) { return palette[j]; });
}

void SkinPose::set(std::span<const Transform> joint_to_world, std::span<const Stretch> stretches) {
  if (stretches.empty()) {
    set(joint_to_world);
    return;
  }
  const auto& reference_to_joint = data_->binding->reference_to_joint;
  assert(joint_to_world.size() == reference_to_joint.size());
  assert(stretches.size() == joint_to_world.size());
  set_matrices([&](std::size_t j) {
    return skin_matrix(reference_to_joint[j], joint_to_world[j], stretches[j]);
  });
}

}  // namespace krok

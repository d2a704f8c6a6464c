// Skinning of positions and normals beside plain C++ of the same mathematics, compiled in this
// program with the same flags: a kernel of Eigen's vectors that blends the four columns of the
// palette's matrices, and the textbook's loop, which moves a vertex by one matrix after the other
// and sums. Neither brings normals to length 1, which the kernels do. The copy is one memcpy that
// reads and writes as many bytes, together, as skinning does.
//
// Rounds of all of them take turns and the fastest of each counts; what is printed are ratios,
// which compare across machines, times of this one, and a hash of the results. All but the last
// two lines is one thread's; those need two idle cores.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/simd.h"
#include "math/quaternion.h"
#include "skin/skin.h"

namespace {

using namespace krok;

constexpr int kJoints = 64;

// Vertices near each other hang on the same joints, as in a character; all weights count.
Model make_model(std::size_t vertices, int influences) {
  std::mt19937 random(7);
  const auto unit = [&] { return static_cast<float>(random() % 20001) / 10000.0f - 1.0f; };
  Model model;
  for (int j = 0; j < kJoints; ++j) {
    const Transform joint{Vec3(unit(), 1 + unit(), unit()),
                          from_rotation_vector(Vec3(unit(), unit(), unit()))};
    model.skeleton.add("joint" + std::to_string(j), j - 1, joint);
  }
  model.influences_per_vertex = influences;
  for (std::size_t v = 0; v < vertices; ++v) {
    model.positions.emplace_back(unit(), 1 + unit(), unit());
    model.normals.emplace_back(Vec3f(unit(), unit(), 1.5f).normalized());
    float sum = 0;
    for (int k = 0; k < influences; ++k) {
      const auto joint = (v / 200 + 7 * static_cast<std::size_t>(k)) % kJoints;
      model.influence_joints.push_back(static_cast<std::uint16_t>(joint));
      model.influence_weights.push_back(1.01f + unit());
      sum += model.influence_weights.back();
    }
    float* weights = &model.influence_weights[v * static_cast<std::size_t>(influences)];
    for (int k = 0; k < influences; ++k) weights[k] /= sum;
    std::sort(weights, weights + influences, std::greater<>());
  }
  return model;
}

// A mesh, a pose of it, and where it goes.
struct Scene {
  Model model;
  SkinBinding linear, dual;
  SkinPose linear_pose, dual_pose;
  std::vector<SkinMatrix> palette;
  std::vector<Vec3f> positions, normals, plain_positions, plain_normals;
  std::vector<std::byte> from, to;

  Scene(std::size_t vertices, int influences)
      : model(make_model(vertices, influences)),
        linear(model, SkinMethod::linear),
        dual(model, SkinMethod::dual_quaternion),
        linear_pose(linear),
        dual_pose(dual),
        palette(kJoints),
        positions(vertices),
        normals(vertices),
        plain_positions(vertices),
        plain_normals(vertices) {
    std::vector<Transform> pose = model.skeleton.reference;
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const double angle = 0.02 * static_cast<double>(j);
      pose[j] = Transform{Vec3(0, 0.01, 0.1), from_rotation_vector(Vec3(angle, 0.3, 0))} * pose[j];
    }
    make_palette(inverse_reference(model.skeleton), pose, palette);
    linear_pose.set(pose);
    dual_pose.set(pose);
    // Two vectors, and a joint and a weight for each influence, come in; two vectors go out.
    const std::size_t bytes = 4 * sizeof(Vec3f) + static_cast<std::size_t>(influences) *
                                                      (sizeof(std::uint16_t) + sizeof(float));
    from.assign(vertices * bytes / 2, std::byte{1});
    to = from;
  }

  SkinnedSurface out() { return {positions, normals, {}}; }
};

template <std::size_t kInfluences>
void eigen_columns(Scene& scene) {
  for (std::size_t v = 0; v < scene.model.positions.size(); ++v) {
    const std::uint16_t* joints = &scene.model.influence_joints[v * kInfluences];
    const float* weights = &scene.model.influence_weights[v * kInfluences];
    const auto column = [&](std::size_t k, int c) {
      return Eigen::Map<const Vec4f, Eigen::Aligned16>(scene.palette[joints[k]].elements +
                                                       std::ptrdiff_t{4} * c);
    };
    Vec4f x = weights[0] * column(0, 0), y = weights[0] * column(0, 1);
    Vec4f z = weights[0] * column(0, 2), origin = weights[0] * column(0, 3);
    for (std::size_t k = 1; k < kInfluences; ++k) {
      x += weights[k] * column(k, 0);
      y += weights[k] * column(k, 1);
      z += weights[k] * column(k, 2);
      origin += weights[k] * column(k, 3);
    }
    const Vec3f& p = scene.model.positions[v];
    const Vec3f& n = scene.model.normals[v];
    scene.plain_positions[v] = (x * p.x() + y * p.y() + z * p.z() + origin).head<3>();
    scene.plain_normals[v] = (x * n.x() + y * n.y() + z * n.z()).head<3>();
  }
}

template <std::size_t kInfluences>
void textbook(Scene& scene) {
  for (std::size_t v = 0; v < scene.model.positions.size(); ++v) {
    const Vec3f& p = scene.model.positions[v];
    const Vec3f& n = scene.model.normals[v];
    float position[3] = {}, normal[3] = {};
    for (std::size_t k = 0; k < kInfluences; ++k) {
      const float weight = scene.model.influence_weights[v * kInfluences + k];
      const float* m = scene.palette[scene.model.influence_joints[v * kInfluences + k]].elements;
      for (int i = 0; i < 3; ++i) {
        position[i] += weight * (m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i]);
        normal[i] += weight * (m[i] * n[0] + m[4 + i] * n[1] + m[8 + i] * n[2]);
      }
    }
    scene.plain_positions[v] = Vec3f(position[0], position[1], position[2]);
    scene.plain_normals[v] = Vec3f(normal[0], normal[1], normal[2]);
  }
}

void linear(Scene& scene, int jobs = 1) {
  skin(scene.linear, scene.linear_pose, skin_surface(scene.model), scene.out(), jobs);
}
void dual(Scene& scene) {
  skin(scene.dual, scene.dual_pose, skin_surface(scene.model), scene.out());
}
void copy(Scene& scene) {
  std::memcpy(scene.to.data(), scene.from.data(), scene.from.size());
  asm volatile("" ::"r"(scene.to.data()) : "memory");
}

double seconds_of(const std::function<void()>& run) {
  const auto begin = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// The fastest of each, of rounds in turn, so that what slows the machine for a while slows all.
std::vector<double> fastest(const std::vector<std::function<void()>>& runs, int rounds) {
  std::vector<double> best(runs.size(), 1e9);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < runs.size(); ++i) best[i] = std::min(best[i], seconds_of(runs[i]));
  }
  return best;
}

double largest_difference(const Scene& scene) {
  float largest = 0;
  for (std::size_t v = 0; v < scene.positions.size(); ++v) {
    largest = std::max(largest, (scene.positions[v] - scene.plain_positions[v]).norm());
    largest = std::max(largest, (scene.normals[v] - scene.plain_normals[v].normalized()).norm());
  }
  return largest;
}

template <std::size_t kInfluences>
void compare(std::size_t vertices, int rounds) {
  Scene scene(vertices, kInfluences);
  const auto times =
      fastest({[&] { eigen_columns<kInfluences>(scene); }, [&] { textbook<kInfluences>(scene); },
               [&] { copy(scene); }, [&] { dual(scene); }, [&] { linear(scene); }},
              rounds);
  const auto count = static_cast<double>(vertices);
  std::printf("%zu vertices, %zu influences\n", vertices, kInfluences);
  std::printf(
      "  ns a vertex: Eigen's columns %.2f, textbook %.2f, copy %.2f, linear %.2f, "
      "dual quaternion %.2f\n",
      times[0] / count * 1e9, times[1] / count * 1e9, times[2] / count * 1e9,
      times[4] / count * 1e9, times[3] / count * 1e9);
  std::printf(
      "  Eigen's columns / linear %.2f, textbook / linear %.2f, linear / copy %.2f, dual "
      "quaternion / linear %.2f\n",
      times[0] / times[4], times[1] / times[4], times[4] / times[2], times[3] / times[4]);
  std::printf("  largest difference from the plain ones %.1e, hash of positions %s\n",
              largest_difference(scene),
              hex(xxh3(std::as_bytes(std::span(scene.positions)))).c_str());
}

void compare_avx2() {
  if (limit_simd(Simd::avx512) != Simd::avx512) return;
  Scene scene(100'000, 4);
  limit_simd(Simd::avx2);
  const auto times = fastest(
      {[&] { eigen_columns<4>(scene); }, [&] { dual(scene); }, [&] { linear(scene); }}, 100);
  limit_simd(Simd::avx512);
  std::printf(
      "with AVX2, 100000 vertices, 4 influences: Eigen's columns / linear %.2f, dual "
      "quaternion / linear %.2f, hash %s\n",
      times[0] / times[2], times[1] / times[2],
      hex(xxh3(std::as_bytes(std::span(scene.positions)))).c_str());
}

void compare_threads(std::size_t vertices) {
  Scene scene(vertices, 4);
  const auto times =
      fastest({[&] { linear(scene, 1); }, [&] { linear(scene, 2); }}, 20'000'000 / vertices);
  std::printf("%zu vertices, 4 influences: one thread / two %.2f\n", vertices, times[0] / times[1]);
}

}  // namespace

int main() {
  compare<1>(100'000, 200);
  compare<2>(100'000, 200);
  compare<4>(100'000, 300);
  compare<8>(100'000, 100);
  compare<4>(1'000'000, 30);
  compare_avx2();
  compare_threads(100'000);
  compare_threads(1'000'000);
  return 0;
}

// Linear blend skinning of a mesh of 10,000 vertices, positions and normals: the scalar reference,
// the SIMD kernel, and as a floor a plain copy of the bytes that skinning reads and writes. At the
// end it prints ratios, which compare across machines, and a hash of the result, which must be the
// same on all.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <map>

#include "core/hash.h"
#include "skin/linear_blend.h"
#include "support/test_scenes.h"

namespace {

using namespace krok;

struct Scene {
  Model model;
  std::vector<SkinMatrix> palette;
  std::vector<Vec3f> positions, normals;

  Scene() {
    const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
    model = test::tube_model(skeleton, 4, 24, 16);
    const Clip clip = test::swinging_clip(skeleton, 8, 10);
    std::vector<Transform> pose(skeleton.names.size());
    clip.get_pose(5, pose);
    palette.resize(pose.size());
    make_palette(inverse_reference(skeleton), pose, palette);
    positions.resize(model.positions.size());
    normals.resize(model.normals.size());
  }
};

Scene& scene() {
  static Scene instance;
  return instance;
}

void scalar(benchmark::State& state) {
  for (auto _ : state) {
    linear_blend_reference(scene().palette, skin_vertices(scene().model),
                           {scene().positions, scene().normals});
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * scene().model.vertex_count());
}

void simd(benchmark::State& state) {
  for (auto _ : state) {
    linear_blend(scene().palette, skin_vertices(scene().model),
                 {scene().positions, scene().normals});
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * scene().model.vertex_count());
}

// What skinning reads (two vectors, four joints and weights) copied; it writes half of that.
void copy(benchmark::State& state) {
  const auto count = scene().model.positions.size();
  const std::size_t bytes =
      count * (2 * sizeof(Vec3f) + 4 * (sizeof(std::uint16_t) + sizeof(float)));
  std::vector<std::byte> from(bytes, std::byte{1}), to(bytes);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

BENCHMARK(scalar);
BENCHMARK(simd);
BENCHMARK(copy);

// The usual output, and the times kept.
class Keeper : public benchmark::ConsoleReporter {
 public:
  std::map<std::string, double> times;
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) times[run.benchmark_name()] = run.GetAdjustedCPUTime();
    ConsoleReporter::ReportRuns(runs);
  }
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  Keeper keeper;
  benchmark::RunSpecifiedBenchmarks(&keeper);
  auto& times = keeper.times;
  if (times.count("simd") != 0 && times["simd"] > 0) {
    std::printf("scalar / simd: %.1f\n", times["scalar"] / times["simd"]);
    std::printf("simd / copy of its input: %.1f\n", times["simd"] / times["copy"]);
  }
  linear_blend(scene().palette, skin_vertices(scene().model), {scene().positions, scene().normals});
  std::printf("hash of %d skinned positions: %s\n", scene().model.vertex_count(),
              hex(xxh3(std::as_bytes(std::span(scene().positions)))).c_str());
  return 0;
}

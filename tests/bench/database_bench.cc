// Time and memory of opening and checking a generated database.
//   database_bench --benchmark_filter=... ; PALPATE_BENCH_RINGS sets the size: 2 r^2
// nodes with 32 samples each (707: a million; writing it takes about 8 GB).
#include <cstdlib>
#include <filesystem>

#include <benchmark/benchmark.h>

#include "formats/database/chunk_reader.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

const std::filesystem::path& generated_file() {
  static const ScratchFolder folder;
  static const std::filesystem::path file = [] {
    const char* rings = std::getenv("PALPATE_BENCH_RINGS");
    const std::filesystem::path path = folder / "sphere.h5";
    write_database(path,
                   sphere_database(rings == nullptr ? 100 : std::atoi(rings), 32));
    return path;
  }();
  return file;
}

void BM_OpenIndex(benchmark::State& state) {
  const std::filesystem::path& file = generated_file();
  DatabaseIndex index;
  for ([[maybe_unused]] auto _ : state) {
    index = read_index(file);
  }
  state.counters["nodes"] = static_cast<double>(index.nodes());
  state.counters["file_bytes"] = static_cast<double>(index.bytes);
}
BENCHMARK(BM_OpenIndex)->Unit(benchmark::kMillisecond);

void BM_ReadChunk(benchmark::State& state) {
  const ChunkReader reader(generated_file());
  std::int64_t chunk = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(reader.body(chunk));
    benchmark::DoNotOptimize(reader.responses(0, chunk));
    chunk = (chunk + 1) % reader.index().chunks();
  }
}
BENCHMARK(BM_ReadChunk)->Unit(benchmark::kMillisecond);

void BM_ReadAndCheckAll(benchmark::State& state) {
  const std::filesystem::path& file = generated_file();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(read_database(file));
  }
}
BENCHMARK(BM_ReadAndCheckAll)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate

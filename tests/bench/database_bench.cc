// Time of opening and checking a database in both forms: HDF5 and flat.
//   database_bench --benchmark_filter=... ; PALPATE_BENCH_RINGS sets the size of a
// generated one: 2 r^2 nodes with 32 samples each (707: a million; writing it takes
// about 8 GB). PALPATE_BENCH_DATABASE names another one instead.
#include <cstdlib>
#include <filesystem>

#include <benchmark/benchmark.h>

#include "formats/database/chunk_reader.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

ResponseDatabase measured_database() {
  if (const char* file = std::getenv("PALPATE_BENCH_DATABASE")) {
    return read_database(file);
  }
  const char* rings = std::getenv("PALPATE_BENCH_RINGS");
  return sphere_database(rings == nullptr ? 100 : std::atoi(rings), 32);
}

// Of a form, written once.
std::filesystem::path file_of(StoredForm form) {
  static const ScratchFolder folder;
  const std::filesystem::path file =
      folder / (form == StoredForm::kFlat ? "a.palpate" : "a.h5");
  if (!std::filesystem::exists(file)) {
    write_database(file, measured_database(), form);
  }
  return file;
}

void BM_OpenIndex(benchmark::State& state, StoredForm form) {
  const std::filesystem::path file = file_of(form);
  DatabaseIndex index;
  for ([[maybe_unused]] auto _ : state) {
    index = read_index(file);
  }
  state.counters["nodes"] = static_cast<double>(index.nodes());
  state.counters["file_bytes"] = static_cast<double>(index.bytes);
}

void BM_ReadChunk(benchmark::State& state, StoredForm form) {
  const ChunkReader reader(file_of(form));
  std::int64_t chunk = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(reader.body(chunk));
    benchmark::DoNotOptimize(reader.responses(0, chunk));
    chunk = (chunk + 1) % reader.index().chunks();
  }
}

void BM_ReadAndCheckAll(benchmark::State& state, StoredForm form) {
  const std::filesystem::path file = file_of(form);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(read_database(file));
  }
}

#define IN_BOTH_FORMS(measured)                                                        \
  BENCHMARK_CAPTURE(measured, hdf5, StoredForm::kHdf5)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(measured, flat, StoredForm::kFlat)->Unit(benchmark::kMillisecond)

IN_BOTH_FORMS(BM_OpenIndex);
IN_BOTH_FORMS(BM_ReadChunk);
IN_BOTH_FORMS(BM_ReadAndCheckAll);

#undef IN_BOTH_FORMS

}  // namespace
}  // namespace palpate

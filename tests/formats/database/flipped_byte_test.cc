// Single-byte damage inside the data of a database is always noticed.
#include <array>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "formats/response/memory_sites.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

struct Range {
  std::size_t begin;
  std::size_t bytes;
};

// Places of the raw bytes of every dataset: contiguous ones whole, compressed ones by
// their pieces.
void add_ranges(hid_t dataset, std::vector<Range>& ranges) {
  const haddr_t at = H5Dget_offset(dataset);
  if (at != HADDR_UNDEF) {
    ranges.push_back({at, H5Dget_storage_size(dataset)});
    return;
  }
  hsize_t pieces = 0;
  const hid_t space = H5Dget_space(dataset);
  H5Dget_num_chunks(dataset, space, &pieces);
  for (hsize_t i = 0; i < pieces; ++i) {
    std::array<hsize_t, 3> offset{};
    unsigned mask = 0;
    haddr_t address = 0;
    hsize_t size = 0;
    H5Dget_chunk_info(dataset, space, i, offset.data(), &mask, &address, &size);
    ranges.push_back({address, size});
  }
  H5Sclose(space);
}

std::vector<Range> data_of(const std::filesystem::path& file) {
  std::vector<Range> ranges;
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  H5Ovisit2(
      id, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t object, const char* name, const H5O_info_t* info, void* to) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) {
          const hid_t dataset = H5Dopen2(object, name, H5P_DEFAULT);
          add_ranges(dataset, *static_cast<std::vector<Range>*>(to));
          H5Dclose(dataset);
        }
        return 0;
      },
      &ranges, H5O_INFO_BASIC);
  H5Fclose(id);
  return ranges;
}

class FlippedByte : public testing::TestWithParam<StorageOptions> {};

TEST_P(FlippedByte, InsideDataIsRefused) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  ResponseDatabase database = sphere_database(5, 9);
  database.storage = GetParam();
  Viscoelasticity& relaxation = database.tools[0].viscoelasticity;
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  relaxation.tau_s = {0.5, 4.0};
  relaxation.speed_m_per_s = 1e-3;
  relaxation.g.setConstant(database.body.position_m.rows(), 2, 0.2F);
  relaxation.error_relative.assign(n, 0.01F);
  relaxation.sites =
      place_sites(database.body, database.normal, std::vector<bool>(n, true), 0.03);
  database.tools[0].puncture = some_puncture(database.body.position_m.rows());
  write_database(file, database);
  const std::vector<Range> ranges = data_of(file);
  std::string whole;
  {
    std::ifstream in(file, std::ios::binary);
    whole.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::vector<std::size_t> places;
  for (const Range& range : ranges) {
    for (std::size_t i = 0; i < range.bytes; ++i) {
      places.push_back(range.begin + i);
    }
  }
  ASSERT_GT(places.size(), whole.size() / 3);
  std::mt19937 random(13);
  std::uniform_int_distribution<std::size_t> place(0, places.size() - 1);
  std::uniform_int_distribution<int> change(1, 255);
  constexpr int kFlips = 500;
  int noticed = 0;
  for (int i = 0; i < kFlips; ++i) {
    const std::size_t at = places[place(random)];
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ change(random));
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      (void)read_database(file);
    } catch (const FormatError&) {
      ++noticed;
    }
  }
  std::printf("%d of %d changed bytes inside data noticed: %.2f %%\n", noticed, kFlips,
              100.0 * noticed / kFlips);
  EXPECT_GE(noticed, kFlips * 999 / 1000);
}

INSTANTIATE_TEST_SUITE_P(Storage, FlippedByte,
                         testing::Values(StorageOptions{},
                                         StorageOptions{Precision::kInt16, true, 64}),
                         [](const auto& storage) {
                           return fmt::format("{}{}", name_of(storage.param.precision),
                                              storage.param.compress ? "deflated" : "");
                         });

}  // namespace
}  // namespace palpate

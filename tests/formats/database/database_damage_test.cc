// A database file that is damaged, foreign or hostile is refused with one line, and
// never read wrongly.
#include <fstream>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

void put_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

// What reading a file says: "read", or the FormatError's text.
std::string outcome(const std::filesystem::path& file) {
  try {
    (void)read_database(file);
    return "read";
  } catch (const FormatError& error) {
    return error.what();
  }
}

class DatabaseDamage : public testing::Test {
 protected:
  DatabaseDamage() { write_database(file_, small_database()); }

  // The outcome after an edit through HDF5 itself, which keeps its checksums right.
  std::string after(const std::function<void(hid_t)>& edit) {
    write_database(file_, small_database());
    const hid_t id = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    edit(id);
    H5Fclose(id);
    const std::string what = outcome(file_);
    EXPECT_EQ(what.rfind(file_.string() + ": ", 0), 0u) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }

  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "a.h5";
};

void delete_link(hid_t file, const char* path) {
  H5Ldelete(file, path, H5P_DEFAULT);
}

void set_text(hid_t file, const char* object, const char* name,
              const std::string& value) {
  if (H5Aexists_by_name(file, object, name, H5P_DEFAULT) > 0) {
    H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  }
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, value.size());
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate_by_name(file, object, name, type, space,
                                            H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, type, value.data());
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
}

void set_version(hid_t file, std::int64_t version) {
  const hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_INT64, &version);
  H5Aclose(attribute);
}

// Replaces a dataset by one of another type, shape or layout, with its unit.
void replace(hid_t file, const char* path, hid_t type, std::vector<hsize_t> shape,
             const std::string& unit, hsize_t chunk = 0) {
  delete_link(file, path);
  const hid_t space =
      H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  if (chunk > 0) {
    H5Pset_chunk(create, 1, &chunk);
    H5Pset_fletcher32(create);
  }
  const hid_t dataset =
      H5Dcreate2(file, path, type, space, H5P_DEFAULT, create, H5P_DEFAULT);
  H5Dclose(dataset);
  H5Pclose(create);
  H5Sclose(space);
  set_text(file, path, "units", unit);
}

void set_first(hid_t file, const char* path, double value) {
  const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
  const hsize_t first = 0;
  const hsize_t one = 1;
  const hid_t there = H5Dget_space(dataset);
  const hid_t here = H5Screate_simple(1, &one, nullptr);
  H5Sselect_hyperslab(there, H5S_SELECT_SET, &first, nullptr, &one, nullptr);
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, here, there, H5P_DEFAULT, &value);
  H5Sclose(here);
  H5Sclose(there);
  H5Dclose(dataset);
}

#define EXPECT_SAYS(what, text) \
  EXPECT_NE((what).find(text), std::string::npos) << (what)

// Links lead to files that nobody named, or to a pipe that nobody fills.
TEST_F(DatabaseDamage, SoftAndExternalLinksAreNotFollowed) {
  const ScratchFolder other;
  write_database(other / "b.h5", small_database());
  ASSERT_EQ(::mkfifo((other / "pipe").c_str(), 0600), 0);
  for (const char* target : {"b.h5", "pipe"}) {
    for (const char* path : {"/body", "/body/position_m", "/tools/ball/force_n"}) {
      const std::string what = after([&](hid_t file) {
        delete_link(file, path);
        H5Lcreate_external((other / target).c_str(), path, file, path, H5P_DEFAULT,
                           H5P_DEFAULT);
      });
      EXPECT_SAYS(what, "behind a soft or external link");
    }
  }
  EXPECT_SAYS(after([](hid_t file) {
                delete_link(file, "/tools/ball/force_n");
                H5Lcreate_soft("/tools/tip/force_n", file, "/tools/ball/force_n",
                               H5P_DEFAULT, H5P_DEFAULT);
              }),
              "behind a soft or external link");
}

// A file of some kilobytes that says it holds megabytes: nothing is asked of memory.
TEST_F(DatabaseDamage, WhatWasNeverWrittenIsNotRead) {
  const std::string what = after([&](hid_t file) {
    constexpr hsize_t kRows = 1'000'000;
    delete_link(file, "/body/position_m");
    const std::array<hsize_t, 2> size{kRows, 3};
    const std::array<hsize_t, 2> chunk{100'000, 3};
    const hid_t space = H5Screate_simple(2, size.data(), nullptr);
    const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(create, 2, chunk.data());
    H5Pset_deflate(create, 6);
    const hid_t dataset = H5Dcreate2(file, "/body/position_m", H5T_IEEE_F64LE, space,
                                     H5P_DEFAULT, create, H5P_DEFAULT);
    H5Dclose(dataset);
    H5Pclose(create);
    H5Sclose(space);
    set_text(file, "/body/position_m", "units", "m");
  });
  EXPECT_SAYS(what, "never written");
}

// The same with a hole of 64 GB at the file's end, so that its length would allow it.
TEST_F(DatabaseDamage, AHoleInTheFileDoesNotMakeItLarge) {
  const hid_t id = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_alloc_time(create, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(create, H5D_FILL_TIME_NEVER);
  const std::array<hsize_t, 2> size{2'000'000'000, 3};
  const hid_t space = H5Screate_simple(2, size.data(), nullptr);
  delete_link(id, "/body/position_m");
  const hid_t dataset = H5Dcreate2(id, "/body/position_m", H5T_IEEE_F64LE, space,
                                   H5P_DEFAULT, create, H5P_DEFAULT);
  H5Dclose(dataset);
  set_text(id, "/body/position_m", "units", "m");
  H5Pclose(create);
  H5Sclose(space);
  H5Fclose(id);
  EXPECT_SAYS(outcome(file_), "more than a file of");
}

TEST_F(DatabaseDamage, APipeIsNotWaitedFor) {
  const std::filesystem::path pipe = folder_ / "pipe.h5";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW((void)read_database(pipe), InputError);
}

TEST_F(DatabaseDamage, ATruncatedFileIsRefusedAtEveryLength) {
  const std::string whole = bytes_of(file_);
  for (std::size_t length = 0; length < whole.size();
       length += length < 4096 ? 37 : 211) {
    put_bytes(file_, whole.substr(0, length));
    const std::string what = outcome(file_);
    ASSERT_NE(what, "read") << length;
    ASSERT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST_F(DatabaseDamage, AFlippedByteIsRefusedOrChangesNothing) {
  const std::string whole = bytes_of(file_);
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> place(0, whole.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7);
  int refused = 0;
  constexpr int kFlips = 400;
  for (int i = 0; i < kFlips; ++i) {
    std::string bytes = whole;
    const std::size_t at = place(random);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit(random)));
    put_bytes(file_, bytes);
    const std::string what = outcome(file_);
    if (what == "read") {
      write_database(folder_ / "again.h5", read_database(file_));
      ASSERT_EQ(bytes_of(folder_ / "again.h5"), whole) << "byte " << at;
    } else {
      ++refused;
    }
  }
  // Some bytes pad between datasets and mean nothing; most do mean something.
  EXPECT_GT(refused, kFlips * 3 / 4);
}

TEST_F(DatabaseDamage, OverwrittenPiecesAreRefusedOrChangeNothing) {
  const std::string whole = bytes_of(file_);
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> place(0, whole.size() - 64);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = whole;
    const std::size_t at = place(random);
    for (std::size_t k = 0; k < 64; ++k) {
      bytes[at + k] = static_cast<char>(i % 2 == 0 ? byte(random) : 0xff);
    }
    put_bytes(file_, bytes);
    if (outcome(file_) == "read") {
      write_database(folder_ / "again.h5", read_database(file_));
      ASSERT_EQ(bytes_of(folder_ / "again.h5"), whole) << "byte " << at;
    }
  }
}

TEST_F(DatabaseDamage, AnythingButAnHdf5FileIsForeign) {
  put_bytes(file_, "solid cube\n");
  EXPECT_SAYS(outcome(file_), "is not an HDF5 file (11 bytes)");
  put_bytes(file_, "");
  EXPECT_SAYS(outcome(file_), "is not an HDF5 file (0 bytes)");
}

TEST_F(DatabaseDamage, AnHdf5FileOfAnotherKindIsForeign) {
  AtomicFile empty(file_);
  StoredWriter nothing = make_writer(StoredForm::kHdf5);
  empty.write(nothing.image());
  empty.commit();
  EXPECT_SAYS(outcome(file_), "is an HDF5 file of another kind");
  EXPECT_SAYS(after([](hid_t file) {
                set_text(file, "/", "format", "something else");
              }),
              "/@format is \"something else\"");
}

TEST_F(DatabaseDamage, ANewerMajorVersionIsRefused) {
  EXPECT_SAYS(after([](hid_t file) {
                set_version(file, 3);
              }),
              "has format version 3, this program reads 2; use a newer one");
}

TEST_F(DatabaseDamage, AMissingPartIsNamed) {
  for (const char* path :
       {"/body/position_m", "/body/triangle", "/body/normal", "/tools/tip/direction",
        "/tools/ball/energy_j", "/tools/ball/sample_begin", "/provenance/scene_toml"}) {
    EXPECT_SAYS(after([&](hid_t file) {
                  delete_link(file, path);
                }),
                std::string("dataset ") + path + " is missing");
  }
  EXPECT_SAYS(after([](hid_t file) {
                delete_link(file, "/tools/ball");
              }),
              "group /tools/ball is missing");
  EXPECT_SAYS(after([](hid_t file) {
                H5Adelete_by_name(file, "/tools/tip", "radius_m", H5P_DEFAULT);
              }),
              "attribute /tools/tip@radius_m is missing");
}

TEST_F(DatabaseDamage, AWrongUnitIsNamed) {
  EXPECT_SAYS(after([](hid_t file) {
                set_text(file, "/body/position_m", "units", "mm");
              }),
              "dataset /body/position_m has the units \"mm\", must be \"m\"");
}

TEST_F(DatabaseDamage, AWrongTypeShapeOrLayoutIsNamed) {
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/body/position_m", H5T_IEEE_F32LE, {6, 3}, "m");
              }),
              "/body/position_m has the wrong element type, must be float64");
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/body/position_m", H5T_IEEE_F64LE, {6, 2}, "m");
              }),
              "/body/position_m has the shape (6 x 2), must be (rows x 3)");
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/tools/tip/origin", H5T_STD_U8LE, {6, 1}, "1");
              }),
              "/tools/tip/origin has the shape (6 x 1), must be (rows)");
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/tools/tip/origin", H5T_STD_U8LE, {5}, "1");
              }),
              "/tools/tip/origin has 5 rows, must have 6");
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/tools/tip/depth_m", H5T_IEEE_F64LE, {30}, "m", 10);
              }),
              "/tools/tip/depth_m is external or filtered, must be contiguous, or "
              "shuffled and deflated");
}

TEST_F(DatabaseDamage, ASizeBeyondTheFileIsRefusedBeforeMemoryIsTaken) {
  EXPECT_SAYS(after([](hid_t file) {
                replace(file, "/tools/tip/depth_m", H5T_IEEE_F64LE, {hsize_t{1} << 59},
                        "m");
              }),
              "/tools/tip/depth_m claims 576460752303423488 rows, more than a file of");
}

TEST_F(DatabaseDamage, AGroupInPlaceOfADatasetIsNamed) {
  EXPECT_SAYS(after([](hid_t file) {
                delete_link(file, "/body/normal");
                H5Gclose(H5Gcreate2(file, "/body/normal", H5P_DEFAULT, H5P_DEFAULT,
                                    H5P_DEFAULT));
              }),
              "dataset /body/normal cannot be opened");
}

TEST_F(DatabaseDamage, ABrokenRuleIsNamedBeforeTheDigest) {
  EXPECT_SAYS(after([](hid_t file) {
                set_first(file, "/tools/tip/error_relative", -1.0);
              }),
              "/tools/tip/error_relative: node 0 has -1, must lie in [0,");
}

TEST_F(DatabaseDamage, AChangeWithinTheRulesIsFoundByTheDigest) {
  EXPECT_SAYS(after([](hid_t file) {
                set_first(file, "/tools/tip/error_relative", 0.021);
              }),
              "the file was damaged or changed");
}

TEST(DatabaseFile, AMissingFileIsTheUsersError) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_database(folder / "no.h5"), InputError);
  EXPECT_THROW((void)read_database(folder.path()), InputError);
}

TEST(DatabaseFile, HdfsOwnErrorPrintingIsKeptForOthers) {
  H5E_auto2_t before = nullptr;
  H5E_auto2_t during = nullptr;
  H5E_auto2_t after = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &data);
  {
    const QuietHdf5 quiet;
    H5Eget_auto2(H5E_DEFAULT, &during, &data);
  }
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  EXPECT_EQ(during, nullptr);
  EXPECT_NE(before, nullptr);
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace palpate

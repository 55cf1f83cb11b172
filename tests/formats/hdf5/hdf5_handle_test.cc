#include "formats/hdf5/hdf5_handle.h"

#include <fstream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/support/test_data.h"

namespace palpate::hdf5 {
namespace {

int& closings() {
  static int count = 0;
  return count;
}

herr_t count_closing(hid_t) {
  ++closings();
  return 0;
}

// An empty file in a folder of its own.
class Hdf5HandleFile : public testing::Test {
 protected:
  Hdf5Lock lock;
  ScratchFolder folder;
  Handle file{
      H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
      H5Fclose};

  // A dataset of `count` doubles, which nobody writes.
  Handle unwritten(const char* name, hsize_t count, hid_t create) {
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    return {H5Dcreate2(file.get(), name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                       create, H5P_DEFAULT),
            H5Dclose};
  }

  static void write_first(const Handle& dataset, hsize_t count) {
    const std::vector<double> values(count, 1.0);
    const Handle space(H5Dget_space(dataset.get()), H5Sclose);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const hsize_t begin = 0;
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr);
    ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(),
                       H5P_DEFAULT, values.data()),
              0);
  }
};

TEST(Hdf5Handle, ClosesWhatItHoldsOnce) {
  closings() = 0;
  {
    Handle first(7, count_closing);
    const Handle second(std::move(first));
    EXPECT_EQ(second.get(), 7);
    EXPECT_FALSE(static_cast<bool>(first));  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(closings(), 0);
  }
  EXPECT_EQ(closings(), 1);
}

TEST(Hdf5Handle, ZeroIsOpenAndNegativeIsNot) {
  closings() = 0;
  {
    const Handle failed(-1, count_closing);
    EXPECT_FALSE(static_cast<bool>(failed));
  }
  EXPECT_EQ(closings(), 0);
  {
    const Handle zero(0, count_closing);
    EXPECT_TRUE(static_cast<bool>(zero));
  }
  EXPECT_EQ(closings(), 1);
}

TEST_F(Hdf5HandleFile, OpensHdf5AloneAndNoFolders) {
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  std::ofstream(folder / "text.h5") << "no HDF5";
  EXPECT_FALSE(Handle(open_read_only(folder / "text.h5"), H5Fclose));
  EXPECT_THROW((void)open_read_only(folder.path()), InputError);
  EXPECT_THROW((void)open_read_only(folder / "none.h5"), InputError);
}

TEST_F(Hdf5HandleFile, FollowsHardLinksAlone) {
  const Handle group(
      H5Gcreate2(file.get(), "/a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const Handle data = unwritten("/a/data", 1, H5P_DEFAULT);
  H5Lcreate_soft("/a", file.get(), "/soft", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/nowhere", file.get(), "/a/dangling", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_external("b.h5", "/", file.get(), "/other", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_hard(file.get(), "/a", file.get(), "/second", H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_EQ(link_at(file.get(), "/"), Link::kHard);
  EXPECT_EQ(link_at(file.get(), "/a/data"), Link::kHard);
  EXPECT_EQ(link_at(file.get(), "a/data"), Link::kHard);
  EXPECT_EQ(link_at(file.get(), "/second/data"), Link::kHard);
  EXPECT_EQ(link_at(file.get(), "/soft"), Link::kOther);
  EXPECT_EQ(link_at(file.get(), "/a/dangling"), Link::kOther);
  EXPECT_EQ(link_at(file.get(), "/soft/data"), Link::kOther);
  EXPECT_EQ(link_at(file.get(), "/other/data"), Link::kOther);
  EXPECT_EQ(link_at(file.get(), "/b"), Link::kNone);
  EXPECT_EQ(link_at(file.get(), "/b/data"), Link::kNone);
  EXPECT_EQ(link_at(file.get(), "/a/data/more"), Link::kNone);
  EXPECT_EQ(link_at(file.get(), ""), Link::kNone);
}

TEST_F(Hdf5HandleFile, ContiguousBytesThatNobodyWroteAreNotHeld) {
  const Handle left_out = unwritten("/left_out", 4, H5P_DEFAULT);
  EXPECT_FALSE(holds_its_bytes(left_out.get()));
  write_first(left_out, 4);
  EXPECT_TRUE(holds_its_bytes(left_out.get()));
  const Handle empty = unwritten("/empty", 0, H5P_DEFAULT);
  EXPECT_TRUE(holds_its_bytes(empty.get()));
}

TEST_F(Hdf5HandleFile, EveryChunkMustBeThereAlsoThePartialLast) {
  const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk = 4;
  H5Pset_chunk(create.get(), 1, &chunk);
  const Handle data = unwritten("/chunked", 9, create.get());
  EXPECT_FALSE(holds_its_bytes(data.get()));
  write_first(data, 8);
  EXPECT_FALSE(holds_its_bytes(data.get()));
  write_first(data, 9);
  EXPECT_TRUE(holds_its_bytes(data.get()));
  const Handle exact = unwritten("/exact", 8, create.get());
  write_first(exact, 8);
  EXPECT_TRUE(holds_its_bytes(exact.get()));
}

TEST_F(Hdf5HandleFile, CompactBytesAreHeldAndThoseOfOtherFilesAreNot) {
  const Handle compact(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_layout(compact.get(), H5D_COMPACT);
  EXPECT_TRUE(holds_its_bytes(unwritten("/compact", 4, compact.get()).get()));
  const Handle external(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_external(external.get(), (folder / "bytes").c_str(), 0, 32);
  const Handle data = unwritten("/external", 4, external.get());
  write_first(data, 4);
  EXPECT_FALSE(holds_its_bytes(data.get()));
}

TEST_F(Hdf5HandleFile, VirtualBytesAreOfOtherFiles) {
  const hsize_t count = 4;
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  ASSERT_GE(H5Pset_virtual(create.get(), space.get(), (folder / "b.h5").c_str(), "/x",
                           space.get()),
            0);
  EXPECT_FALSE(holds_its_bytes(unwritten("/virtual", 4, create.get()).get()));
}

TEST(Hdf5Handle, TypesInTheFileHaveTheirNamesSizeAndSign) {
  const Hdf5Lock lock;
  for (const StoredType type :
       {StoredType::kFloat64, StoredType::kFloat32, StoredType::kInt64,
        StoredType::kInt32, StoredType::kInt16, StoredType::kUint8}) {
    const std::string name = name_of(type);
    const bool real = name.starts_with("float");
    EXPECT_EQ(H5Tget_size(file_type(type)), bytes_of(type)) << name;
    EXPECT_EQ(name.substr(name.find_first_of("0123456789")),
              std::to_string(8 * bytes_of(type)));
    EXPECT_EQ(H5Tget_order(file_type(type)) == H5T_ORDER_BE, false) << name;
    EXPECT_EQ(H5Tget_class(file_type(type)), real ? H5T_FLOAT : H5T_INTEGER) << name;
    if (!real) {
      EXPECT_EQ(H5Tget_sign(file_type(type)),
                name.starts_with("u") ? H5T_SGN_NONE : H5T_SGN_2)
          << name;
    }
  }
}

TEST(Hdf5Handle, ATextOfNoBytesHasAType) {
  const Hdf5Lock lock;
  EXPECT_EQ(H5Tget_size(string_type(0).get()), 1U);
  EXPECT_EQ(H5Tget_size(string_type(5).get()), 5U);
  EXPECT_EQ(H5Tget_cset(string_type(5).get()), H5T_CSET_UTF8);
  EXPECT_EQ(H5Tget_strpad(string_type(5).get()), H5T_STR_NULLPAD);
}

}  // namespace
}  // namespace palpate::hdf5

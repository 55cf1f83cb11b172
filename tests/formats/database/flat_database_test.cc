// A database says the same in both forms: what is read from a flat file is what is read
// from an HDF5 file, and is held to the same rules.
#include <cstring>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_digest.h"
#include "formats/database/chunk_reader.h"
#include "formats/flat/flat_directory.h"
#include "tests/support/every_database.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

StoredSource in_memory(const std::string& bytes) {
  return StoredSource(std::as_bytes(std::span(bytes)));
}

// "read", or why not.
std::string outcome_of(const StoredSource& source) {
  try {
    (void)read_database(source);
    return "read";
  } catch (const FormatError& error) {
    return error.what();
  }
}

class FlatForm : public testing::Test {
 protected:
  // Equal databases give equal bytes (DatabaseStorage tests that).
  std::string as_hdf5(const ResponseDatabase& database) const {
    write_database(folder_ / "again.h5", database, StoredForm::kHdf5);
    return bytes_of(folder_ / "again.h5");
  }
  std::string as_flat(const ResponseDatabase& database) const {
    write_database(flat_, database);
    return bytes_of(flat_);
  }

  const ScratchFolder folder_;
  const std::filesystem::path hdf5_ = folder_ / "a.h5";
  const std::filesystem::path flat_ = folder_ / "a.palpate";
};

TEST_F(FlatForm, ConvertedBackIsTheHdf5FileToTheByte) {
  for (auto& [name, database] : every_database()) {
    for (const Precision precision :
         {Precision::kFloat64, Precision::kFloat32, Precision::kInt16}) {
      for (const bool compress : {false, true}) {
        database.storage.precision = precision;
        database.storage.compress = compress;
        write_database(hdf5_, database);
        write_database(flat_, read_database(hdf5_));
        EXPECT_EQ(bytes_of(flat_).substr(0, kFlatMagic.size()), kFlatMagic);
        EXPECT_EQ(as_hdf5(read_database(flat_)), bytes_of(hdf5_))
            << name << name_of(precision) << compress;
        EXPECT_EQ(database_sha256(flat_), database_sha256(hdf5_));
      }
    }
  }
}

TEST_F(FlatForm, EqualDatabasesGiveEqualBytes) {
  for (const auto& [name, database] : every_database()) {
    const std::string first = as_flat(database);
    EXPECT_EQ(as_flat(read_database(flat_)), first) << name;
  }
}

TEST_F(FlatForm, ChunksAreThoseOfTheHdf5File) {
  for (const auto& [name, database] : every_database()) {
    write_database(hdf5_, database);
    const std::string bytes = as_flat(database);
    const ChunkReader expected(hdf5_);
    for (const StoredSource& source : {StoredSource(flat_), in_memory(bytes)}) {
      const ChunkReader reader(source);
      EXPECT_EQ(index_digest(reader.index()), index_digest(expected.index())) << name;
      EXPECT_EQ(reader.index().bytes, bytes.size());
      for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
        EXPECT_EQ(chunk_digest(reader.body(k)), chunk_digest(expected.body(k)));
        for (std::size_t tool = 0; tool < database.tools.size(); ++tool) {
          const ResponseTable part = reader.responses(tool, k);
          const ResponseTable same = expected.responses(tool, k);
          EXPECT_EQ(chunk_digest(part), chunk_digest(same)) << name << k;
          EXPECT_EQ(memory_digest(part.viscoelasticity),
                    memory_digest(same.viscoelasticity));
          EXPECT_EQ(contact_digest(part.contact), contact_digest(same.contact));
          EXPECT_EQ(compliance_digest(part.compliance),
                    compliance_digest(same.compliance));
          EXPECT_EQ(part.tilt, same.tilt);
        }
      }
    }
  }
}

TEST_F(FlatForm, AnHdf5FileInMemoryIsReadToo) {
  write_database(hdf5_, measured_database());
  const std::string bytes = bytes_of(hdf5_);
  EXPECT_EQ(as_hdf5(read_database(in_memory(bytes))), bytes);
  EXPECT_NE(outcome_of(in_memory(bytes.substr(0, bytes.size() / 2))).find("truncated"),
            std::string::npos);
}

// A byte that changes is noticed, or says nothing: between what has bytes lie some.
TEST_F(FlatForm, EveryChangedByteIsRefusedOrSaysNothing) {
  const ResponseDatabase database = small_database();
  std::string bytes = as_flat(database);
  const std::string whole = bytes;
  const std::string same = as_hdf5(database);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<char>(bytes[i] ^ (1 << (i % 8)));
    if (outcome_of(in_memory(bytes)) == "read") {
      ++taken;
      EXPECT_EQ(as_hdf5(read_database(in_memory(bytes))), same) << "byte " << i;
    }
    bytes[i] = whole[i];
  }
  EXPECT_LT(taken, whole.size() / 4);
}

TEST_F(FlatForm, EveryShorterFileIsRefused) {
  const std::string bytes = as_flat(small_database());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::string reason = outcome_of(in_memory(bytes.substr(0, length)));
    ASSERT_EQ(reason.rfind("bytes in memory: is ", 0), 0U) << length << reason;
    ASSERT_EQ(reason.find('\n'), std::string::npos) << reason;
  }
  EXPECT_NE(outcome_of(in_memory(bytes + "x")), "read");
  std::ofstream(flat_, std::ios::binary) << bytes.substr(0, bytes.size() - 1);
  EXPECT_NE(outcome_of(flat_).find("is truncated or damaged"), std::string::npos);
}

// A file of some kilobytes that says it holds terabytes: nothing is asked of memory.
TEST_F(FlatForm, AFileOfHolesIsRefused) {
  constexpr std::uintmax_t kMuch = std::uintmax_t{1} << 42;
  FlatHeader header;
  header.bytes = kMuch;
  header.directory = kFlatFirstOffset;
  std::ofstream(flat_, std::ios::binary) << flat_header(header);
  std::error_code error;
  std::filesystem::resize_file(flat_, kMuch, error);
  if (error) {
    GTEST_SKIP() << "no such files here: " << error.message();
  }
  EXPECT_NE(outcome_of(flat_).find("has holes"), std::string::npos);
}

// A directory that lies, with the digest of its lies.
TEST_F(FlatForm, ADirectoryIsBelievedInNothing) {
  const std::string whole = as_flat(small_database());
  const FlatHeader header = read_flat_header(whole);
  const std::string same = as_hdf5(small_database());
  std::mt19937 random(7);
  std::size_t read = 0;
  constexpr int kChanges = 4000;
  for (int i = 0; i < kChanges; ++i) {
    std::string bytes = whole;
    const std::size_t places = bytes.size() - header.directory;
    // Lengths, extents and offsets: one byte, or eight of them at an end of the range.
    const std::size_t at = header.directory + random() % places;
    if (i % 2 == 0) {
      bytes[at] = static_cast<char>(random());
    } else {
      const std::size_t count = std::min<std::size_t>(8, bytes.size() - at);
      std::memset(&bytes[at], i % 4 == 1 ? 0x7f : 0xff, count);
    }
    FlatHeader repaired = header;
    repaired.sha256 = flat_sha256(header, bytes.substr(header.directory));
    bytes.replace(0, kFlatHeaderBytes, flat_header(repaired));
    if (outcome_of(in_memory(bytes)) == "read") {
      ++read;
      EXPECT_EQ(as_hdf5(read_database(in_memory(bytes))), same) << "byte " << at;
    }
  }
  std::printf("%zu of %d lying directories say the same\n", read, kChanges);
  EXPECT_LT(read, std::size_t{kChanges} / 4);
}

TEST_F(FlatForm, AnotherVersionIsRefused) {
  const std::string whole = as_flat(small_database());
  FlatHeader header = read_flat_header(whole);
  header.version = kFlatVersion + 1;
  header.sha256 = flat_sha256(header, whole.substr(header.directory));
  const std::string bytes = flat_header(header) + whole.substr(kFlatHeaderBytes);
  EXPECT_EQ(outcome_of(in_memory(bytes)),
            "bytes in memory: is a flat file of version 2, this program reads 1; use a "
            "newer one");
}

}  // namespace
}  // namespace palpate

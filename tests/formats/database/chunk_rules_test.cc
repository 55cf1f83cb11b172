// What the whole reader refuses, the reader of chunks refuses, in files whose digests
// all are right.
#include <array>
#include <cstdlib>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "formats/base/error.h"
#include "formats/database/database_rules.h"
#include "tests/formats/database/violation.h"
#include "tests/support/database_changes.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// What a renderer streams; empty or why it is refused.
std::string streamed(const std::filesystem::path& file) {
  try {
    stream_all(file);
    return "";
  } catch (const FormatError& error) {
    return error.what();
  }
}

std::string whole(const std::filesystem::path& file) {
  try {
    (void)read_database(file);
    return "";
  } catch (const FormatError& error) {
    return error.what();
  }
}

void scale(std::vector<double>& values, double by) {
  for (double& value : values) {
    value *= by;
  }
}

struct Breach {
  const char* name;
  std::function<void(ResponseDatabase&, ResponseTable&)> make;
  const char* says;
};

const std::vector<Breach>& breaches() {
  static const std::vector<Breach> all{
      {"ForcesThatPull",
       [](auto&, ResponseTable& t) {
         scale(t.force_n, -1.0);
         scale(t.stiffness_n_per_m, -1.0);
         scale(t.energy_j, -1.0);
       },
       "not negative"},
      {"DirectionsOfLength50",
       [](auto&, ResponseTable& t) {
         t.direction *= 50.0;
       },
       "must be 1"},
      {"ALargestSlopeThatLies",
       [](auto&, ResponseTable& t) {
         scale(t.force_n, 100.0);
         scale(t.stiffness_n_per_m, 100.0);
         scale(t.energy_j, 100.0);
       },
       "largest slope"},
      {"EnergiesOfZero",
       [](auto&, ResponseTable& t) {
         scale(t.energy_j, 0.0);
       },
       "integral of force"},
      {"EnergiesBelowZero",
       [](auto&, ResponseTable& t) {
         scale(t.energy_j, -1.0);
       },
       "integral of force"},
      {"DepthsReversed",
       [](auto&, ResponseTable& t) {
         std::reverse(t.depth_m.begin(), t.depth_m.end());
       },
       "must start at zero"},
      {"FrictionBelowZero",
       [](auto&, ResponseTable& t) {
         t.friction[3] = -5.0;
       },
       "friction"},
      {"FrictionWithoutADistance",
       [](auto&, ResponseTable& t) {
         t.friction[3] = 0.5;
         t.presliding_m[3] = 0.0;
       },
       "presliding_m"},
      {"ForcesThatAreNoNumbers",
       [](auto&, ResponseTable& t) {
         t.force_n[7] = kNaN;
       },
       "finite"},
      {"SlopesThatOvershoot",
       [](auto&, ResponseTable& t) {
         t.stiffness_n_per_m[1] *= 50.0;
       },
       "overshoots"},
      {"NormalsOfLength2",
       [](ResponseDatabase& d, auto&) {
         d.normal *= 2.0;
       },
       "/body/normal"},
      {"ANodeNowhere",
       [](ResponseDatabase& d, auto&) {
         d.body.position_m(2, 1) = kNaN;
       },
       "must be finite"},
      {"ATriangleOfTwoNodes",
       [](ResponseDatabase& d, auto&) {
         d.body.triangle(0, 1) = d.body.triangle(0, 0);
       },
       "three different nodes"},
      {"OriginNoneWithACurve",
       [](auto&, ResponseTable& t) {
         t.origin[3] = 0;
       },
       "origin"},
      {"AFallingCurveThatDoesNotSaySo",
       [](auto&, ResponseTable& t) {
         t.flags[3] = static_cast<std::uint8_t>(t.flags[3] ^ kFallingCurve);
       },
       "falling"}};
  return all;
}

class ChunkRules : public testing::TestWithParam<Breach> {
 protected:
  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "a.h5";
};

INSTANTIATE_TEST_SUITE_P(Breaches, ChunkRules, testing::ValuesIn(breaches()),
                         [](const auto& breach) {
                           return std::string(breach.param.name);
                         });

TEST_P(ChunkRules, BothReadersRefuse) {
  ResponseDatabase database = sphere_database(12, 9);
  database.storage.chunk_nodes = 32;
  write_unchecked(file_, database);
  EXPECT_EQ(streamed(file_), "");
  EXPECT_EQ(whole(file_), "");
  GetParam().make(database, database.tools[0]);
  write_unchecked(file_, database);
  const std::string reason = streamed(file_);
  EXPECT_NE(reason.find(GetParam().says), std::string::npos) << reason;
  EXPECT_EQ(reason.rfind(file_.string() + ": ", 0), 0U) << reason;
  EXPECT_NE(whole(file_), "");
}

TEST(ChunkAgainstIndex, WhatTheIndexStatesIsWhatTheChunkHolds) {
  const ScratchFolder folder;
  ResponseDatabase database = sphere_database(12, 9);
  database.storage.chunk_nodes = 32;
  write_database(folder / "a.h5", database);
  const ChunkReader reader(folder / "a.h5");
  ToolIndex stated = reader.index().tools[0];
  const ResponseTable table = reader.responses(0, 1);
  EXPECT_NO_THROW(check_chunk(stated, 1, table));
  for (auto member : {&ToolIndex::depth_max_m, &ToolIndex::force_max_n,
                      &ToolIndex::stiffness_max_n_per_m, &ToolIndex::error_relative_max,
                      &ToolIndex::direction_spread_max_rad}) {
    ToolIndex lies = stated;
    (lies.*member)[1] = 0.5 * (lies.*member)[1] - 1e-3;
    EXPECT_THROW(check_chunk(lies, 1, table), FormatError);
  }
  const BodyChunk body = reader.body(1);
  EXPECT_NO_THROW(check_chunk(reader.index(), 1, body));
  BodyChunk elsewhere = body;
  elsewhere.position_m(0, 0) += 1.0;
  EXPECT_THROW(check_chunk(reader.index(), 1, elsewhere), FormatError);
  BodyChunk foreign = body;
  foreign.triangle.row(0).setZero();
  EXPECT_THROW(check_chunk(reader.index(), 1, foreign), FormatError);
}

TEST(ChunkAgainstIndex, EachOfTheSourcesNodesAndTrianglesIsNamedOnce) {
  const ScratchFolder folder;
  ResponseDatabase database = sphere_database(12, 9);
  database.storage.chunk_nodes = 32;
  write_database(folder / "a.h5", database);
  const ChunkReader reader(folder / "a.h5");
  const BodyChunk first = reader.body(0);
  const BodyChunk second = reader.body(1);
  SourceNames sound(reader.index());
  sound.add(0, first);
  sound.add(1, second);
  EXPECT_NO_THROW(sound.add(0, first));  // it comes again
  const auto refused = [&](BodyChunk chunk, auto member, std::int32_t name) {
    (chunk.*member)[0] = name;
    SourceNames names(reader.index());
    names.add(0, first);
    EXPECT_THROW(names.add(1, chunk), FormatError) << name;
  };
  for (auto member : {&BodyChunk::source_node, &BodyChunk::source_triangle}) {
    refused(second, member, (first.*member)[3]);   // of another chunk
    refused(second, member, (second.*member)[1]);  // of its own
    refused(second, member, -1);
    refused(second, member, 1'000'000);
  }
}

// An index with the right digest that claims what is not in the file: nothing is asked
// of memory for it.
TEST(ChunkAgainstIndex, ItEndsWhereTheFileDoes) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  for (const char* path : {"/index/node_begin", "/index/triangle_begin",
                           "/tools/ball/index/sample_begin"}) {
    ResponseDatabase database = sphere_database(12, 9);
    database.storage.chunk_nodes = 32;
    write_database(file, database);
    DatabaseIndex index = read_index(file);
    constexpr std::int64_t kMuch = std::int64_t{1} << 40;
    (path == std::string("/index/node_begin")       ? index.node_begin
     : path == std::string("/index/triangle_begin") ? index.triangle_begin
                                                    : index.tools[0].sample_begin)
        .back() = kMuch;
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(id, path, H5P_DEFAULT);
    const hid_t there = H5Dget_space(dataset);
    const hsize_t last = static_cast<hsize_t>(index.chunks());
    const hsize_t one = 1;
    const hid_t here = H5Screate_simple(1, &one, nullptr);
    H5Sselect_hyperslab(there, H5S_SELECT_SET, &last, nullptr, &one, nullptr);
    H5Dwrite(dataset, H5T_NATIVE_INT64, here, there, H5P_DEFAULT, &kMuch);
    const hid_t attribute =
        H5Aopen_by_name(id, "/index", "index_sha256", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    const std::string digest = index_digest(index);
    H5Awrite(attribute, type, digest.data());
    H5Tclose(type);
    H5Aclose(attribute);
    H5Sclose(here);
    H5Sclose(there);
    H5Dclose(dataset);
    H5Fclose(id);
    const std::string why = streamed(file);
    EXPECT_NE(why.find(fmt::format("{} ends at {}", path, kMuch)), std::string::npos)
        << why;
  }
}

// Both readers say the same of every random change of what is rendered: 200 of them, or
// PALPATE_RANDOM_CHANGES.
TEST(ChunkAgainstWhole, BothReadersAgreeOnRandomChanges) {
  const char* wanted = std::getenv("PALPATE_RANDOM_CHANGES");
  const int count = wanted == nullptr ? 200 : std::atoi(wanted);
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  std::mt19937 random(3);
  int refused = 0;
  int unwritten = 0;
  for (int i = 0; i < count; ++i) {
    ResponseDatabase database = small_database();
    database.storage.chunk_nodes = 2;
    for (int k = 0; k < 1 + i % 3; ++k) {
      std::array<std::uint8_t, DatabaseChange::kBytes> bytes{};
      for (std::uint8_t& byte : bytes) {
        byte = static_cast<std::uint8_t>(random());
      }
      apply(database, DatabaseChange(bytes));
    }
    try {
      write_unchecked(file, database);
    } catch (const Error&) {
      ++unwritten;  // cannot be ordered
      continue;
    }
    const bool streams = streamed(file).empty();
    ASSERT_EQ(streams, whole(file).empty())
        << i << ": " << streamed(file) << " / " << whole(file);
    refused += streams ? 0 : 1;
  }
  EXPECT_GT(refused, count / 2);
  EXPECT_LT(refused + unwritten, count);
}

}  // namespace
}  // namespace palpate

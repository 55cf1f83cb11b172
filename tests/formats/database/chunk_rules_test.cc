// What the whole reader refuses, the reader of chunks refuses, in files whose digests
// all are right.
#include <array>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>

#include "formats/base/error.h"
#include "formats/database/database_rules.h"
#include "formats/hdf5/hdf5_io.h"
#include "tests/support/database_changes.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

[[maybe_unused]] const bool kQuietExit = (skip_hdf5_exit_cleanup(), true);

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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
  for (const auto& make : std::vector<std::function<void(BodyChunk&)>>{
           [](BodyChunk& b) {
             b.position_m(0, 0) += 1.0;
           },
           [](BodyChunk& b) {
             b.triangle.row(0).setZero();
           },
           [](BodyChunk& b) {
             b.source_node[1] = b.source_node[0];
           },
           [](BodyChunk& b) {
             b.source_triangle[1] = b.source_triangle[0];
           },
           [](BodyChunk& b) {
             b.source_triangle[0] = -1;
           }}) {
    BodyChunk other = body;
    make(other);
    EXPECT_THROW(check_chunk(reader.index(), 1, other), FormatError);
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

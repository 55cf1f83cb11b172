// A folder of measured files that are fitted in a session.
#pragma once

#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fitting/session/batch.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {

inline constexpr const char* kRead =
    "[read]\ndepth_column = \"x\"\ndepth_unit = \"mm\"\nforce_column = \"f\"\n"
    "force_unit = \"N\"\n";
inline constexpr const char* kFamilies = "[fit]\nfamilies = [\"power-law\"]\n";

class BatchFolder : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  // Columns x [mm] and f [N] times these factors.
  void write(const std::string& name, const Measurement& m, double depth = 1e3,
             double force = 1.0, const std::string& header = "x,f\n") const {
    write(name, table_of(m, depth, force, header));
  }

  Session session(const std::string& read, const std::string& rest = "") const {
    write("session.toml",
          fmt::format("{}{}{}[[run]]\nfiles = \"*.csv\"\n", read, kFamilies, rest));
    return read_session(folder_ / "session.toml");
  }

  RunResult fit(const Measurement& m) const {
    write("a.csv", m);
    const Session s = session(kRead);
    return fit_run(s, s.run.at(0)).at(0);
  }

  ScratchFolder folder_;
};

}  // namespace palpate

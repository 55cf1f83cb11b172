#include "fitting/session/session_machine.h"

#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fitting/session/batch.h"
#include "fitting/session/curve_tables.h"
#include "fitting/session/mean_curves.h"
#include "fitting/session/session_probes.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr const char* kReadInMetres =
    "[read]\ndepth_column = \"x\"\ndepth_unit = \"m\"\nforce_column = \"f\"\n"
    "force_unit = \"N\"\n[fit]\nfamilies = [\"power-law\"]\n";
constexpr double kStiffness = 800.0;  // [N/m]

class SessionMachineTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  void write(const std::string& name, const Measurement& m) const {
    std::string text = "x,f\n";
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      text += fmt::format("{},{}\n", m.depth_m[i], m.force_n[i]);
    }
    write(name, text);
  }

  // `presses` of a machine that gives way; the force of all times `stiffer`.
  void write_cycles(const std::string& name, int presses, double stiffer = 1.0) const {
    Measurement m;
    for (int k = 0; k < presses; ++k) {
      Measurement press = synthetic({.noise_n = 0.0}, 1);
      for (std::size_t i = 0; i < 2 * press.depth_m.size(); ++i) {
        const std::size_t at = i < 350 ? i : 699 - i;
        const double f = stiffer * (1.0 - 0.1 * k) * press.force_n[at];
        m.depth_m.push_back(press.depth_m[at] + f / kStiffness);
        m.force_n.push_back(f + 1e-3 * std::sin(37.0 * static_cast<double>(i)));
      }
    }
    write(name, m);
  }

  Session read(const std::string& rest) const {
    write("session.toml", kReadInMetres + rest);
    return read_session(folder_ / "session.toml");
  }

  BatchReport fit(const std::string& rest) const {
    return fit_session(read(rest), 1, [](std::size_t) {});
  }

  void expect_complaint(const std::string& rest, const std::string& part) const {
    std::string message;
    try {
      (void)fit(rest);
    } catch (const Error& error) {
      message = error.what();
    }
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  ScratchFolder folder_;
};

const std::string kRun = "[[run]]\nfile = \"a.csv\"\n";

TEST_F(SessionMachineTest, TakesOffAFrameThatIsStatedOrMeasured) {
  write_cycles("a.csv", 1);
  Measurement plate;
  for (int i = 0; i < 400; ++i) {
    const double x = 4e-3 * i / 399.0;
    plate.depth_m.push_back(x);
    plate.force_n.push_back(kStiffness * std::max(0.0, x - 1e-3) +
                            1e-4 * std::sin(37.0 * i));
  }
  write("plate.csv", plate);
  const BatchReport without = fit(kRun);
  const BatchReport stated = fit(
      "[machine]\nframe_stiffness_n_per_m = 800\nframe_stiffness_sd_n_per_m = 40\n" +
      kRun);
  const BatchReport measured = fit("[machine]\nframe_run = \"plate.csv\"\n" + kRun);
  EXPECT_FALSE(without.frame.has_value());
  EXPECT_NEAR(measured.frame->frame.stiffness_n_per_m, kStiffness, 1.0);
  const auto depth = [](const BatchReport& report) {
    return report.runs.at(0).best()->depth_max_m;
  };
  EXPECT_NEAR(depth(without), 5e-3 + 1.0 / kStiffness, 1e-4);
  EXPECT_NEAR(depth(stated), 5e-3, 5e-5);
  EXPECT_NEAR(depth(measured), 5e-3, 5e-5);
  EXPECT_NEAR(stated.runs[0].corrections.frame.depth_sd_m, 0.05 / kStiffness, 1e-6);
}

TEST_F(SessionMachineTest, AnUncertainFrameWidensModulusAndBands) {
  write_cycles("a.csv", 1);
  const std::string sphere = "[indenter]\nshape = \"sphere\"\nradius_m = 0.05\n";
  const std::string frame = "[machine]\nframe_stiffness_n_per_m = 800\n";
  const BatchReport exact = fit(sphere + frame + kRun);
  const BatchReport vague =
      fit(sphere + frame + "frame_stiffness_sd_n_per_m = 40\n" + kRun);
  const Modulus& a = exact.runs[0].modulus;
  const Modulus& b = vague.runs[0].modulus;
  EXPECT_EQ(a.youngs_modulus_pa, b.youngs_modulus_pa);
  // E is as d^-1.5: 1.25 % of the largest depth are some 2 % of E.
  EXPECT_GT(b.sd_pa, a.sd_pa + 0.005 * a.youngs_modulus_pa);
  EXPECT_LT(b.sd_pa, 0.04 * a.youngs_modulus_pa);
  EXPECT_NE(curves_csv(exact), curves_csv(vague));
}

TEST_F(SessionMachineTest, RefusesAMachineThatCannotBe) {
  write_cycles("a.csv", 1);
  expect_complaint("[machine]\nframe_stiffness_n_per_m = 0\n" + kRun,
                   "must be positive");
  expect_complaint("[machine]\n" + kRun, "frame_stiffness_n_per_m");
  expect_complaint(
      "[machine]\nframe_run = \"plate.csv\"\nframe_stiffness_n_per_m = 1\n" + kRun,
      "frame_run");
  expect_complaint("[machine]\nframe_run = \"plate.csv\"\n" + kRun, "plate.csv");
  expect_complaint(
      "[machine]\nframe_run = \"a.csv\"\nframe_stiffness_sd_n_per_m = 1\n" + kRun,
      "goes with frame_stiffness_n_per_m");
  expect_complaint("[machine]\nstiffness = 1\n" + kRun, "stiffness");
  // A frame softer than machine and sample together: the run is bad, with its reason.
  const BatchReport soft = fit("[machine]\nframe_stiffness_n_per_m = 100\n" + kRun);
  EXPECT_NE(soft.runs[0].bad.find("takes the whole displacement"), std::string::npos);
}

TEST_F(SessionMachineTest, FitsTheCycleThatIsWanted) {
  write_cycles("a.csv", 3);
  const std::string fit_table = kRun;
  Session s = read(fit_table);
  EXPECT_EQ(fit_run(s, s.run[0]).size(), 3U);
  s.fit.cycle = parse_cycle("last");
  const auto last = fit_run(s, s.run[0]);
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0].name, "a.csv press 3");
  EXPECT_EQ(last[0].presses, 3U);
  ASSERT_EQ(last[0].cycles.size(), 3U);
  EXPECT_NEAR(last[0].cycles[0].peak_force_n, 1.0, 0.01);
  EXPECT_NEAR(last[0].cycles[2].peak_force_n, 0.8, 0.01);
  s.fit.cycle = parse_cycle("4");
  EXPECT_NE(
      fit_run(s, s.run[0])[0].bad.find("cycle 4 is wanted, the file has 3 presses"),
      std::string::npos);
  s.fit.cycle = parse_cycle("all");
  std::vector<LeftOutProbe> left_out;
  std::vector<std::string> notes;
  EXPECT_THROW((void)session_probes(s, left_out, notes), InputError);
}

TEST_F(SessionMachineTest, ReadsTheCycleAsTextOrNumber) {
  const auto cycle = [&](const std::string& value) {
    write("session.toml", kReadInMetres + ("cycle = " + value + "\n") + kRun);
    return cycle_text(*read_session(folder_ / "session.toml").fit.cycle);
  };
  EXPECT_EQ(cycle("\"last\""), "last");
  EXPECT_EQ(cycle("2"), "2");
  EXPECT_THROW((void)cycle("0"), InputError);
  EXPECT_THROW((void)cycle("\"middle\""), InputError);
}

TEST_F(SessionMachineTest, MovesProbesIntoTheMeshsFrame) {
  // A quarter turn about z and a shift by 0.1 m along x.
  write("pairs.csv",
        "name;machine_x;machine_y;machine_z;mesh_x;mesh_y;mesh_z\n"
        "A;0;0;0;100;0;0\nB;10;0;0;100;10;0\nC;0;10;0;90;0;0\nD;0;0;10,0;100;0;10\n");
  const std::string place = "position_m = [0.01, 0, 0]\nnormal = [1, 0, 0]\n";
  const std::string registration =
      "[registration]\npairs = \"pairs.csv\"\nlength_unit = \"mm\"\n";
  const Session s = read(registration + kRun + place);
  EXPECT_LT((*s.run[0].position_m - Eigen::Vector3d(0.1, 0.01, 0)).norm(), 1e-12);
  EXPECT_LT((*s.run[0].normal - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  const std::string told = describe_registration(s);
  EXPECT_NE(told.find("4 pairs"), std::string::npos);
  EXPECT_NE(told.find("pair D:"), std::string::npos);
  EXPECT_NE(told.find("expected error at the probes"), std::string::npos);

  const auto complaint = [&](const std::string& table) {
    write("pairs.csv", table);
    try {
      (void)read(registration + kRun + place);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string head = "name,machine_x,machine_y,machine_z,mesh_x,mesh_y,mesh_z\n";
  EXPECT_NE(complaint("name,x\nA,1\n").find("must name the columns"),
            std::string::npos);
  EXPECT_NE(complaint(head + "A,0,0,0,0,0,0\nB,1,0,0,1,0,0\n").find("2 pairs"),
            std::string::npos);
  EXPECT_NE(complaint(head + "A,0,0,x,0,0,0\n").find("line 2, column \"machine_z\""),
            std::string::npos);
  EXPECT_NE(complaint(head + "A,0,0\n").find("is not a finite number"),
            std::string::npos);
}

TEST_F(SessionMachineTest, MeansTellWhatScattersWhere) {
  // Two specimens of two points of two repeats.
  std::string runs;
  for (const char* specimen : {"S", "T"}) {
    for (const char* point : {"p", "q"}) {
      std::string files;
      for (const int repeat : {1, 2}) {
        const std::string name = fmt::format("{}{}{}.csv", specimen, point, repeat);
        write_cycles(name, 1,
                     (specimen[0] == 'S' ? 1.0 : 1.4) + (point[0] == 'p' ? 0.0 : 0.1) +
                         0.01 * repeat);
        files += fmt::format("{}\"{}\"", files.empty() ? "" : ", ", name);
      }
      runs += fmt::format("[[run]]\nfiles = [{}]\npoint = \"{}\"\nspecimen = \"{}\"\n",
                          files, point, specimen);
    }
  }
  const BatchReport report = fit("[machine]\nframe_stiffness_n_per_m = 800\n" + runs);
  const auto means = mean_curves(report).curves;
  ASSERT_EQ(means.size(), 7U);  // all, 2 specimens, 4 points
  EXPECT_EQ(means[0].name, "all");
  EXPECT_EQ(means[0].runs, 8U);
  const RandomEffects& e = means[0].force_n.back();
  const double unit = e.mean / 1.265;  // of the mean factor
  EXPECT_NEAR(e.repeat_sd / unit, 0.01 / std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(e.point_sd / unit, 0.1 / std::sqrt(2.0), 4e-3);
  EXPECT_NEAR(e.mean_sd / unit, 0.2, 4e-3);
  EXPECT_EQ(e.degrees_of_freedom, 1.0);
  EXPECT_EQ(means[1].name, "specimen S");
  EXPECT_TRUE(std::isnan(means[1].force_n.back().specimen_sd));
  EXPECT_EQ(means[2].name, "point p of specimen S");
  EXPECT_NEAR(means[2].force_n.back().repeat_sd / unit, 0.01 / std::sqrt(2.0), 1e-3);

  const auto json = parse_json(batch_json(Session{}, report));
  EXPECT_EQ(json["mean_curves"].size(), 7U);
  EXPECT_EQ(json["machine"]["frame"]["stiffness_n_per_m"], 800.0);
  const std::string table = mean_curves_csv(report);
  EXPECT_EQ(table.substr(0, 12), "mean,depth_m");
  EXPECT_NE(table.find("\npoint q of specimen T,"), std::string::npos);
}

TEST_F(SessionMachineTest, MeansOfRunsThatBeginInContactCountFromTheFirstSample) {
  for (const char* name : {"a.csv", "b.csv"}) {
    Measurement m = synthetic({.exponent = 1.2, .free_m = 0.0}, 1);
    write(name, m);
  }
  const MeanCurves means = mean_curves(fit("[[run]]\nfiles = \"?.csv\"\n"));
  EXPECT_TRUE(means.from_first_sample);
  EXPECT_EQ(means.left_out, 0U);
  EXPECT_EQ(means.curves.size(), 1U);
  EXPECT_NE(left_out_text(means).find("count from the first sample"),
            std::string::npos);
  write("c.csv", synthetic({}, 1));
  write("d.csv", synthetic({}, 2));
  const MeanCurves known = mean_curves(fit("[[run]]\nfiles = \"?.csv\"\n"));
  EXPECT_FALSE(known.from_first_sample);
  EXPECT_EQ(known.left_out, 2U);
}

TEST_F(SessionMachineTest, CurvesComeOnOneGridWithTheirBands) {
  write_cycles("a.csv", 1);
  const BatchReport report = fit("[machine]\nframe_stiffness_n_per_m = 800\n" + kRun);
  const std::string text = curves_csv(report);
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "run,point,specimen,verdict,family,depth_m,force_n,force_sd_n,lower_95_n,"
            "upper_95_n");
  int rows = 0;
  while (std::getline(lines, line)) {
    double depth = 0, force = 0, sd = 0, low = 0, high = 0;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "a.csv,a.csv,,use,power-law,%lf,%lf,%lf,%lf,%lf",
                    &depth, &force, &sd, &low, &high),
        5)
        << line;
    EXPECT_NEAR(depth, 1e-4 * rows, 1e-12);
    EXPECT_NEAR(force, std::pow(depth / 5e-3, 1.5), 5e-3);
    EXPECT_LE(low, force);
    EXPECT_GE(high, force);
    ++rows;
  }
  EXPECT_GE(rows, 49);
}

TEST(DepthGrid, IsRoundAndNeverBeyond) {
  for (const double largest : {5e-3, 4.99e-3, 1.03e-6, 7.0, 2.5e-3}) {
    const auto grid = depth_grid_m(largest);
    EXPECT_EQ(grid.front(), 0.0);
    EXPECT_LE(grid.back(), largest * (1.0 + 1e-9));
    EXPECT_GE(grid.size(), 26U) << largest;
    EXPECT_LE(grid.size(), 64U) << largest;
  }
  EXPECT_NEAR(depth_grid_m(5e-3)[1], 2e-4, 1e-15);
}

}  // namespace
}  // namespace palpate

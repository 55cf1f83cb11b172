// The solver on the nonlinear sets of the Statistical Reference Datasets (NIST), whose
// certified values are public: parameters, their standard deviations, sum of squares.
#include "fitting/numerics/least_squares.h"

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Complex = std::complex<double>;
using Model = Complex (*)(const std::vector<Complex>& b, double x);

struct ReferenceSet {
  std::string name;
  Model model;
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> value, sd;
  double sum_of_squares;
};

const std::vector<double> kMisraX = {77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                                     378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0};
const std::vector<double> kMisraY = {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02,
                                     44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78};

std::vector<ReferenceSet> sets() {
  std::vector<ReferenceSet> all;
  all.push_back({"Misra1a",
                 [](const std::vector<Complex>& b, double x) {
                   return b[0] * (1.0 - std::exp(-b[1] * x));
                 },
                 kMisraX,
                 kMisraY,
                 {{500, 0.0001}, {250, 0.0005}},
                 {2.3894212918e+02, 5.5015643181e-04},
                 {2.7070075241e+00, 7.2668688436e-06},
                 1.2455138894e-01});
  all.push_back({"Misra1b",
                 [](const std::vector<Complex>& b, double x) {
                   const Complex u = 1.0 + b[1] * x / 2.0;
                   return b[0] * (1.0 - 1.0 / (u * u));
                 },
                 kMisraX,
                 kMisraY,
                 {{500, 0.0001}, {300, 0.0002}},
                 {3.3799746163e+02, 3.9039091287e-04},
                 {3.1643950207e+00, 4.2547321834e-06},
                 7.5464681533e-02});
  all.push_back({"Misra1d",
                 [](const std::vector<Complex>& b, double x) {
                   return b[0] * b[1] * x / (1.0 + b[1] * x);
                 },
                 kMisraX,
                 kMisraY,
                 {{500, 0.0001}, {450, 0.0003}},
                 {4.3736970754e+02, 3.0227324449e-04},
                 {3.6489174345e+00, 2.9334354479e-06},
                 5.6419295283e-02});
  all.push_back({"BoxBOD",
                 [](const std::vector<Complex>& b, double x) {
                   return b[0] * (1.0 - std::exp(-b[1] * x));
                 },
                 {1, 2, 3, 5, 7, 10},
                 {109, 149, 149, 191, 213, 224},
                 {{100, 0.75}},  // the other start: see BoxBodNeedsSeveralStarts
                 {2.1380940889e+02, 5.4723748542e-01},
                 {1.2354515176e+01, 1.0455993237e-01},
                 1.1680088766e+03});
  all.push_back({"MGH10",
                 [](const std::vector<Complex>& b, double x) {
                   return b[0] * std::exp(b[1] / (x + b[2]));
                 },
                 {50, 55, 60, 65, 70, 75, 80, 85, 90, 95, 100, 105, 110, 115, 120, 125},
                 {34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744, 8261, 7030,
                  6005, 5147, 4427, 3820, 3307, 2872},
                 {{2, 400000, 25000}, {0.02, 4000, 250}},
                 {5.6096364710e-03, 6.1813463463e+03, 3.4522363462e+02},
                 {1.5687892471e-04, 2.3309021107e+01, 7.8486103508e-01},
                 8.7945855171e+01});
  all.push_back({"Rat42",
                 [](const std::vector<Complex>& b, double x) {
                   return b[0] / (1.0 + std::exp(b[1] - b[2] * x));
                 },
                 {9, 14, 21, 28, 42, 57, 63, 70, 79},
                 {8.93, 10.8, 18.59, 22.33, 39.35, 56.11, 61.73, 64.62, 67.08},
                 {{100, 1, 0.1}, {75, 2.5, 0.07}},
                 {7.2462237576e+01, 2.6180768402e+00, 6.7359200066e-02},
                 {1.7340283401e+00, 8.8295217536e-02, 3.4465663377e-03},
                 8.0565229338e+00});
  all.push_back(
      {"Thurber",
       [](const std::vector<Complex>& b, double x) {
         return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) /
                (1.0 + x * (b[4] + x * (b[5] + x * b[6])));
       },
       {-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
        -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
        -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
        0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
       {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,
        92.405,   95.854,   100.696,  101.060,  401.672,  390.724,  567.534,  635.316,
        733.054,  759.087,  894.206,  990.785,  1090.109, 1080.914, 1122.643, 1178.351,
        1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384,
        1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
       {{1000, 1000, 400, 40, 0.7, 0.3, 0.03}, {1300, 1500, 500, 75, 1, 0.4, 0.05}},
       {1.2881396800e+03, 1.4910792535e+03, 5.8323836877e+02, 7.5416644291e+01,
        9.6629502864e-01, 3.9797285797e-01, 4.9727297349e-02},
       {4.6647963344e+00, 3.9571156086e+01, 2.8698696102e+01, 5.5675370270e+00,
        3.1333340687e-02, 1.4984928198e-02, 6.5842344623e-03},
       5.6427082397e+03});
  return all;
}

// Derivatives by a step along the imaginary axis: exact to the last digit.
LeastSquaresProblem problem_of(const ReferenceSet& set) {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(set.x.size());
  problem.evaluate = [set](const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                           RowMajorMatrix* jacobian) {
    std::vector<Complex> b(q.data(), q.data() + q.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      r[i] = set.model(b, set.x[k]).real() - set.y[k];
      for (Eigen::Index j = 0; jacobian != nullptr && j < q.size(); ++j) {
        const auto m = static_cast<std::size_t>(j);
        const double h = 1e-30;
        b[m] += Complex(0.0, h);
        (*jacobian)(i, j) = set.model(b, set.x[k]).imag() / h;
        b[m] = q[j];
      }
    }
    return true;
  };
  return problem;
}

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                           static_cast<Eigen::Index>(values.size()));
}

constexpr LeastSquaresOptions kTight{0.0, 1e-16, 5000};

// Six digits in everything that is certified.
void expect_certified(const ReferenceSet& set, const LeastSquaresReport& report) {
  EXPECT_NEAR(2.0 * report.cost, set.sum_of_squares, 1e-6 * set.sum_of_squares);
  const Eigen::MatrixXd covariance =
      least_squares_covariance(problem_of(set), report.q);
  for (Eigen::Index j = 0; j < report.q.size(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    EXPECT_NEAR(report.q[j], set.value[k], 1e-6 * std::abs(set.value[k]))
        << "b" << j + 1;
    EXPECT_NEAR(std::sqrt(covariance(j, j)), set.sd[k], 1e-6 * set.sd[k])
        << "of b" << j + 1;
  }
}

TEST(LeastSquares, MeetsTheCertifiedValuesFromBothStarts) {
  for (const ReferenceSet& set : sets()) {
    for (const auto& start : set.starts) {
      SCOPED_TRACE(set.name);
      expect_certified(set,
                       solve_least_squares(problem_of(set), vector_of(start), kTight));
    }
  }
}

TEST(LeastSquares, BoxBodNeedsSeveralStarts) {
  const ReferenceSet set = sets()[3];
  ASSERT_EQ(set.name, "BoxBOD");
  std::vector<Eigen::VectorXd> starts{vector_of({1, 1})};
  for (const double rate : {0.1, 0.3, 1.0, 3.0}) {
    starts.push_back(vector_of({200, rate}));
  }
  expect_certified(set, solve_from_starts(problem_of(set), starts, kTight));
}

LeastSquaresProblem line(const std::vector<double>& y) {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(y.size());
  problem.evaluate = [y](const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                         RowMajorMatrix* jacobian) {
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const auto x = static_cast<double>(i);
      r[i] = q[0] + q[1] * x - y[static_cast<std::size_t>(i)];
      if (jacobian != nullptr) {
        jacobian->row(i) << 1.0, x;
      }
    }
    return true;
  };
  return problem;
}

TEST(LeastSquares, KeepsToBoundsAndLeavesThemOutOfTheCovariance) {
  LeastSquaresProblem problem = line({0, 1, 2, 3, 4.5});
  problem.lower = Eigen::Vector2d(0.5, -10.0);
  problem.upper = Eigen::Vector2d(10.0, 10.0);
  const auto report = solve_least_squares(problem, Eigen::Vector2d(1.0, 0.0));
  EXPECT_DOUBLE_EQ(report.q[0], 0.5);
  EXPECT_EQ(at_bound(problem, report.q), (std::vector<bool>{true, false}));
  const Eigen::MatrixXd covariance = least_squares_covariance(problem, report.q);
  EXPECT_EQ(covariance(0, 0), 0.0);
  // Slope alone: sum of squares / (5 - 1) over the sum of x^2 = 30.
  EXPECT_NEAR(covariance(1, 1), 2.0 * report.cost / 4.0 / 30.0, 1e-12);
}

TEST(LeastSquares, HoldsWhatIsHeld) {
  LeastSquaresProblem problem = line({1, 3, 5, 7});
  problem.held = {true, false};
  const auto report = solve_least_squares(problem, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(report.q[0], 0.0);
  EXPECT_NEAR(report.q[1], 34.0 / 14.0, 1e-7);  // sum x y / sum x^2
}

TEST(LeastSquares, ALossKeepsAnOutlierFromTheFit) {
  std::vector<double> y;
  for (int i = 0; i < 30; ++i) {
    y.push_back(2.0 + 0.5 * i + (i % 2 == 0 ? 0.01 : -0.01));
  }
  y[29] += 100.0;
  LeastSquaresOptions robust;
  robust.loss_scale = 0.03;
  const auto plain = solve_least_squares(line(y), Eigen::Vector2d(0.0, 0.0));
  const auto with = solve_least_squares(line(y), Eigen::Vector2d(1.5, 0.6), robust);
  EXPECT_GT(std::abs(plain.q[1] - 0.5), 0.3);
  EXPECT_NEAR(with.q[1], 0.5, 1e-3);
}

TEST(LeastSquares, AStartThatIsNoNumberIsToldByTheReportAlone) {
  const LeastSquaresProblem problem = line({1.0, 2.0, std::nan("")});
  testing::internal::CaptureStderr();
  const auto report = solve_least_squares(problem, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.cost, kInf);
}

// Derivatives far too small for the residuals, between bounds: no step leads down.
TEST(LeastSquares, AStepThatCannotBeFoundIsToldByTheReportAlone) {
  LeastSquaresProblem problem = line({0.0, 1.0, 4.0});
  problem.lower = Eigen::Vector2d::Zero();
  problem.upper = Eigen::Vector2d::Constant(1e3);
  problem.evaluate = [](const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                        RowMajorMatrix* jacobian) {
    for (int i = 0; i < 3; ++i) {
      r[i] = 1e100 * (q[0] + i * q[1] - i * i);
      if (jacobian != nullptr) {
        jacobian->row(i) << 1.0, i;
      }
    }
    return true;
  };
  testing::internal::CaptureStderr();
  const auto report = solve_least_squares(problem, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(report.q.allFinite());
}

TEST(LeastSquares, SaysThatParametersCannotBeToldApart) {
  Eigen::MatrixXd J(4, 2);
  J << 1, 2, 2, 4, 3, 6, 4, 8;
  EXPECT_TRUE(std::isnan(covariance_of(J, 1.0)(0, 0)));
}

}  // namespace
}  // namespace palpate

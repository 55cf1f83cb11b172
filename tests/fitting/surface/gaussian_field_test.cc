// The sparse process on a surface against the same process in dense algebra, and
// against what is known in closed form.
#include "fitting/surface/gaussian_field.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr FieldParameters kParameters{.length_m = 0.03, .sd = 0.6, .nugget_sd = 0.05};

std::vector<AttachedPoint> scattered(const SurfaceMesh& mesh, int count,
                                     unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<AttachedPoint> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(normal(generator), normal(generator), normal(generator));
    points.push_back(closest_surface_point(mesh, 0.05 * p.normalized()));
  }
  return points;
}

FieldData data_of(const FieldModel& model, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const auto m = static_cast<Eigen::Index>(model.point().size());
  FieldData data{Eigen::VectorXd(m), Eigen::VectorXd(m),
                 std::vector<char>(static_cast<std::size_t>(m), 1)};
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Vector3d p =
        position_m(model.mesh(), model.point()[static_cast<std::size_t>(i)]);
    data.value[i] = 1.0 + 20.0 * p.x() - 10.0 * p.z() + 0.05 * normal(generator);
    data.sd[i] = 0.02 + 0.01 * static_cast<double>(i % 4);
  }
  return data;
}

// The same model with every matrix written out: mean with a flat prior.
struct Dense {
  Eigen::MatrixXd Q_inverse, A, V_inverse, P;
  double log_likelihood = 0.0;

  Dense(const FieldModel& model, const FieldParameters& parameters,
        const FieldData& data) {
    const Eigen::Index m = data.value.size();
    Q_inverse = Eigen::MatrixXd(model.prior_precision(parameters)).inverse();
    A = Eigen::MatrixXd(model.attachment());
    Eigen::MatrixXd V = A * Q_inverse * A.transpose();
    V.diagonal().array() +=
        data.sd.array().square() + parameters.nugget_sd * parameters.nugget_sd;
    const Eigen::LLT<Eigen::MatrixXd> llt(V);
    V_inverse = llt.solve(Eigen::MatrixXd::Identity(m, m));
    const Eigen::VectorXd w = V_inverse.rowwise().sum();
    P = V_inverse - w * w.transpose() / w.sum();
    const Eigen::MatrixXd lower = llt.matrixL();
    log_likelihood =
        -0.5 * (2.0 * lower.diagonal().array().log().sum() + std::log(w.sum()) +
                data.value.dot(P * data.value) +
                static_cast<double>(m - 1) * std::log(2.0 * std::numbers::pi));
  }
};

class OnSphere : public testing::Test {
 protected:
  SurfaceMesh mesh_ = sphere_surface(0.05, 2);  // 162 nodes
  FieldModel model_{mesh_, scattered(mesh_, 40, 1)};
  FieldData data_ = data_of(model_, 2);
};

TEST_F(OnSphere, MarginalLikelihoodIsThatOfDenseAlgebra) {
  for (const int smoothness : {1, 2}) {
    for (const double length_m : {0.01, 0.03, 0.2}) {
      const FieldParameters p{
          .length_m = length_m, .sd = 0.6, .nugget_sd = 0.05, .smoothness = smoothness};
      const double dense = Dense(model_, p, data_).log_likelihood;
      EXPECT_NEAR(model_.log_marginal_likelihood(p, data_), dense,
                  1e-8 * std::abs(dense));
    }
  }
}

TEST_F(OnSphere, PosteriorIsThatOfDenseAlgebra) {
  const Dense dense(model_, kParameters, data_);
  const FieldPosterior sparse = model_.posterior(kParameters, data_);
  const Eigen::VectorXd w = dense.V_inverse.rowwise().sum();
  const double mu = w.dot(data_.value) / w.sum();
  const Eigen::MatrixXd K = dense.Q_inverse * dense.A.transpose();  // (n x m)
  const Eigen::VectorXd mean =
      (K * dense.V_inverse * (data_.value.array() - mu).matrix()).array() + mu;
  const Eigen::VectorXd loose = 1.0 - (K * w).array();
  const Eigen::VectorXd variance =
      (dense.Q_inverse - K * dense.V_inverse * K.transpose()).diagonal().array() +
      loose.array().square() / w.sum();
  EXPECT_NEAR(sparse.mean_level, mu, 1e-8);
  EXPECT_LT((sparse.mean - mean).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((sparse.sd - variance.cwiseSqrt()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_F(OnSphere, ClosedFormLeaveOneOutIsThatOfLeavingEachOut) {
  const FieldPosterior all = model_.posterior(kParameters, data_);
  for (std::size_t i = 0; i < 40; i += 7) {
    FieldData without = data_;
    without.used[i] = 0;
    const FieldPosterior left = model_.posterior(kParameters, without);
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(all.left_out_residual[k], left.left_out_residual[k], 1e-8);
    EXPECT_NEAR(all.left_out_sd[k], left.left_out_sd[k], 1e-8);
  }
}

TEST_F(OnSphere, DatumThatIsNotUsedIsAsGoodAsAbsent) {
  FieldData data = data_;
  data.used[3] = 0;
  data.value[3] = std::numeric_limits<double>::quiet_NaN();
  std::vector<AttachedPoint> points = model_.point();
  points.erase(points.begin() + 3);
  const FieldModel fewer(mesh_, points);
  FieldData rest;
  rest.used.assign(39, 1);
  rest.value.resize(39);
  rest.sd.resize(39);
  for (Eigen::Index i = 0; i < 39; ++i) {
    rest.value[i] = data_.value[i < 3 ? i : i + 1];
    rest.sd[i] = data_.sd[i < 3 ? i : i + 1];
  }
  const FieldPosterior a = model_.posterior(kParameters, data);
  const FieldPosterior b = fewer.posterior(kParameters, rest);
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-9 * std::abs(b.log_likelihood));
  EXPECT_LT((a.mean - b.mean).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_TRUE(std::isnan(a.left_out_residual[3]));
}

TEST_F(OnSphere, UnitDoesNotMatter) {
  SurfaceMesh larger = mesh_;
  larger.position_m *= 1000.0;
  FieldParameters p = kParameters;
  p.length_m *= 1000.0;
  const FieldModel model(larger, model_.point());
  const double small = model_.log_marginal_likelihood(kParameters, data_);
  EXPECT_NEAR(model.log_marginal_likelihood(p, data_), small, 1e-9 * std::abs(small));
}

// The prior's variance on a sphere of radius r in closed form: a sum over spherical
// harmonics, (4 pi r^2)^-1 sum (2l + 1) / (s (kappa^2 + l (l + 1) / r^2)^alpha).
class FieldPrior : public testing::TestWithParam<int> {};

TEST_P(FieldPrior, VarianceOnASphereConvergesToTheSumOverHarmonics) {
  constexpr double kRadius = 0.05;
  const int nu = GetParam();
  const FieldParameters p{
      .length_m = 0.04, .sd = 0.5, .nugget_sd = 0.1, .smoothness = nu};
  const double kappa2 = 2.0 * nu / (p.length_m * p.length_m);
  double series = 0.0;
  for (int l = 0; l < 20000; ++l) {
    const double eigenvalue = kappa2 + l * (l + 1.0) / (kRadius * kRadius);
    series += (2.0 * l + 1.0) / std::pow(eigenvalue, nu + 1);
  }
  const double exact =
      series * nu * std::pow(kappa2, nu) * p.sd * p.sd / (kRadius * kRadius);
  double previous = 1.0;
  for (const int refinements : {2, 3, 4}) {
    const SurfaceMesh mesh = sphere_surface(kRadius, refinements);
    const FieldModel model(mesh, {});
    SparseFactor factor(model.prior_precision(p));
    const double error =
        std::abs(SelectedInverse(factor).diagonal().mean() / exact - 1.0);
    EXPECT_LT(error, 0.45 * previous);  // order h^2 log h
    previous = error;
  }
  EXPECT_LT(previous, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Smoothness, FieldPrior, testing::Values(1, 2));

TEST(FieldPosterior, ConvergesUnderRefinement) {
  const auto sd_and_mean = [](int refinements) {
    const SurfaceMesh mesh = sphere_surface(0.05, refinements);
    const FieldModel model(mesh, scattered(sphere_surface(0.05, 1), 30, 4));
    std::vector<AttachedPoint> points;
    for (const AttachedPoint& p : model.point()) {
      points.push_back(closest_surface_point(
          mesh, 0.05 * position_m(sphere_surface(0.05, 1), p).normalized()));
    }
    const FieldModel attached(mesh, points);
    const FieldPosterior posterior =
        attached.posterior(kParameters, data_of(attached, 2));
    // Vertices of the coarsest mesh stay the first of every finer one.
    Eigen::VectorXd both(24);
    both << posterior.mean.head(12), posterior.sd.head(12);
    return both;
  };
  const Eigen::VectorXd finest = sd_and_mean(5);
  const double coarse = (sd_and_mean(2) - finest).norm();
  const double middle = (sd_and_mean(3) - finest).norm();
  const double fine = (sd_and_mean(4) - finest).norm();
  EXPECT_LT(middle, 0.6 * coarse);
  EXPECT_LT(fine, 0.6 * middle);
  EXPECT_LT(fine, 0.01 * finest.norm());
}

// A linear field through many data on a paraboloid lies e^2 lap / 16 below it at the
// nodes; at_nodes() does not.
TEST(FieldPosterior, ASagBetweenNodesIsTakenOff) {
  constexpr double kCurvature = 600.0;  // [1/m^2]
  constexpr double kCell = 0.01;        // [m]
  const auto field = [](const Eigen::Vector3d& p) {
    return 0.5 * kCurvature * p.head<2>().squaredNorm();
  };
  const SurfaceMesh mesh = plate(0.1, 10);
  const FieldModel model(mesh, scattered(mesh, 8000, 5));
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0.0, 0.01);
  FieldData data{.value = Eigen::VectorXd(8000),
                 .sd = Eigen::VectorXd::Constant(8000, 0.01),
                 .used = std::vector<char>(8000, 1)};
  for (Eigen::Index i = 0; i < 8000; ++i) {
    const AttachedPoint& at = model.point()[static_cast<std::size_t>(i)];
    data.value[i] = field(position_m(mesh, at)) + noise(random);
  }
  const FieldPosterior posterior =
      model.posterior({.length_m = 0.2, .sd = 2.0, .nugget_sd = 0.003}, data);
  double linear = 0.0;
  double taken_off = 0.0;
  int inside = 0;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    const Eigen::Vector3d p = mesh.position_m.row(v);
    if (p.head<2>().cwiseAbs().maxCoeff() < 0.035 && std::abs(p.z()) < 1e-9) {
      linear += posterior.mean[v] - field(p);
      taken_off += posterior.at_nodes()[v] - field(p);
      ++inside;
    }
  }
  ASSERT_GT(inside, 20);
  const double sag = kCell * kCell * 4.0 / 3.0 * 2.0 * kCurvature / 16.0;
  EXPECT_NEAR(linear / inside, -sag, 0.1 * sag);
  EXPECT_NEAR(taken_off / inside, 0.0, 0.1 * sag);
}

TEST(FieldModelInput, NamesWhatIsWrong) {
  const SurfaceMesh mesh = sphere_surface(0.05, 1);
  const FieldModel model(mesh, scattered(mesh, 5, 1));
  FieldData data = data_of(model, 1);
  EXPECT_THROW((void)model.posterior({0.0, 1.0, 0.1}, data), InputError);
  EXPECT_THROW((void)model.posterior({0.1, 1.0, NAN}, data), InputError);
  EXPECT_THROW((void)model.posterior({0.1, 1.0, 0.1, 3}, data), InputError);
  data.value[2] = NAN;
  EXPECT_THROW((void)model.posterior(kParameters, data), InputError);
  data.used = {1, 0, 0, 0, 0};
  EXPECT_THROW((void)model.posterior(kParameters, data), InputError);
  SurfaceMesh loose = mesh;
  loose.position_m.conservativeResize(loose.position_m.rows() + 1, Eigen::NoChange);
  loose.position_m.bottomRows<1>().setZero();
  EXPECT_THROW((void)FieldModel(loose, {}), InputError);
}

}  // namespace
}  // namespace palpate

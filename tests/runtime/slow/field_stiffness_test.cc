#include "runtime/slow/field_stiffness.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/fast/potential_field.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/slow/over_element.h"
#include "tests/bench/runtime/bench_signs.h"
#include "tests/bench/runtime/bench_slide.h"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double kRadiusM = 0.005;
constexpr double kSlopeNPerM = 1000.0;  // slide_body's

// Every node pushes by its own factor of the sphere's forces, and its own way.
ResponseDatabase discordant_body(double log_factor, double lean_rad, unsigned seed) {
  ResponseDatabase database = slide_body(200, kRadiusM, 0.0);
  make_discordant(database, database.tools.front(), log_factor, lean_rad, 0.0, seed);
  return database;
}

// The largest second difference of the energy over a line of `apart_m`, of so many
// places over every element: independent of forces and their derivatives.
double largest_bend_n_per_m(const ResponseDatabase& database, int places) {
  constexpr double kApartM = 1e-5;
  const ResponseTable& table = database.tools.front();
  const ElementStream stream(database, table);
  const auto cache = std::make_unique<ElementCache>();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> any;
  double largest = 0.0;
  for (std::int32_t t = 0; t < database.body.triangle.rows(); ++t) {
    const Element element = stream.element(t);
    *cache = {};
    store(*cache, element);
    for (int i = 0; i < places; ++i) {
      const double a = std::sqrt(part(random));
      const double b = part(random);
      const Vector3d share(1.0 - a, a * (1.0 - b), a * b);
      const double depth_m = table.depth_max_m() * std::cbrt(part(random));
      const Vector3d x = over_element(element, share).at(kRadiusM - depth_m);
      const Vector3d way =
          kApartM * Vector3d(any(random), any(random), any(random)).normalized();
      double bend_j = 0.0;
      bool sound = true;
      for (const auto& [at, times] : {std::pair{-1.0, 1.0}, {0.0, -2.0}, {1.0, 1.0}}) {
        FieldPlace place;
        adopt(place, *cache, find(*cache, t), x + at * way);
        sound = sound && !place.folded && !place.outside;
        CurvePieces pieces;
        bend_j += times * respond(place, *cache, kRadiusM, 0.0, pieces).energy_j;
      }
      if (sound) {
        largest = std::max(largest, bend_j / (kApartM * kApartM));
      }
    }
  }
  return largest;
}

TEST(FieldStiffness, OfNodesThatAgreeIsThatOfTheirCurves) {
  const ResponseDatabase body = slide_body(968, kRadiusM, 0.0);
  const FieldStiffening field = field_stiffening(body, body.tools.front());
  EXPECT_NEAR(field.inside, 1.0, 0.01);
  EXPECT_EQ(field.border, 1.0);  // there is none
}

TEST(FieldStiffness, OfNodesThatDoNotIsWhatTheEnergyBendsByBetweenThem) {
  for (const unsigned seed : {1U, 2U}) {
    for (const auto& [largest_log, lean_rad] :
         {std::pair{0.2, 0.1}, {0.7, 0.3}, {1.1, 0.78}}) {
      const ResponseDatabase body = discordant_body(largest_log, lean_rad, seed);
      const ResponseTable& table = body.tools.front();
      const RenderedStiffness of =
          model_stiffness(body, table, LocalModel::kPotential, 1e9);
      const double bent_n_per_m = largest_bend_n_per_m(body, 200);
      EXPECT_GT(of.normal_n_per_m, kSlopeNPerM);
      EXPECT_LT(bent_n_per_m, 1.05 * of.normal_n_per_m) << seed << " " << largest_log;
      EXPECT_GT(bent_n_per_m, 0.5 * of.normal_n_per_m) << seed << " " << largest_log;
      EXPECT_LT(rendered_stiffness(table, 1e9).normal_n_per_m,
                largest_log < 0.5 ? 1.01 * of.normal_n_per_m : 0.9 * of.normal_n_per_m);
    }
  }
}

TEST(FieldStiffness, TheBorderOfTheReachIsToldByItself) {
  ResponseDatabase body = slide_body(200, kRadiusM, 0.0);
  std::vector<NodeResponse> responses(
      static_cast<std::size_t>(body.body.position_m.rows()));
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (body.normal(row, 2) > 0.0) {
      responses[i] = {.direction = body.normal.row(row).transpose(),
                      .depth_m = {0.0, 0.003, 0.006},
                      .force_n = {0.0, 3.0, 6.0},
                      .origin = ResponseOrigin::kSimulated};
    }
  }
  body.tools = {make_table(body.tools.front().tool, responses)};
  const RenderedStiffness of =
      model_stiffness(body, body.tools.front(), LocalModel::kPotential, 1e9);
  EXPECT_NEAR(of.normal_n_per_m, kSlopeNPerM, 10.0);
  EXPECT_GT(of.border_n_per_m, kSlopeNPerM);
  EXPECT_EQ(of.largest_n_per_m(), of.normal_n_per_m);
}

TEST(FieldStiffness, OtherModelsHaveTheCurves) {
  const ResponseDatabase body = discordant_body(0.7, 0.3, 1);
  const ResponseTable& table = body.tools.front();
  for (const LocalModel model : {LocalModel::kElement, LocalModel::kFacets}) {
    EXPECT_EQ(model_stiffness(body, table, model, 1e9).normal_n_per_m,
              rendered_stiffness(table, 1e9).normal_n_per_m);
  }
}

}  // namespace
}  // namespace palpate

// What a fit did not find is no key of a scene.
#include "fitting/insertion/insertion_scene.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

IntervalEstimate found_to_be(double value) {
  return {.value = value, .sd = 0.1, .low = value - 0.2, .high = value + 0.2};
}

IntervalEstimate not_found() {
  IntervalEstimate none;
  none.refused = "of a reason";
  return none;
}

NeedleFit fit_of_two_layers() {
  NeedleFit fit;
  fit.ruptures.resize(2);
  fit.layers.resize(2);
  fit.ruptures[0].force_n = found_to_be(2.0);
  fit.ruptures[1].force_n = found_to_be(1.0);
  fit.ruptures[1].boundary_m = found_to_be(0.006);
  for (FittedLayer& layer : fit.layers) {
    layer.cutting_n = found_to_be(0.5);
    layer.friction_n_per_m = found_to_be(20.0);
  }
  fit.static_ratio = found_to_be(1.3);
  fit.presliding_n_per_m = found_to_be(3000.0);
  return fit;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST(InsertionScene, HasAKeyForWhatWasFound) {
  const std::string text = insertion_scene(fit_of_two_layers(), 0.001);
  EXPECT_TRUE(has(text, "thickness_m = 0.006\n")) << text;
  EXPECT_TRUE(has(text,
                  "puncture = { toughness_j_per_m2 = 500, friction_n_per_m = 20, "
                  "static_ratio = 1.3, membrane_n = 2 }"))
      << text;
  EXPECT_TRUE(has(text, "puncture = { shaft_n_per_m = 3000 }")) << text;
  EXPECT_FALSE(has(text, "reason")) << text;
}

TEST(InsertionScene, SaysWhyAKeyIsMissing) {
  NeedleFit fit = fit_of_two_layers();
  fit.layers[0].friction_n_per_m = not_found();
  fit.presliding_n_per_m = not_found();
  const std::string text = insertion_scene(fit, 0.001);
  EXPECT_TRUE(has(text, "# friction_n_per_m: of a reason\n")) << text;
  EXPECT_TRUE(has(text, "# shaft_n_per_m: of a reason\n")) << text;
  // A ratio without friction is no key either.
  EXPECT_TRUE(has(text, "{ toughness_j_per_m2 = 500, membrane_n = 2 }")) << text;
  EXPECT_FALSE(has(text, "shaft_n_per_m =")) << text;
}

// Noise may put an estimate beyond what a scene takes.
TEST(InsertionScene, KeysStayInTheirRanges) {
  NeedleFit fit = fit_of_two_layers();
  fit.static_ratio = found_to_be(0.9);
  fit.layers[1].cutting_n = found_to_be(-0.01);
  const std::string text = insertion_scene(fit, 0.001);
  EXPECT_TRUE(has(text, "static_ratio = 1,")) << text;
  EXPECT_TRUE(has(text, "toughness_j_per_m2 = 0,")) << text;
}

TEST(InsertionScene, WithoutACuttingForceOrABoundaryThereIsNone) {
  NeedleFit fit = fit_of_two_layers();
  fit.layers[1].cutting_n = not_found();
  EXPECT_THROW((void)insertion_scene(fit, 0.001), InputError);
  fit = fit_of_two_layers();
  fit.ruptures[1].boundary_m = not_found();
  EXPECT_THROW((void)insertion_scene(fit, 0.001), InputError);
}

}  // namespace
}  // namespace palpate

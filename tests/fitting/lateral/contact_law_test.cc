#include "fitting/lateral/contact_law.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr ContactLaw kBothLaws[] = {ContactLaw::kSharpSlip, ContactLaw::kPartialSlip};

// k = 2000 N/m, S = 0.5 N: x_p = 0.25 mm, x_s = 0.375 mm.
ContactCurve contact_curve(ContactLaw law, double instrument_n_per_m = HUGE_VAL) {
  return {law, 2000.0, 0.5, instrument_n_per_m};
}

TEST(ContactLaw, BothBeginWithTheStiffnessAndEndSliding) {
  for (const ContactLaw law : kBothLaws) {
    const ContactCurve curve = contact_curve(law);
    EXPECT_NEAR(0.5 * force_share(curve, 1e-9).value / 1e-9, 2000.0, 1e-2);
    EXPECT_NEAR(0.5 * force_share(curve, 0.0).by_u, 2000.0, 1e-9);
    EXPECT_EQ(force_share(curve, curve.slides_at_m()).value, 1.0);
    EXPECT_EQ(force_share(curve, 1.0).by_u, 0.0);
  }
}

// Mindlin 1949: Q = mu N (1 - (1 - x/x_s)^(3/2)), x_s = 3/2 mu N / k.
TEST(ContactLaw, PartialSlipIsMindlins) {
  const ContactCurve curve = contact_curve(ContactLaw::kPartialSlip);
  EXPECT_DOUBLE_EQ(curve.slides_at_m(), 0.375e-3);
  for (const double part : {0.1, 0.5, 0.75, 0.99}) {
    EXPECT_NEAR(force_share(curve, part * 0.375e-3).value,
                1.0 - std::pow(1.0 - part, 1.5), 1e-14);
  }
  EXPECT_DOUBLE_EQ(force_share(contact_curve(ContactLaw::kSharpSlip), 0.1e-3).value,
                   0.4);
}

// u = u_c + q / k_i
TEST(ContactLaw, AnInstrumentInSeriesAddsItsDeflection) {
  for (const ContactLaw law : kBothLaws) {
    for (const double u_c : {0.02e-3, 0.1e-3, 0.2e-3}) {
      const double share = force_share(contact_curve(law), u_c).value;
      const double u = u_c + 0.5 * share / 700.0;
      EXPECT_NEAR(force_share(contact_curve(law, 700.0), u).value, share, 1e-13);
    }
  }
}

TEST(ContactLaw, DerivativesAreThoseOfTheCurve) {
  for (const ContactLaw law : kBothLaws) {
    for (const double instrument : {HUGE_VAL, 1500.0}) {
      const double u = 0.15e-3, step = 1e-6;
      const auto at = [&](double place, double by_k, double by_slip) {
        ContactCurve curve = contact_curve(law, instrument);
        curve.stiffness_n_per_m *= std::exp(by_k);
        curve.slip_force_n *= std::exp(by_slip);
        return force_share(curve, place).value;
      };
      const CurveShare share = force_share(contact_curve(law, instrument), u);
      // Central differences of relative step 1e-6: errors of 1e-12 over 1e-6.
      EXPECT_NEAR(
          (at(u * (1.0 + step), 0, 0) - at(u * (1.0 - step), 0, 0)) / (2.0 * step),
          share.by_u * u, 1e-8);
      EXPECT_NEAR((at(u, step, 0) - at(u, -step, 0)) / (2.0 * step), share.by_log_k,
                  1e-8);
      EXPECT_NEAR((at(u, 0, step) - at(u, 0, -step)) / (2.0 * step), share.by_log_slip,
                  1e-8);
    }
  }
}

// 4 S (X - x_p), and 4 S (X - 4/5 x_s) of partial slip, where all slides.
TEST(ContactLaw, LossOfALoopThatSlides) {
  EXPECT_NEAR(loop_loss_j(contact_curve(ContactLaw::kSharpSlip), 1e-3), 1.5e-3, 1e-15);
  EXPECT_NEAR(loop_loss_j(contact_curve(ContactLaw::kPartialSlip), 1e-3), 1.4e-3,
              1e-15);
  EXPECT_EQ(loop_loss_j(contact_curve(ContactLaw::kSharpSlip), 0.2e-3), 0.0);
  EXPECT_GT(loop_loss_j(contact_curve(ContactLaw::kPartialSlip), 0.2e-3), 0.0);
  // The instrument takes 0.5 N / 500 N/m of the amplitude.
  EXPECT_NEAR(loop_loss_j(contact_curve(ContactLaw::kSharpSlip, 500.0), 2e-3), 1.5e-3,
              1e-15);
}

}  // namespace
}  // namespace palpate

// Elementary functions with the same bits on every processor.
//
// The C library's choose by the processor: with fused multiply-add where there is any,
// without elsewhere, and round otherwise. A build would be another on each, and where a
// body is symmetric, choose other places. What is computed for a database calls these;
// .ci/rooms looks. All have the bits of SLEEF's functions without fused operations
// (Shibata and Petrogalli 2020; version 3.5.1 for amd64). They are right to 1 unit in
// the last place (erfc 1.5).
#pragma once

namespace palpate::reproducible {

double exp(double x);
/// exp(x) - 1, without cancellation.
double expm1(double x);
double log(double x);
/// log(1 + x), without cancellation.
double log1p(double x);
double pow(double x, double y);
double cbrt(double x);

/// Sine, cosine and tangent: NaN for |x| >= 1e14.
double sin(double x);
double cos(double x);
double tan(double x);
double tanh(double x);
double acos(double x);
/// [rad] [-pi, pi].
double atan2(double y, double x);
/// Complementary error function.
double erfc(double x);

}  // namespace palpate::reproducible

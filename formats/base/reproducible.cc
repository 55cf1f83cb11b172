#include "formats/base/reproducible.h"

#include <sleef.h>

namespace palpate::reproducible {

double exp(double x) {
  return Sleef_cinz_expd1_u10purec(x);
}
double expm1(double x) {
  return Sleef_cinz_expm1d1_u10purec(x);
}
double log(double x) {
  return Sleef_cinz_logd1_u10purec(x);
}
double log1p(double x) {
  return Sleef_cinz_log1pd1_u10purec(x);
}
double pow(double x, double y) {
  return Sleef_cinz_powd1_u10purec(x, y);
}
double cbrt(double x) {
  return Sleef_cinz_cbrtd1_u10purec(x);
}
double sin(double x) {
  return Sleef_cinz_sind1_u10purec(x);
}
double cos(double x) {
  return Sleef_cinz_cosd1_u10purec(x);
}
double tan(double x) {
  return Sleef_cinz_tand1_u10purec(x);
}
double tanh(double x) {
  return Sleef_cinz_tanhd1_u10purec(x);
}
double acos(double x) {
  return Sleef_cinz_acosd1_u10purec(x);
}
double atan2(double y, double x) {
  return Sleef_cinz_atan2d1_u10purec(y, x);
}
double erfc(double x) {
  return Sleef_cinz_erfcd1_u15purec(x);
}

}  // namespace palpate::reproducible

#include "formats/base/units.h"

#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

struct Unit {
  std::string_view name;
  double si;
};

constexpr Unit kLengths[] = {{"m", 1.0},   {"dm", 0.1},  {"cm", 0.01}, {"mm", 1e-3},
                             {"um", 1e-6}, {"µm", 1e-6}, {"nm", 1e-9}, {"in", 0.0254}};
// Standard gravity 9.80665 m/s^2 is exact by definition (CGPM 1901), the pound
// 0.45359237 kg (international yard and pound agreement, 1959).
constexpr Unit kForces[] = {
    {"kN", 1e3},   {"daN", 10.0},      {"N", 1.0},       {"cN", 0.01},
    {"mN", 1e-3},  {"uN", 1e-6},       {"µN", 1e-6},     {"nN", 1e-9},
    {"pN", 1e-12}, {"gf", 9.80665e-3}, {"kgf", 9.80665}, {"lbf", 0.45359237 * 9.80665}};
constexpr Unit kTimes[] = {{"s", 1.0},   {"sec", 1.0}, {"ms", 1e-3}, {"us", 1e-6},
                           {"µs", 1e-6}, {"ns", 1e-9}, {"min", 60.0}};

// Files write the prefix as the micro sign, as in the tables, or as the Greek letter.
std::string with_micro_sign(std::string_view unit) {
  constexpr std::string_view kMu = "\xCE\xBC", kMicro = "\xC2\xB5";
  return std::string(unit.starts_with(kMu) ? kMicro : "") +
         std::string(unit.substr(unit.starts_with(kMu) ? kMu.size() : 0));
}

double find(std::span<const Unit> units, std::string_view name, std::string_view what) {
  std::string known;
  for (const Unit& unit : units) {
    if (unit.name == with_micro_sign(name)) {
      return unit.si;
    }
    known += fmt::format("{}{}", known.empty() ? "" : ", ", unit.name);
  }
  throw InputError(fmt::format("unknown {} unit \"{}\"; known: {}", what, name, known));
}

}  // namespace

double metres_per(std::string_view unit) {
  return find(kLengths, unit, "length");
}

double newtons_per(std::string_view unit) {
  return find(kForces, unit, "force");
}

double seconds_per(std::string_view unit) {
  std::string lower(unit);
  for (char& c : lower) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return find(kTimes, lower, "time");
}

}  // namespace palpate

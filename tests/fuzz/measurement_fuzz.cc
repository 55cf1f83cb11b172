// Any bytes as a measurement: read, or refused with an Error.
#include "formats/base/error.h"
#include "formats/measurement/measurement_file.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static palpate::InputFile file(".csv");
  try {
    const palpate::MeasurementFile read = palpate::read_measurement(
        file.with(data, size), {"1", "mm"}, {"2", "N"}, palpate::HeaderUnits::kIgnored);
    if (read.samples.depth_m.size() != read.samples.force_n.size()) {
      __builtin_trap();
    }
  } catch (const palpate::Error&) {
  }
  return 0;
}

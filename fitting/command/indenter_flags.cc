#include "fitting/command/indenter_flags.h"

namespace palpate {

void add_indenter_options(Command command, IndenterOptions& options) {
  command.add_option("--tool", options.shape,
                     "what pressed: sphere, flat-punch, cone, plate");
  command.add_option("--radius-m", options.radius_m,
                     "of the sphere or punch, or of the cylinder under the plate");
  command.add_option("--half-angle-deg", options.half_angle_deg,
                     "of the cone, from its axis");
  command.add_option("--height-m", options.height_m, "of the cylinder under the plate");
  command.add_option("--thickness-m", options.thickness_m,
                     "of the layer under a sphere or punch, bonded to a rigid base");
  command.add_option("--poissons-ratio", options.poissons_ratio, "of the sample")
      .show_default();
  constexpr const char* kDeviation =
      "its standard deviation, for the modulus' interval";
  command.add_option("--radius-sd-m", options.radius_sd_m, kDeviation);
  command.add_option("--half-angle-sd-deg", options.half_angle_sd_deg, kDeviation);
  command.add_option("--height-sd-m", options.height_sd_m, kDeviation);
  command.add_option("--thickness-sd-m", options.thickness_sd_m, kDeviation);
  command.add_option("--poissons-ratio-sd", options.poissons_ratio_sd, kDeviation);
}

}  // namespace palpate

#include "runtime/attach/device_factory.h"

#include "runtime/attach/placed_device.h"
#include "runtime/device/threaded_device.h"

namespace palpate {

AttachedDevice attach(const DeviceLimits& limits, const Eigen::Vector3d& rest_m,
                      const MakeLink& link, const std::optional<SectionPlane>& plane) {
  return {.limits = limits,
          .make = [link, rest_m,
                   plane](const HandScript& script) -> std::unique_ptr<Device> {
            const Placement placement = plane ? placement_in(*plane, script, rest_m)
                                              : placement_over(script, rest_m);
            return std::make_unique<PlacedDevice>(
                std::make_unique<LinkedDevice>(link(in_device_frame(script, placement)),
                                               LinkTiming{}),
                placement);
          }};
}

AttachedDevice attach_driven(const DeviceLimits& limits, const Eigen::Vector3d& rest_m,
                             const MakeDriver& driver) {
  return {
      .limits = limits,
      .make = [driver, rest_m](const HandScript& script) -> std::unique_ptr<Device> {
        const Placement placement = placement_over(script, rest_m);
        return std::make_unique<PlacedDevice>(
            std::make_unique<DrivenDevice>(driver(in_device_frame(script, placement))),
            placement);
      }};
}

}  // namespace palpate

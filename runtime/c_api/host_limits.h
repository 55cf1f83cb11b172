// What a host's device allows: limits of the force, and how stiff a body may be.
#pragma once

#include "formats/response/tool_shape.h"
#include "runtime/c_api/host_tool.h"
#include "runtime/device/stability_margin.h"
#include "runtime/slow/contact_stiffness.h"

namespace palpate {

/// Limits of the force inside the host, so that they hold at the device.
[[nodiscard]] FastConfig fast_config(const HostOptions& options, const ToolShape& tool);

/// Scale of forces [-] (0, 1] that the device can render; 1 where its damping is not
/// known. @throws InputError with the reason where it is below 1, unless
/// options.limit_stiffness.
[[nodiscard]] double renderable_scale(const HostOptions& options,
                                      RenderedStiffness stiffness);
/// The same of several contacts, in six axes.
[[nodiscard]] double contacts_scale(const HostOptions& options,
                                    const ContactStiffness& contacts);

/// [N/m] the stiffest that the device can render, as it is inside the host; infinite
/// where the device's damping is not known.
[[nodiscard]] double renderable_n_per_m(const HostOptions& options);

}  // namespace palpate

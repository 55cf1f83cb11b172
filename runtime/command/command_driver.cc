// `palpate-run driver`: what a device in a process of its own is driven by; started by
// `palpate-run device`, which holds the other end of the socket.
#include <csignal>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include "formats/base/error.h"
#include "runtime/attach/driven_devices.h"
#include "runtime/command/commands.h"
#include "runtime/command/device_options.h"
#include "runtime/device/device_driver.h"

namespace palpate {
namespace {

struct DriverFlags {
  DeviceFlags device;
  int descriptor = -1;
};

void check_socket(int descriptor) {
  int type = 0;
  socklen_t size = sizeof type;
  if (::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 ||
      type != SOCK_SEQPACKET) {
    throw InputError(fmt::format(
        "--descriptor {}: must be an open socket of datagrams in order", descriptor));
  }
  ::fcntl(descriptor, F_SETFD, FD_CLOEXEC);
}

// The renderer's end of the socket decides when a driver ends: Ctrl-C reaches both.
void drive(DriverFlags& flags) {
  check_socket(flags.descriptor);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, SIG_IGN);
  }
  DeviceRequest& request = flags.device.request;
  request.sign_test = !flags.device.no_sign_test;
  request.tell = tell_person;
  request.stopped = [descriptor = flags.descriptor] {
    return is_hung_up(descriptor);
  };
  const std::unique_ptr<DeviceLink> link = driver_link(request);
  // What went wrong is said to the renderer, which says it to the person.
  static_cast<void>(serve_device(*link, flags.descriptor, {}));
}

}  // namespace

void add_driver_command(Command app) {
  Command command = app.add_subcommand(
      "driver", "Drive a device for a renderer at the other end of a socket.");
  const auto flags = std::make_shared<DriverFlags>();
  add_device_options(command, flags->device);
  command.option("--device").required();
  command.add_option("--descriptor", flags->descriptor, "This end of the socket, open")
      .required();
  command.callback([flags] {
    drive(*flags);
  });
}

}  // namespace palpate

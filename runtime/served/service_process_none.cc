// Where palpate-precompute does not run, no service is started.
#include "formats/base/error.h"
#include "runtime/served/service_process.h"

namespace palpate {

std::filesystem::path find_server(const std::filesystem::path& /*given*/) {
  throw InputError(
      "palpate-precompute does not run on this system: give the database that it made "
      "of the scene");
}

ServiceProcess::ServiceProcess(const ServiceCommand& command) {
  static_cast<void>(find_server(command.program));
}

ServiceProcess::~ServiceProcess() = default;

std::optional<int> ServiceProcess::exit_code() noexcept {
  return kReapedElsewhere;
}

}  // namespace palpate

#include "runtime/served/join_scene.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/service/service_socket.h"
#include "runtime/served/service_process.h"

namespace palpate {

std::unique_ptr<ServedClient> join_scene(const SceneRequest& request) {
  if (!std::filesystem::is_regular_file(request.scene)) {
    throw InputError(fmt::format("{}: no such scene", request.scene.string()));
  }
  std::string text = read_file(request.scene);
  ServiceCommand command{
      .program = {},
      .scene = request.scene,
      .output = request.output.empty() ? served_output(request.scene) : request.output};
  const std::filesystem::path socket = service_socket(command.output);
  return std::make_unique<ServedClient>(ServedClientOptions{
      .socket = socket,
      .tool = request.tool,
      .text = std::move(text),
      .start =
          [command = std::move(command), server = request.server](bool anew) mutable {
            command.program = find_server(server);
            command.anew = anew;
            return std::make_unique<ServiceProcess>(command);
          },
      .estimate = request.estimate});
}

}  // namespace palpate

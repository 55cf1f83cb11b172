// `palpate-precompute serve` as a process of its own: nothing of it is linked here.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace palpate {

/// Where the database of a served scene goes unless stated otherwise: "NAME.h5" in the
/// present folder, as `palpate-precompute serve` has it.
[[nodiscard]] inline std::filesystem::path served_output(
    const std::filesystem::path& scene) {
  return scene.stem().string() + ".h5";
}

/// The program: what is given, else `palpate-precompute` beside this executable, else
/// in PATH. @throws InputError if there is none.
[[nodiscard]] std::filesystem::path find_server(const std::filesystem::path& given);

struct ServiceCommand {
  std::filesystem::path program;
  std::filesystem::path scene;
  std::filesystem::path output;
  bool anew = false;  ///< what was computed for another scene is dropped
};

/// A service that this process started and that ends with it. The service ends by
/// SIGTERM, on which it keeps its checkpoint. Where this process is killed, it ends by
/// itself (--with). The service stands in a process group of its own, so that Ctrl-C is
/// this process' to handle. The service has the usual scheduling and no descriptors but
/// its streams. What the service says on either goes to this process' stderr.
class ServiceProcess {
 public:
  /// Longest time that a service has to end in before it is killed.
  static constexpr std::chrono::milliseconds kPatience{5000};

  /// @throws InputError if the program cannot be started.
  explicit ServiceProcess(const ServiceCommand& command);
  ~ServiceProcess();
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;

  /// What is not known of a child that this program has the system reap (SIGCHLD that
  /// is ignored).
  static constexpr int kReapedElsewhere = -1;

  /// Its exit code once it has ended, 128 + n by signal n; none while it runs.
  [[nodiscard]] std::optional<int> exit_code() noexcept;

  [[nodiscard]] int id() const noexcept { return id_; }

 private:
  int id_ = -1;
  std::optional<int> exit_code_;
};

}  // namespace palpate

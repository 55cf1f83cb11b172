// A stand-in library, and what a test sees of its insides.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <dlfcn.h>

namespace palpate::test {

class VendorLibrary {
 public:
  explicit VendorLibrary(const std::string& file)
      : path_((std::filesystem::read_symlink("/proc/self/exe").parent_path() /
               "stand_ins" / file)
                  .string()),
        handle_(::dlopen(path_.c_str(), RTLD_NOW | RTLD_LOCAL)) {}
  ~VendorLibrary() { ::dlclose(handle_); }
  VendorLibrary(const VendorLibrary&) = delete;
  VendorLibrary& operator=(const VendorLibrary&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

  template <typename Type>
  [[nodiscard]] Type& variable(const char* name) const {
    return *static_cast<Type*>(::dlsym(handle_, name));
  }

  template <typename Function>
  [[nodiscard]] Function* function(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(handle_, name));
  }

  /// [N] of the motors, in the library's axes.
  [[nodiscard]] Eigen::Vector3d force_n() const {
    Eigen::Vector3d force;
    function<void(double*)>("stand_in_force")(force.data());
    return force;
  }

 private:
  std::string path_;
  void* handle_;
};

}  // namespace palpate::test

#include "runtime/vendor/shared_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

SharedLibrary::SharedLibrary(const std::string& name, const std::string& maker)
    : name_(name), handle_(::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) {
    const char* why = ::dlerror();
    throw DeviceError(
        fmt::format("{} of {} cannot be loaded ({}): install it, or name its folder in "
                    "LD_LIBRARY_PATH",
                    name, maker, why == nullptr ? "no reason given" : why));
  }
}

SharedLibrary::~SharedLibrary() {
  ::dlclose(handle_);
}

void* SharedLibrary::symbol_if_there(const char* name) const noexcept {
  return ::dlsym(handle_, name);
}

void* SharedLibrary::symbol(const char* name) const {
  void* const found = symbol_if_there(name);
  if (found == nullptr) {
    throw DeviceError(fmt::format(
        "{} has no {}(): another version than this driver knows", name_, name));
  }
  return found;
}

}  // namespace palpate

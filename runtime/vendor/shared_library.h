// A vendor's library that the user has, loaded when a device of theirs is opened.
// Nothing of it is needed to build palpate, or shipped with it.
#pragma once

#include <string>

namespace palpate {

class SharedLibrary {
 public:
  /// @param name as for dlopen(). @param maker who has it, for the message.
  /// @throws DeviceError, one sentence, where it cannot be loaded.
  SharedLibrary(const std::string& name, const std::string& maker);
  ~SharedLibrary();
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;

  /// @throws DeviceError where the library has no function of that name.
  template <typename Function>
  void find(const char* name, Function*& function) const {
    function = reinterpret_cast<Function*>(symbol(name));
  }

  /// Null where the library has none.
  template <typename Function>
  void find_if_there(const char* name, Function*& function) const noexcept {
    function = reinterpret_cast<Function*>(symbol_if_there(name));
  }

 private:
  [[nodiscard]] void* symbol(const char* name) const;
  [[nodiscard]] void* symbol_if_there(const char* name) const noexcept;

  std::string name_;
  void* handle_ = nullptr;
};

}  // namespace palpate

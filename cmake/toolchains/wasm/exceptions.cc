// Exceptions for WebAssembly: Debian's libc++abi for wasm32 has none. What the compiler
// calls with -fwasm-exceptions, as the Itanium C++ ABI (level II) and the tool
// conventions of WebAssembly say it. One thread. Types and the rules by which a handler
// catches a type are libc++abi's.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <typeinfo>

namespace __cxxabiv1 {

// libc++abi's base of all its type_info, declared as it declares it.
class __shim_type_info : public std::type_info {
 public:
  ~__shim_type_info() override;
  virtual void noop1() const;
  virtual void noop2() const;
  virtual bool can_catch(const __shim_type_info* thrown, void*& adjusted) const = 0;
};

}  // namespace __cxxabiv1

// The tag of C++ exceptions; its value is the address of a Thrown.
__asm__(
    ".globl __cpp_exception\n"
    ".tagtype __cpp_exception i32\n"
    "__cpp_exception:\n");

namespace {

using __cxxabiv1::__shim_type_info;

// Before the object that was thrown.
struct alignas(16) Thrown {
  const std::type_info* type = nullptr;
  void* (*destroy)(void*) = nullptr;  // a destructor returns its argument here
  void* adjusted = nullptr;           // to the type that the handler has
  Thrown* caught_before = nullptr;    // by a handler that is still under way
  int handlers = 0;                   // under way
  int references = 0;                 // of handlers as one, and of std::exception_ptr
  Thrown* primary =
      nullptr;  // of what std::rethrow_exception() throws: whose object it is
  bool thrown_again = false;
};

Thrown* caught = nullptr;
int uncaught = 0;

void* object_of(Thrown* thrown) {
  return (thrown->primary != nullptr ? thrown->primary : thrown) + 1;
}
Thrown* thrown_of(void* object) {
  return static_cast<Thrown*>(object) - 1;
}

void release(Thrown* thrown) {
  if (--thrown->references == 0) {
    if (thrown->primary != nullptr) {
      release(thrown->primary);
    } else if (thrown->destroy != nullptr) {
      thrown->destroy(object_of(thrown));
    }
    std::free(thrown);
  }
}

[[noreturn]] void raise(Thrown* thrown) {
  ++uncaught;
  __builtin_wasm_throw(0, thrown);
}

std::uintptr_t read_uleb(const std::uint8_t*& at) {
  std::uintptr_t value = 0;
  int shift = 0;
  do {
    value |= static_cast<std::uintptr_t>(*at & 0x7f) << shift;
    shift += 7;
  } while ((*at++ & 0x80) != 0);
  return value;
}

std::intptr_t read_sleb(const std::uint8_t*& at) {
  const std::uint8_t* last = at;
  const int bits = [&] {
    while ((*last & 0x80) != 0) {
      ++last;
    }
    return 7 * static_cast<int>(last - at + 1);
  }();
  const auto value = static_cast<std::intptr_t>(read_uleb(at));
  return bits < 32 && (*last & 0x40) != 0 ? value | -(std::intptr_t{1} << bits) : value;
}

// What a landing pad wants of a table (LSDA), and what it gets.
extern "C" struct LandingPad {
  std::uintptr_t index;
  const std::uint8_t* table;
  std::uintptr_t selector;
} __wasm_lpad_context = {};

// The first type of the action's chain that catches it; 0: none does.
std::intptr_t selector_of(const std::uint8_t* action, const std::uint8_t* types,
                          Thrown* thrown) {
  for (;;) {
    const std::intptr_t filter = read_sleb(action);
    if (filter > 0) {
      const auto* const type = static_cast<const __shim_type_info*>(
          reinterpret_cast<const std::type_info* const*>(types)[-filter]);
      void* adjusted = object_of(thrown);
      if (type == nullptr ||
          type->can_catch(static_cast<const __shim_type_info*>(thrown->type),
                          adjusted)) {
        thrown->adjusted = adjusted;
        return filter;
      }
    }
    const std::uint8_t* const next = action;
    const std::intptr_t offset = read_sleb(action);
    if (offset == 0) {
      return 0;
    }
    action = next + offset;
  }
}

}  // namespace

extern "C" {

void* __cxa_allocate_exception(std::size_t bytes) noexcept {
  auto* const thrown = static_cast<Thrown*>(std::calloc(1, sizeof(Thrown) + bytes));
  if (thrown == nullptr) {
    std::terminate();
  }
  return thrown + 1;
}

void __cxa_free_exception(void* object) noexcept {
  std::free(thrown_of(object));
}

[[noreturn]] void __cxa_throw(void* object, std::type_info* type,
                              void* (*destroy)(void*)) {
  Thrown* const thrown = thrown_of(object);
  *thrown = {.type = type, .destroy = destroy, .adjusted = object, .references = 1};
  raise(thrown);
}

// Called by a landing pad, to tell by which of its handlers an exception is caught.
int _Unwind_CallPersonality(void* exception) {
  constexpr std::uint8_t kOmitted = 0xff;
  auto* const thrown = static_cast<Thrown*>(exception);
  const std::uint8_t* at = __wasm_lpad_context.table;
  if (*at++ != kOmitted) {
    read_uleb(at);  // begin of landing pads
  }
  const std::uint8_t* types = nullptr;
  if (*at++ != kOmitted) {
    const std::uintptr_t offset = read_uleb(at);
    types = at + offset;
  }
  ++at;  // encoding of call sites
  const std::uintptr_t bytes = read_uleb(at);
  const std::uint8_t* const actions = at + bytes;
  std::uintptr_t action = 0;
  for (std::uintptr_t site = 0; site <= __wasm_lpad_context.index; ++site) {
    read_uleb(at);  // landing pad
    action = read_uleb(at);
  }
  __wasm_lpad_context.selector = action == 0
                                     ? 0
                                     : static_cast<std::uintptr_t>(selector_of(
                                           actions + action - 1, types, thrown));
  return 0;
}

void* __cxa_get_exception_ptr(void* exception) noexcept {
  return static_cast<Thrown*>(exception)->adjusted;
}

void* __cxa_begin_catch(void* exception) noexcept {
  auto* const thrown = static_cast<Thrown*>(exception);
  if (thrown != caught) {
    thrown->caught_before = caught;
    caught = thrown;
  }
  thrown->thrown_again = false;
  ++thrown->handlers;
  --uncaught;
  return thrown->adjusted;
}

void __cxa_end_catch() noexcept {
  Thrown* const thrown = caught;
  if (thrown == nullptr || --thrown->handlers > 0) {
    return;
  }
  caught = thrown->caught_before;
  if (!thrown->thrown_again) {
    release(thrown);
  }
}

[[noreturn]] void __cxa_rethrow() {
  if (caught == nullptr) {
    std::terminate();
  }
  caught->thrown_again = true;
  raise(caught);
}

std::type_info* __cxa_current_exception_type() {
  return caught == nullptr ? nullptr : const_cast<std::type_info*>(caught->type);
}

// std::exception_ptr's.
void* __cxa_current_primary_exception() noexcept {
  if (caught == nullptr) {
    return nullptr;
  }
  void* const object = object_of(caught);
  ++thrown_of(object)->references;
  return object;
}
void __cxa_increment_exception_refcount(void* object) noexcept {
  if (object != nullptr) {
    ++thrown_of(object)->references;
  }
}
void __cxa_decrement_exception_refcount(void* object) noexcept {
  if (object != nullptr) {
    release(thrown_of(object));
  }
}
void __cxa_rethrow_primary_exception(void* object) {
  if (object != nullptr) {
    Thrown* const again = thrown_of(__cxa_allocate_exception(0));
    Thrown* const primary = thrown_of(object);
    ++primary->references;
    *again = {
        .type = primary->type, .adjusted = object, .references = 1, .primary = primary};
    raise(again);
  }
}

bool __cxa_uncaught_exception() noexcept {
  return uncaught > 0;
}
unsigned int __cxa_uncaught_exceptions() noexcept {
  return static_cast<unsigned>(uncaught);
}

}  // extern "C"

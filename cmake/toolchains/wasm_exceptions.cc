// Exceptions in WebAssembly for Debian's libc++abi, whose build for wasm32-wasi leaves
// them out. One thread.
// Source: Itanium C++ ABI, Exception Handling; the tables as LLVM's WasmEHPrepare
// writes them, which libc++abi's cxa_personality.cpp reads.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <typeinfo>

__asm__(
    "  .globl __cpp_exception\n"
    "  .tagtype __cpp_exception i32\n"
    "__cpp_exception:\n");

namespace __cxxabiv1 {

// As libc++abi lays it out: all that is asked is whether a clause takes a type.
class __shim_type_info : public std::type_info {
 public:
  ~__shim_type_info() override;
  virtual void noop1() const;
  virtual void noop2() const;
  virtual bool can_catch(const __shim_type_info* thrown, void*& adjusted) const = 0;
};

}  // namespace __cxxabiv1

namespace {

// Lies before what is thrown.
struct alignas(16) Header {
  const std::type_info* type;
  void* (*destroy)(void*);
  Header* next;    // that was caught before and is still handled
  void* adjusted;  // what the clause sees
  int handlers;    // negative: thrown again
};

Header* caught = nullptr;  // the latest that is handled

Header* header_of(void* thrown) {
  return static_cast<Header*>(thrown) - 1;
}

std::uint32_t read_uleb(const std::uint8_t*& at) {
  std::uint32_t value = 0;
  unsigned shift = 0;
  std::uint8_t byte = 0;
  do {
    byte = *at++;
    value |= static_cast<std::uint32_t>(byte & 0x7f) << shift;
    shift += 7;
  } while ((byte & 0x80) != 0);
  return value;
}

std::int32_t read_sleb(const std::uint8_t*& at) {
  const std::uint8_t* const begin = at;
  const std::uint32_t value = read_uleb(at);
  const unsigned bits = 7 * static_cast<unsigned>(at - begin);
  const bool negative = (at[-1] & 0x40) != 0 && bits < 32;
  return static_cast<std::int32_t>(negative ? value | (~0U << bits) : value);
}

}  // namespace

extern "C" {

// Written by a landing pad, read by _Unwind_CallPersonality.
struct LandingPad {
  std::uintptr_t index;
  const std::uint8_t* table;
  std::uintptr_t selector;
};
thread_local LandingPad __wasm_lpad_context = {};

// Which clause of the landing pad takes the exception: its type's index, or 0.
int _Unwind_CallPersonality(void* thrown) {
  __wasm_lpad_context.selector = 0;
  const std::uint8_t* at = __wasm_lpad_context.table;
  if (at == nullptr) {
    return 0;
  }
  constexpr std::uint8_t kOmitted = 0xff;
  if (*at++ != kOmitted) {
    std::abort();
  }
  const std::uint8_t* types = nullptr;
  if (*at++ != kOmitted) {
    const std::uint32_t offset = read_uleb(at);
    types = at + offset;
  }
  ++at;  // the encoding of the next table, always ULEB
  const std::uint32_t bytes = read_uleb(at);
  const std::uint8_t* const actions = at + bytes;
  std::uint32_t action = 0;
  for (std::uintptr_t pad = 0; pad <= __wasm_lpad_context.index; ++pad) {
    if (at >= actions) {
      std::abort();
    }
    read_uleb(at);
    action = read_uleb(at);
  }
  if (action == 0) {
    return 0;
  }
  at = actions + action - 1;
  Header* const header = header_of(thrown);
  while (true) {
    const std::int32_t index = read_sleb(at);
    if (index > 0) {
      const __cxxabiv1::__shim_type_info* clause = nullptr;
      std::memcpy(&clause, types - 4 * index, sizeof(clause));
      void* adjusted = thrown;
      if (clause == nullptr ||
          clause->can_catch(
              static_cast<const __cxxabiv1::__shim_type_info*>(header->type),
              adjusted)) {
        header->adjusted = adjusted;
        __wasm_lpad_context.selector = static_cast<std::uintptr_t>(index);
        return 0;
      }
    }
    const std::uint8_t* const here = at;
    const std::int32_t next = read_sleb(at);
    if (next == 0) {
      return 0;
    }
    at = here + next;
  }
}

void* __cxa_allocate_exception(std::size_t bytes) throw() {
  auto* const header = static_cast<Header*>(std::calloc(1, sizeof(Header) + bytes));
  if (header == nullptr) {
    std::terminate();
  }
  return header + 1;
}

void __cxa_free_exception(void* thrown) throw() {
  std::free(header_of(thrown));
}

[[noreturn]] void __cxa_throw(void* thrown, std::type_info* type,
                              void* (*destroy)(void*)) {
  Header* const header = header_of(thrown);
  header->type = type;
  header->destroy = destroy;
  header->adjusted = thrown;
  __builtin_wasm_throw(0, thrown);
}

void* __cxa_get_exception_ptr(void* thrown) throw() {
  return header_of(thrown)->adjusted;
}

void* __cxa_begin_catch(void* thrown) throw() {
  Header* const header = header_of(thrown);
  header->handlers = std::abs(header->handlers) + 1;
  if (header != caught) {
    header->next = caught;
    caught = header;
  }
  return header->adjusted;
}

void __cxa_end_catch() {
  Header* const header = caught;
  if (header == nullptr) {
    return;
  }
  if (header->handlers < 0) {
    if (++header->handlers == 0) {
      caught = header->next;
    }
    return;
  }
  if (--header->handlers == 0) {
    caught = header->next;
    if (header->destroy != nullptr) {
      header->destroy(header + 1);
    }
    std::free(header);
  }
}

[[noreturn]] void __cxa_rethrow() {
  if (caught == nullptr) {
    std::terminate();
  }
  caught->handlers = -caught->handlers;
  __builtin_wasm_throw(0, caught + 1);
}

int __gxx_wasm_personality_v0(...) {
  std::abort();
}

}  // extern "C"

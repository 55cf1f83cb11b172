# WebAssembly by Debian's clang: cmake -D PALPATE_CORE=ON --toolchain cmake/toolchains/wasm.cmake
# Packages: clang-22 lld-22 libc++-22-dev-wasm32 libc++abi-22-dev-wasm32
# libclang-rt-22-dev-wasm32 wasi-libc; node or a browser to run what was built.
#
# Debian's libc++ for wasm32 is built without exceptions, threads and files. The folder
# wasm/ beside has the exceptions' runtime (linked into every program) and headers: locks
# that are free, threads that cannot be started, operations on files by wasi-libc.
# What is thrown in our sources and in headers is caught as anywhere. What a function
# compiled into libc++ itself would throw (std::stoi, std::locale) ends the program with a
# message instead.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_C_COMPILER clang-22)
set(CMAKE_CXX_COMPILER clang++-22)
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_EXECUTABLE_SUFFIX_C .wasm)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .wasm)
set(CMAKE_C_FLAGS_INIT -Wno-deprecated)
set(CMAKE_CXX_FLAGS_INIT
    "-Wno-deprecated -fwasm-exceptions -isystem ${CMAKE_CURRENT_LIST_DIR}/wasm/include")
# Elements and models are large: a stack below all data, whose overflow is a trap.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-z,stack-size=4194304,--stack-first")
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

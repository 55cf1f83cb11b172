# Linux by clang with LLVM's standard library: cmake -D PALPATE_CORE=ON --toolchain ...
# Packages: clang-22 lld-22 libc++-22-dev libc++abi-22-dev.
set(CMAKE_C_COMPILER clang-22)
set(CMAKE_CXX_COMPILER clang++-22)
set(CMAKE_CXX_FLAGS_INIT -stdlib=libc++)
# The archive: an older libc++.so may be installed beside it.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static-libstdc++)
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static-libstdc++)

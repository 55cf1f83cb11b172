// consumer DATABASE: opens and closes it by the installed library.
#include <cstdio>

#include <palpate.hpp>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: consumer DATABASE\n");
    return 2;
  }
  try {
    palpate::Body body(argv[1]);
    const palpate::Tool tool = body.add_tool();
    std::printf("abi %d\n", tool.contacts().size() == 1 ? palpate_abi_version() : 0);
  } catch (const palpate::Error& error) {
    std::fprintf(stderr, "consumer: %s\n", error.what());
    return 1;
  }
  return 0;
}

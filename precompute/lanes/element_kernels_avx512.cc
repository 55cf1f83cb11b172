#define PALPATE_LANES lanes_avx512
#include "precompute/lanes/element_kernels.inc"
